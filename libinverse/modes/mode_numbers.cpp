#include "libinverse/modes/mode_numbers.hpp"

#include <algorithm>
#include <limits>

namespace modcal {
namespace {

double size_of(const DecayMode& mode) {
  double size = 0.0;
  for (const auto& amplitude : mode.amplitude) size += std::norm(amplitude);
  return size;
}

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
    if (chosen == modes.size() || size_of(modes[i]) > size_of(modes[chosen])) chosen = i;
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

std::vector<DecayMode> heard_of(std::vector<DecayMode> others, const NumberedModes& numbered,
                                double reach) {
  double largest = 0.0;
  for (const auto& [number, mode] : numbered) largest = std::max(largest, size_of(mode));
  std::erase_if(others, [&](const DecayMode& other) {
    if (size_of(other) < 0.01 * largest) return true;
    return std::ranges::any_of(numbered, [&](const auto& one) {
      return std::abs(one.second.pole.frequency - other.pole.frequency) < reach;
    });
  });
  return others;
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
