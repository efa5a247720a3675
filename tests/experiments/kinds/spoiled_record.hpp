// Ways in which a record of both reactions goes bad.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "libsim/signal/fft.hpp"

namespace modcal::bad_records_test {

/// What a file holds, and keys of `record:`.
struct Written {
  std::vector<double> t, r1, r2;
  std::vector<std::string> frequencies, ratios;  ///< of the damping
  std::string preamble, keys, cell;              ///< cell: in the place of the middle sample of R1
  bool time_column = true;

  std::size_t middle() const { return r1.size() / 2; }
  std::array<std::vector<double>*, 2> channels() { return {&r1, &r2}; }
  std::string text() const {
    std::string result = preamble + (time_column ? "t [s],R1 [N],R2 [N]\n" : "R1 [N],R2 [N]\n");
    for (std::size_t j = 0; j < r1.size(); ++j) {
      if (time_column) result += fmt::format("{:.12g},", t[j]);
      result += j == middle() && !cell.empty() ? cell : fmt::format("{:.12g}", r1[j]);
      result += fmt::format(",{:.12g}\n", r2[j]);
    }
    return result;
  }
};

using Spoil = std::function<void(Written&)>;

inline Spoil scaled(double left, double right) {
  return [=](Written& w) {
    for (double& x : w.r1) x *= left;
    for (double& x : w.r2) x *= right;
  };
}

inline Spoil raised(double left, double right) {
  return [=](Written& w) {
    for (double& x : w.r1) x += left;
    for (double& x : w.r2) x += right;
  };
}

inline Spoil cell(const std::string& text) {
  return [=](Written& w) { w.cell = text; };
}

inline Spoil clipped(double share, bool left, bool right) {
  return [=](Written& w) {
    for (std::size_t r = 0; r < 2; ++r) {
      if (!(r == 0 ? left : right)) continue;
      std::vector<double>& x = *w.channels()[r];
      const auto [low, high] = std::minmax_element(x.begin(), x.end());
      const double limit = share * std::max(-*low, *high);
      for (double& value : x) value = std::clamp(value, -limit, limit);
    }
  };
}

inline Spoil saturated(double drive, bool left, bool right) {
  return [=](Written& w) {
    for (std::size_t r = 0; r < 2; ++r) {
      if (!(r == 0 ? left : right)) continue;
      std::vector<double>& x = *w.channels()[r];
      const auto [low, high] = std::minmax_element(x.begin(), x.end());
      const double peak = std::max(-*low, *high);
      for (double& value : x) value = peak / drive * std::tanh(drive * value / peak);
    }
  };
}

inline Spoil filled(std::size_t count, bool hold) {
  return [=](Written& w) {
    for (std::vector<double>* x : w.channels()) {
      const auto from = x->begin() + static_cast<std::ptrdiff_t>(w.middle());
      std::fill_n(from, count, hold ? *(from - 1) : 0.0);
    }
  };
}

inline void erase(std::vector<double>& x, std::size_t first, std::size_t count) {
  const auto from = x.begin() + static_cast<std::ptrdiff_t>(first);
  x.erase(from, from + static_cast<std::ptrdiff_t>(count));
}

inline Spoil lost(std::size_t count, const char* time) {
  return [=, how = std::string(time)](Written& w) {
    const std::size_t middle = w.middle();
    erase(w.r1, middle, count);
    erase(w.r2, middle, count);
    erase(w.t, how == "jumps" ? middle : w.t.size() - count, count);
    if (how != "rate") return;
    w.time_column = false;
    w.preamble = "# sample_rate: 51200 Hz\n";
  };
}

inline Spoil silent(double from, double to, bool left, bool right, double level = 0.0) {
  return [=](Written& w) {
    const auto size = static_cast<double>(w.r1.size());
    const auto first = static_cast<std::ptrdiff_t>(from * size);
    const auto last = static_cast<std::ptrdiff_t>(to * size);
    if (left) std::fill(w.r1.begin() + first, w.r1.begin() + last, level);
    if (right) std::fill(w.r2.begin() + first, w.r2.begin() + last, level);
  };
}

inline Spoil kept(double from, double to) {
  return [=](Written& w) {
    const auto size = static_cast<double>(w.r1.size());
    for (std::vector<double>* x : {&w.t, &w.r1, &w.r2}) {
      x->resize(static_cast<std::size_t>(to * size));
      erase(*x, 0, static_cast<std::size_t>(from * size));
    }
  };
}

inline Spoil stated_rate(double rate) {
  return [=](Written& w) { w.keys = fmt::format(", sample_rate: {} Hz", rate); };
}

inline Spoil commented_rate(double rate) {
  return [=](Written& w) { w.preamble = fmt::format("# sample_rate: {} Hz\n", rate); };
}

inline Spoil file_clock(double factor) {
  return [=](Written& w) {
    for (double& t : w.t) t *= factor;
  };
}

inline Spoil copied(double gain) {
  return [=](Written& w) {
    w.r2 = w.r1;
    for (double& x : w.r2) x *= gain;
  };
}

inline Spoil rounded(int bits) {
  return [=](Written& w) {
    for (std::vector<double>* x : w.channels()) {
      const double step = *std::max_element(x->begin(), x->end()) / std::exp2(bits - 1);
      for (double& value : *x) value = step * std::round(value / step);
    }
  };
}

inline Spoil spike(double value) {
  return [=](Written& w) { w.r2[w.middle()] = value; };
}

inline Spoil late(std::ptrdiff_t samples) {
  return [=](Written& w) { std::rotate(w.r2.rbegin(), w.r2.rbegin() + samples, w.r2.rend()); };
}

inline Spoil noise_for_right() {
  return [](Written& w) {
    for (std::size_t j = 0; j < w.r2.size(); ++j) {
      w.r2[j] = 1e-3 * std::sin(12345.678 * static_cast<double>(j * (j % 97)));
    }
  };
}

inline Spoil both(const Spoil& first, const Spoil& second) {
  return [=](Written& w) {
    first(w);
    second(w);
  };
}

inline Spoil exchanged() {
  return [](Written& w) { std::swap(w.r1, w.r2); };
}

// As a lossy format does.
inline Spoil low_passed(double frequency) {
  return [=](Written& w) {
    const double rate = 1.0 / (w.t[1] - w.t[0]);
    for (std::vector<double>* channel : w.channels()) {
      const RealFft fft(channel->size());
      std::vector<Complex> bins = fft.forward(*channel);
      const auto first = static_cast<std::ptrdiff_t>(frequency / rate * channel->size());
      std::fill(bins.begin() + first, bins.end(), 0.0);
      *channel = fft.inverse(std::move(bins));
    }
  };
}

inline Spoil reversed() {
  return [](Written& w) {
    std::reverse(w.r1.begin(), w.r1.end());
    std::reverse(w.r2.begin(), w.r2.end());
  };
}

}  // namespace modcal::bad_records_test
