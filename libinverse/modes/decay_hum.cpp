#include "libinverse/modes/decay_hum.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "libinverse/modes/tuning.hpp"
#include "libsim/base/dense_solvers.hpp"
#include "libsim/base/turn.hpp"
#include "libsim/signal/mains_search.hpp"
#include "libsim/signal/statistics.hpp"
#include "libsim/signal/tuning.hpp"

namespace modcal {
namespace {

using Eigen::Index;

// What find_mains() has where no more are seen, and the most that it looks for.
enum : std::size_t { kFewHumLines = 8, kMostHumLines = 20 };

double duration_of(const DecayRecord& decay) {
  return static_cast<double>(decay.samples()) / decay.sample_rate;
}

// Its decay rate over 2π, half the width of its peak.
double half_width(const DecayPole& pole) { return pole.damping_ratio * pole.frequency; }

// A line keeps its amplitude. By how much ln of it may seem to fall along the record: what noise
// lets a decay appear, and the width that the mains have as they wander.
bool may_be_steady(const DecayMode& mode, double duration) {
  const double turns = kTurn * duration;
  const double deviation = mode.deviation.damping_ratio;
  const double told = std::isnan(deviation) ? 0.0 : turns * mode.pole.frequency * deviation;
  return turns * half_width(mode.pole) <
         std::min(2.0, kSteadyLoss + turns * kMainsHalfWidth + 4.0 * told);
}

// Modes of a string stand near multiples of its fundamental, the low ones at least; those of a
// structure without one (NaN) anywhere.
bool may_be_line(const DecayMode& mode, double fundamental, double duration) {
  const double place = mode.pole.frequency / fundamental;
  const bool is_harmonic = std::abs(place - std::max(1.0, std::round(place))) <= 0.1;
  return !is_harmonic && may_be_steady(mode, duration);
}

// Under the window a peak falls as that of the decay does where it is wider than the window's lobe.
std::vector<OwnLine> own_lines_of(const DecayRecord& decay, std::span<const DecayMode> poles,
                                  double fundamental) {
  std::vector<OwnLine> own;
  for (const DecayMode& mode : poles) {
    if (may_be_line(mode, fundamental, duration_of(decay))) continue;
    own.push_back({.frequency = mode.pole.frequency, .reach = 4.0 * half_width(mode.pole)});
  }
  return own;
}

double blackman_harris(double place) {
  const double turn = kTurn * place;
  return 0.35875 - 0.48829 * std::cos(turn) + 0.14128 * std::cos(2.0 * turn) -
         0.01168 * std::cos(3.0 * turn);
}

}  // namespace

std::vector<double> hum_in(const DecayRecord& decay, std::span<const DecayMode> poles,
                           double fundamental) {
  std::vector<double> lines;
  for (std::size_t c = 0; c < decay.channels.size() && lines.empty(); c += 2) {
    std::array<std::vector<double>, 2> signals = {decay.channels[c],
                                                  std::vector<double>(decay.samples())};
    if (c + 1 < decay.channels.size()) signals[1] = decay.channels[c + 1];
    for (auto& signal : signals) remove_mean(signal);
    const auto power = [](double, Complex first, Complex second) {
      return std::norm(first) + std::norm(second);
    };
    lines =
        find_mains(std::move(signals), decay.sample_rate, own_lines_of(decay, poles, fundamental),
                   power, std::numeric_limits<double>::quiet_NaN());
  }
  // What stands out most where the search for the mains ends belongs to something beside them.
  const auto is_off = [&lines](double mains) {
    return std::abs(lines.front() - mains) > kMainsTolerance * mains;
  };
  if (!lines.empty() && is_off(50.0) && is_off(60.0)) return {};
  // Beside the last line that is seen the modes may hide another.
  if (lines.size() > kFewHumLines) {
    for (std::size_t h = lines.size() + 1; h <= kMostHumLines; ++h) {
      lines.push_back(lines.front() * static_cast<double>(h));
    }
  }
  std::erase_if(lines, [&](double line) { return line >= 0.5 * decay.sample_rate; });
  return lines;
}

DecayRecord without_hum(DecayRecord decay, std::span<const double> lines,
                        std::span<const DecayMode> poles, double fundamental) {
  const double spacing = 1.0 / duration_of(decay);
  std::vector<double> apart;
  const std::vector<OwnLine> own = own_lines_of(decay, poles, fundamental);
  std::ranges::copy_if(lines, std::back_inserter(apart), [&](double line) {
    return std::ranges::none_of(own, [&](const OwnLine& pole) {
      return std::abs(line - pole.frequency) < pole.reach + 6.0 * spacing;
    });
  });
  if (apart.empty()) return decay;
  const auto rows = static_cast<Index>(decay.samples());
  const Eigen::MatrixXd columns = hum_columns(decay.samples(), decay.sample_rate, apart);
  Eigen::VectorXd weights(rows);
  for (Index m = 0; m < rows; ++m) {
    weights[m] = blackman_harris((static_cast<double>(m) + 0.5) / static_cast<double>(rows));
  }
  const ThinQr qr(weights.asDiagonal() * columns);
  for (auto& channel : decay.channels) {
    remove_mean(channel);
    Eigen::Map<Eigen::VectorXd> samples(channel.data(), rows);
    const Eigen::MatrixXd weighted = weights.cwiseProduct(samples);
    samples -= columns * qr.solve(weighted);
  }
  return decay;
}

bool is_line(const DecayMode& mode, std::span<const double> lines, double duration) {
  return may_be_steady(mode, duration) && std::ranges::any_of(lines, [&](double line) {
           return std::abs(mode.pole.frequency - line) < 1.0 / duration;
         });
}

Eigen::MatrixXd hum_columns(std::size_t samples, double rate, std::span<const double> lines) {
  Eigen::MatrixXd columns(static_cast<Index>(samples), static_cast<Index>(4 * lines.size()));
  for (std::size_t h = 0; h < lines.size(); ++h) {
    const auto first = static_cast<Index>(4 * h);
    const double turn = kTurn * lines[h] / rate;
    for (Index m = 0; m < columns.rows(); ++m) {
      const double place = 2.0 * static_cast<double>(m) / static_cast<double>(columns.rows()) - 1.0;
      const double cosine = std::cos(turn * static_cast<double>(m));
      const double sine = std::sin(turn * static_cast<double>(m));
      columns.row(m).segment<4>(first) << cosine, sine, place * cosine, place * sine;
    }
  }
  return columns;
}

}  // namespace modcal
