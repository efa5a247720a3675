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

// The law's frequencies alone: what the damping is above the band is not seen in it.
void FreeParameters::add_higher(double inharmonicity, const HigherModeLaw& higher,
                                const std::vector<bool>& without,
                                LikelihoodColumns& columns) const {
  const std::size_t count = higher_mode_count(higher);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t number = higher.stated + 1 + i;
    const bool apart = number < higher.apart;
    for (const std::size_t p : laws_[place(Moves::kFrequencies)]) {
      if (!without.empty() && without[p]) continue;
      const bool stiff = names_[p].kind == ParameterKind::kInharmonicity;
      const double frequency = apart ? share(p, number - 1, inharmonicity) : stiff ? 0.0 : 1.0;
      columns.shares.push_back(
          {p, frequency, 0.0, stiff && (higher.bending || !apart) ? 1.0 : 0.0});
    }
    columns.share_begin.push_back(columns.shares.size());
  }
}

LikelihoodColumns FreeParameters::columns(double inharmonicity,
                                          const std::optional<HigherModeLaw>& higher,
                                          const std::vector<bool>& without) const {
  LikelihoodColumns columns{.count = size(), .share_begin = {0}};
  const auto taken = [&](std::size_t i) { return without.empty() || !without[i]; };
  const bool bending = higher && higher->bending;
  for (std::size_t n = 0; n < poles_[0].size(); ++n) {
    for (const std::size_t i : movers(Moves::kFrequencies, n)) {
      if (taken(i)) columns.shares.push_back({i, share(i, n, inharmonicity), 0.0});
    }
    for (const std::size_t i : laws_[place(Moves::kFrequencies)]) {
      if (bending && taken(i) && names_[i].kind == ParameterKind::kInharmonicity) {
        columns.shares.push_back({i, 0.0, 0.0, 1.0});
      }
    }
    for (const std::size_t i : movers(Moves::kDamping, n)) {
      if (taken(i)) columns.shares.push_back({i, 0.0, share(i, n, inharmonicity)});
    }
    columns.share_begin.push_back(columns.shares.size());
  }
  if (higher) add_higher(inharmonicity, *higher, without, columns);
  for (std::size_t i = 0; i < size(); ++i) {
    if (!taken(i)) continue;
    if (type(i).moves == Moves::kContact) columns.contact = i;
    if (type(i).moves == Moves::kSensor) columns.sensors[names_[i].index] = i;
  }
  return columns;
}

}  // namespace modcal
