#include "libsim/signal/mains_search.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "libsim/signal/tuning.hpp"

namespace modcal {
namespace {

using std::numbers::pi;

// One harmonic that stands out, and the power about it.
struct Line {
  std::size_t harmonic = 0;
  double floor = 0.0;
  double top = 0.0;  // the bin of most power
};

// Lines in signals under the window.
class MainsSearch {
 public:
  MainsSearch(std::array<std::vector<double>, 2> signals, double rate, std::span<const OwnLine> own,
              HumPower kept)
      : rate_(rate),
        spacing_(rate / static_cast<double>(signals[0].size())),
        own_(own),
        kept_(std::move(kept)),
        samples_(std::move(signals)) {
    const RealFft fft(samples_[0].size());
    std::array<std::vector<Complex>, 2> spectra;
    for (std::size_t r = 0; r < 2; ++r) {
      const double turn = 2.0 * pi / static_cast<double>(samples_[r].size());
      for (std::size_t j = 0; j < samples_[r].size(); ++j) {
        const double t = turn * static_cast<double>(j);
        samples_[r][j] *= 0.35875 - 0.48829 * std::cos(t) + 0.14128 * std::cos(2.0 * t) -
                          0.01168 * std::cos(3.0 * t);
      }
      spectra[r] = fft.forward(samples_[r]);
    }
    const auto bins = static_cast<std::size_t>(21.0 * 62.0 / spacing_);
    for (std::size_t k = 0; k < std::min(bins, spectra[0].size()); ++k) {
      const double frequency = spacing_ * static_cast<double>(k);
      power_.push_back(kept_(frequency, spectra[0][k], spectra[1][k]));
    }
  }

  bool long_enough(double mains) const { return mains / spacing_ >= 16.0; }

  // What stands out of the harmonics of about this frequency, those near the signals' own aside;
  // nothing where neither of the first two does, the strongest of any hum.
  std::vector<Line> lines(double mains) const {
    std::vector<Line> found;
    for (std::size_t h = 1; h <= 20; ++h) {
      const double frequency = mains * static_cast<double>(h);
      if (frequency >= 0.45 * rate_ || is_near_own(frequency)) continue;
      const Line line = line_near(h, frequency / spacing_, mains / spacing_);
      if (line.floor > 0.0) found.push_back(line);
    }
    if (!found.empty() && found.front().harmonic > 2) found.clear();
    return found;
  }

  // Without those that do not stand where the first one says: what is left of the string
  // stands out, too. A line tells its frequency to a tenth of a bin, the bins another half.
  void keep_harmonics_of_first(double mains, std::vector<Line>& lines) const {
    const double first = refined(mains, {lines.front()});
    const std::size_t lowest = lines.front().harmonic;
    std::erase_if(lines, [&](const Line& line) {
      const auto h = static_cast<double>(line.harmonic);
      const double told = 0.1 * h / static_cast<double>(lowest);
      return line.harmonic > lowest && std::abs(line.top - first * h / spacing_) > 0.5 + told;
    });
  }

  // The frequency of these lines' harmonics, by a grid an eighth of a bin apart at the highest,
  // then between its neighbors.
  double refined(double mains, const std::vector<Line>& lines) const {
    const double step = spacing_ / (8.0 * static_cast<double>(lines.back().harmonic));
    double best = mains, most = 0.0;
    const auto reach = static_cast<int>(std::ceil(kMainsTolerance * mains / step));
    for (int i = -reach; i <= reach; ++i) {
      const double here = power(mains + i * step, lines);
      if (here > most) most = here, best = mains + i * step;
    }
    double low = best - step, high = best + step;
    for (int round = 0; round < 12; ++round) {  // to 0.8 % of a step
      const double third = (high - low) / 3.0;
      const bool left = power(low + third, lines) > power(high - third, lines);
      (left ? high : low) = left ? high - third : low + third;
    }
    return 0.5 * (low + high);
  }

 private:
  bool is_near_own(double frequency) const {
    return std::any_of(own_.begin(), own_.end(), [&](const OwnLine& own) {
      return std::abs(frequency - own.frequency) < own.reach + 6.0 * spacing_;
    });
  }

  // What stands out near bin `center`, and the median power about it outside the four bins of the
  // window's lobe; that is 0 where nothing does. fundamental: as far as to the next line.
  Line line_near(std::size_t harmonic, double center, double fundamental) const {
    const double reach = 1.0 + kMainsTolerance * center;
    const double about = std::min(20.0, 0.5 * fundamental);
    Line line{harmonic};
    double most = 0.0;
    std::vector<double> others;
    for (std::size_t k = 1; k < power_.size(); ++k) {
      const double off = std::abs(static_cast<double>(k) - center);
      if (off <= reach && power_[k] > most) {
        most = power_[k];
        line.top = static_cast<double>(k);
      }
      if (off > reach + 6.0 && off < reach + about) others.push_back(power_[k]);
    }
    if (others.empty()) return line;
    const auto middle = others.begin() + static_cast<std::ptrdiff_t>(others.size() / 2);
    std::nth_element(others.begin(), middle, others.end());
    if (most > kLineRatio * *middle) line.floor = *middle;
    return line;
  }

  // Of all lines over what is about them.
  double power(double mains, const std::vector<Line>& lines) const {
    double sum = 0.0;
    for (const Line& line : lines) {
      const double frequency = mains * static_cast<double>(line.harmonic);
      const double turn = 2.0 * pi * frequency / rate_;
      Complex spectrum[2];
      for (std::size_t r = 0; r < 2; ++r) {
        double last = 0.0, before = 0.0;  // Goertzel's recurrence
        for (const double sample : samples_[r]) {
          const double next = sample + 2.0 * std::cos(turn) * last - before;
          before = last, last = next;
        }
        spectrum[r] = last - std::polar(1.0, -turn) * before;
      }
      sum += kept_(frequency, spectrum[0], spectrum[1]) / line.floor;
    }
    return sum;
  }

  double rate_, spacing_;
  std::span<const OwnLine> own_;
  HumPower kept_;
  std::array<std::vector<double>, 2> samples_;
  std::vector<double> power_;
};

}  // namespace

std::vector<double> find_mains(std::array<std::vector<double>, 2> signals, double rate,
                               std::span<const OwnLine> own, HumPower kept, double mains) {
  if (mains == 0.0) return {};
  const MainsSearch search(std::move(signals), rate, own, std::move(kept));
  std::vector<double> candidates = {50.0, 60.0};
  if (mains > 0.0) candidates = {mains};
  double frequency = mains;
  std::vector<Line> lines;
  for (const double candidate : candidates) {
    if (!search.long_enough(candidate)) continue;
    std::vector<Line> found = search.lines(candidate);
    if (found.size() <= lines.size()) continue;
    frequency = candidate;
    lines = std::move(found);
  }
  if (std::isnan(frequency)) return {};
  std::size_t count = 8;
  if (!lines.empty()) {
    search.keep_harmonics_of_first(frequency, lines);
    frequency = search.refined(frequency, lines);
    count = std::max(count, lines.back().harmonic);
  }
  std::vector<double> result;
  for (std::size_t h = 1; h <= count; ++h) result.push_back(frequency * static_cast<double>(h));
  return result;
}

}  // namespace modcal
