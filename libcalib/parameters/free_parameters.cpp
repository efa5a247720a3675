#include "libcalib/parameters/free_parameters.hpp"

#include <algorithm>

namespace modcal {

void FreeParameters::add(const ParameterName& name) {
  const ParameterType& row = type_of(name);
  if (row.of_mode && pole(name).state != State::kFixed) pole(name) = {State::kOwn, size()};
  if (row.share && !row.of_mode) laws_[place(row.moves)].push_back(size());
  names_.push_back(name);
}

std::optional<std::size_t> FreeParameters::find(ParameterKind kind, std::size_t index) const {
  const auto found = std::find_if(names_.begin(), names_.end(), [&](const ParameterName& name) {
    return name.kind == kind && name.index == index;
  });
  if (found == names_.end()) return std::nullopt;
  return static_cast<std::size_t>(found - names_.begin());
}

bool FreeParameters::has(ParameterKind kind) const {
  return std::any_of(names_.begin(), names_.end(),
                     [kind](const ParameterName& name) { return name.kind == kind; });
}

std::span<const std::size_t> FreeParameters::movers(Moves what, std::size_t mode) const {
  const Pole& moved = poles_[place(what)][mode];
  if (moved.state == State::kOfLaw) return laws_[place(what)];
  return {&moved.own, moved.state == State::kOwn ? std::size_t{1} : std::size_t{0}};
}

LikelihoodColumns FreeParameters::columns(double inharmonicity,
                                          const std::vector<bool>& without) const {
  LikelihoodColumns columns{.count = size(), .share_begin = {0}};
  const auto taken = [&](std::size_t i) { return without.empty() || !without[i]; };
  for (std::size_t n = 0; n < poles_[0].size(); ++n) {
    for (const std::size_t i : movers(Moves::kFrequencies, n)) {
      if (taken(i)) columns.shares.push_back({i, share(i, n, inharmonicity), 0.0});
    }
    for (const std::size_t i : movers(Moves::kDamping, n)) {
      if (taken(i)) columns.shares.push_back({i, 0.0, share(i, n, inharmonicity)});
    }
    columns.share_begin.push_back(columns.shares.size());
  }
  for (std::size_t i = 0; i < size(); ++i) {
    if (!taken(i)) continue;
    if (type(i).moves == Moves::kContact) columns.contact = i;
    if (type(i).moves == Moves::kSensor) columns.sensors[names_[i].index] = i;
  }
  return columns;
}

}  // namespace modcal
