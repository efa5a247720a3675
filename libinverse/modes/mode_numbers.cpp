#include "libinverse/modes/mode_numbers.hpp"

#include <algorithm>
#include <limits>
#include <numbers>

#include "libinverse/modes/exponential_moments.hpp"
#include "libinverse/modes/tuning.hpp"

namespace modcal {
namespace {

std::size_t chosen_of(const std::vector<DecayMode>& modes, std::size_t number,
                      const LawNumbers& law) {
  const auto distance = [&](const DecayMode& mode) {
    return std::abs(law.place(mode.pole.frequency) / static_cast<double>(number) - 1.0);
  };
  double nearest = std::numeric_limits<double>::infinity();
  for (const DecayMode& mode : modes) nearest = std::min(nearest, distance(mode));
  std::size_t chosen = modes.size();
  for (std::size_t i = 0; i < modes.size(); ++i) {
    if (law.tells() && distance(modes[i]) > nearest + 0.01) continue;
    if (chosen == modes.size() || modes[i].power() > modes[chosen].power()) chosen = i;
  }
  return chosen;
}

}  // namespace

NumberedModes numbered_modes(std::vector<DecayMode> modes, double highest, LawNumbers& law,
                             std::vector<DecayMode>& others) {
  std::ranges::sort(modes, {}, [](const DecayMode& mode) { return mode.pole.frequency; });
  std::map<std::size_t, std::vector<DecayMode>> candidates;
  for (DecayMode& mode : modes) {
    const double frequency = mode.pole.frequency;
    if (frequency > highest || !(mode.pole.damping_ratio > 0.0)) continue;
    const auto number = static_cast<std::size_t>(std::lround(law.place(frequency)));
    std::vector<DecayMode>& of_number = candidates[number];
    if (of_number.empty()) law.add(number, frequency);
    of_number.push_back(std::move(mode));
  }
  NumberedModes numbered;
  for (auto& [number, of_number] : candidates) {
    const std::size_t chosen = number > 0 ? chosen_of(of_number, number, law) : of_number.size();
    for (std::size_t i = 0; i < of_number.size(); ++i) {
      const double frequency = of_number[i].pole.frequency;
      const bool is_of_string = i == chosen && (!law.tells() || law.is_near(number, frequency));
      if (is_of_string) {
        numbered.emplace(number, std::move(of_number[i]));
      } else {
        others.push_back(std::move(of_number[i]));
      }
    }
  }
  return numbered;
}

NumberedModes modes_in_order(std::vector<DecayMode> modes, double lowest, double highest) {
  std::erase_if(modes, [&](const DecayMode& mode) {
    const double frequency = mode.pole.frequency;
    return frequency < lowest || frequency > highest || !(mode.pole.damping_ratio > 0.0);
  });
  std::ranges::sort(modes, {}, [](const DecayMode& mode) { return mode.pole.frequency; });
  NumberedModes numbered;
  for (DecayMode& mode : modes) numbered.emplace(numbered.size() + 1, std::move(mode));
  return numbered;
}

std::vector<DecayMode> heard_of(std::vector<DecayMode> others, const NumberedModes& numbered) {
  double largest = 0.0;
  for (const auto& [number, mode] : numbered) largest = std::max(largest, mode.power());
  std::erase_if(others, [&](const DecayMode& other) { return other.power() < 0.01 * largest; });
  return others;
}

std::multimap<std::size_t, DecayMode> seconds_of(std::vector<DecayMode>& others,
                                                 const NumberedModes& numbered, double reach) {
  std::multimap<std::size_t, DecayMode> seconds;
  std::erase_if(others, [&](DecayMode& other) {
    for (const auto& [number, mode] : numbered) {
      if (std::abs(mode.pole.frequency - other.pole.frequency) >= reach) continue;
      seconds.emplace(number, std::move(other));
      return true;
    }
    return false;
  });
  return seconds;
}

namespace {

// How a second pole of a mode stands beside it.
struct Apart {
  double share = 0.0;      // s
  double distance = 0.0;   // |Δ|/ω
  double certainty = 0.0;  // in deviations
};

Apart apart_of(const DecayMode& mode, const DecayMode& second) {
  const double frequency = second.pole.frequency / mode.pole.frequency - 1.0;
  const double ratio = second.pole.damping_ratio - mode.pole.damping_ratio;
  const auto deviation = [&](double DecayPole::*of) {
    return std::hypot(mode.deviation.*of, second.deviation.*of);
  };
  const double in_deviations =
      std::max(std::abs(frequency) * mode.pole.frequency / deviation(&DecayPole::frequency),
               std::abs(ratio) / deviation(&DecayPole::damping_ratio));
  return {.share = std::min(1.0, std::sqrt(second.power() / mode.power())),
          .distance = std::hypot(frequency, ratio),
          .certainty = in_deviations};
}

// The largest of those that are told for certain, or the one that is told best.
Apart largest_of(const std::vector<Apart>& all) {
  Apart largest;
  const double best = std::ranges::max(all, {}, &Apart::certainty).certainty;
  for (const Apart& apart : all) {
    if (apart.certainty < std::min(3.0, best)) continue;
    largest.share = std::max(largest.share, apart.share);
    largest.distance = std::max(largest.distance, apart.distance);
  }
  return largest;
}

}  // namespace

void widen_by_seconds(NumberedModes& numbered, const std::multimap<std::size_t, DecayMode>& seconds,
                      double least, double duration) {
  std::vector<Apart> all;
  for (const auto& [number, second] : seconds) {
    const Apart apart = apart_of(numbered.at(number), second);
    if (apart.distance < 0.01) all.push_back(apart);
  }
  if (all.empty()) return;
  const Apart largest = largest_of(all);
  for (auto& [number, mode] : numbered) {
    if (seconds.contains(number)) continue;
    const double distance =
        std::min(largest.distance, unseen_distance(mode, largest.share, least, duration));
    const double shift = largest.share / (1.0 + largest.share) * distance;
    mode.deviation.frequency = std::hypot(mode.deviation.frequency, shift * mode.pole.frequency);
    mode.deviation.damping_ratio = std::hypot(mode.deviation.damping_ratio, shift);
  }
}

namespace {

bool has_share(const DecayMode& mode, const DecayMode& second, double share) {
  return second.power() > share * share * mode.power();
}

// By how much more two poles differ by frequency than by decay.
double turn_over_decay(const DecayMode& mode, const DecayMode& second) {
  const std::complex<double> apart = second.pole.exponent() - mode.pole.exponent();
  return std::abs(apart.imag()) / std::abs(apart.real());
}

}  // namespace

std::set<std::size_t> changing_of(const NumberedModes& numbered,
                                  const std::multimap<std::size_t, DecayMode>& seconds) {
  std::set<std::size_t> changing, two, more;
  for (const auto& [number, second] : seconds) {
    const DecayMode& mode = numbered.at(number);
    const double turn = turn_over_decay(mode, second);
    if (turn > kTurnOfTwo && has_share(mode, second, kShareOfTwo)) two.insert(number);
    if (turn < 1.0 && has_share(mode, second, 1.0 / 3.0)) changing.insert(number);
    const auto [first, last] = seconds.equal_range(number);
    const auto loud = std::count_if(first, last, [&mode](const auto& other) {
      return has_share(mode, other.second, kThirdPole);
    });
    if (loud > 1) more.insert(number);
  }
  if (more.empty() && two.size() > 2 * changing.size()) return {};
  changing.merge(more);
  return changing;
}

namespace {

// Square of what t² exp(−dt) leaves of exp(−dt) and t exp(−dt) over that of exp(−dt) [s⁴].
double square_of_curvature(double decay, double duration) {
  // Behind exp(−40) nothing is left; over so much the sums are the integrals to a thousandth.
  const std::size_t steps = 512;
  if (2.0 * decay * duration > 40.0) duration = 20.0 / decay;
  const auto sums = exponential_sums(-2.0 * decay * duration / static_cast<double>(steps), steps);
  Eigen::Matrix3d products;
  products << sums[0].real(), sums[1].real(), sums[2].real(), sums[1].real(), sums[2].real(),
      sums[3].real(), sums[2].real(), sums[3].real(), sums[4].real();
  const double left = products.determinant() / products.topLeftCorner<2, 2>().determinant();
  return std::pow(duration, 4) * left / products(0, 0);
}

}  // namespace

double unseen_distance(const DecayMode& mode, double share, double least, double duration) {
  const double omega = 2.0 * std::numbers::pi * mode.pole.frequency;
  const double told =
      0.25 * mode.evidence * square_of_curvature(mode.pole.damping_ratio * omega, duration);
  return (1.0 + share) / std::sqrt(share) * std::pow(least / told, 0.25) / omega;
}

std::vector<std::size_t> missing_in(const NumberedModes& numbered) {
  std::vector<std::size_t> missing;
  std::size_t next = 1;
  for (const auto& [number, mode] : numbered) {
    for (; next < number; ++next) missing.push_back(next);
    next = number + 1;
  }
  return missing;
}

}  // namespace modcal
