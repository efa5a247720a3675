#include "libcalib/parameters/parameters.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

using std::numbers::pi;

}  // namespace

ParameterSet::ParameterSet(ModelPoint initial, std::span<const std::string> names,
                           const ParameterRanges& ranges)
    : initial_(std::move(initial)), free_(initial_.basis.size()) {
  ranges.require_valid();
  MODCAL_REQUIRE(!names.empty(), "a calibration needs at least one free parameter");
  MODCAL_REQUIRE(initial_.contact > 0.0 && initial_.contact < initial_.basis.length,
                 "contact {:g} m must lie inside the string, in (0, {:g}) m", initial_.contact,
                 initial_.basis.length);
  for (const std::string& text : names) {
    const ParameterName name = require_parameter(text, initial_.basis.size());
    MODCAL_REQUIRE(name.record == 0, "parameter \"{}\": an objective compares one record alone",
                   text);
    MODCAL_REQUIRE(!free_.find(name.kind, name.index), "parameter \"{}\" is named twice", text);
    free_.add(name);
  }
  if (law_is_free()) {
    law_.fundamental = value_of({.kind = ParameterKind::kFundamental}, initial_);
    law_.inharmonicity = std::max(value_of({.kind = ParameterKind::kInharmonicity}, initial_),
                                  limits(ParameterKind::kInharmonicity, ranges).lowest);
  }
  for (std::size_t i = 0; i < free_.size(); ++i) {
    parameters_.push_back({free_[i], variable(free_[i], ranges)});
  }
}

Range ParameterSet::limits(ParameterKind kind, const ParameterRanges& ranges) const {
  if (kind == ParameterKind::kInharmonicity) {
    return Range::at_least(ranges.lowest_of(initial_.basis.size()));
  }
  // Ends of the string are no contact: nothing is excited there.
  const double margin = 1e-6 * initial_.basis.length;
  return kind == ParameterKind::kContact ? Range::closed(margin, initial_.basis.length - margin)
                                         : Range::any();
}

Variable ParameterSet::variable(const ParameterName& name, const ParameterRanges& ranges) const {
  const ParameterType& type = type_of(name);
  const Range limits = this->limits(name.kind, ranges);
  ParameterRanges copy = ranges;
  const double range = type.range(copy);
  const double start =
      name.kind == ParameterKind::kInharmonicity ? law_.inharmonicity : value_of(name, initial_);
  Variable result{.name = text_of(name),
                  .unit = std::string(type.unit),
                  .initial = start,
                  .lower = type.range_kind == RangeKind::kRise ? 0.0 : start - range,
                  .upper = start + range,
                  .scale = range};
  if (type.range_kind == RangeKind::kShare) {
    result.lower = start * (1.0 - range);
    result.upper = start * (1.0 + range);
    result.scale = start * range;
  }
  result.lower = std::max(result.lower, limits.lowest);
  result.upper = std::min(result.upper, limits.highest);
  if (type.scale > 0.0) result.scale = type.scale;
  return result;
}

std::vector<Variable> ParameterSet::variables() const {
  std::vector<Variable> result;
  for (const Parameter& parameter : parameters_) result.push_back(parameter.variable);
  return result;
}

std::vector<double> ParameterSet::start() const {
  std::vector<double> result;
  for (const Parameter& parameter : parameters_) result.push_back(parameter.variable.initial);
  return result;
}

double ParameterSet::Law::frequency(std::size_t mode) const {
  return 2.0 * pi * stiff_string_frequency(fundamental, inharmonicity, mode + 1);
}

double ParameterSet::Law::damping(std::size_t mode) const {
  return power == 0.0 ? factor : factor * std::pow(static_cast<double>(mode + 1), power);
}

ParameterSet::Law ParameterSet::law_at(std::span<const double> x) const {
  Law law = law_;
  const auto take = [&](ParameterKind kind, double& value) {
    if (const auto i = free_.find(kind)) value = x[*i];
  };
  take(ParameterKind::kFundamental, law.fundamental);
  take(ParameterKind::kInharmonicity, law.inharmonicity);
  take(ParameterKind::kDampingFactor, law.factor);
  take(ParameterKind::kDampingPower, law.power);
  return law;
}

ModelPoint ParameterSet::model(std::span<const double> x) const {
  assert(x.size() == size());
  ModelPoint point = initial_;
  const Law law = law_at(x);
  for (std::size_t n = 0; n < point.basis.size(); ++n) {
    if (law_is_free() && free_.follows_law(Moves::kFrequencies, n)) {
      point.basis.omega[n] = law.frequency(n);
    }
    point.basis.zeta[n] *= law.damping(n);
  }
  if (point.higher && law_is_free()) {
    point.higher->fundamental = law.fundamental;
    point.higher->inharmonicity = law.inharmonicity;
  }
  for (std::size_t i = 0; i < size(); ++i) {
    const ParameterType& type = free_.type(i);
    if (type.at) *type.at(point, free_[i].index) = type.per_unit * x[i];
    if (type.moves == Moves::kSensor) point.sensors.free = true;
  }
  return point;
}

std::vector<FrequencySlope> ParameterSet::slopes(std::span<const double> x, std::size_t i,
                                                 Moves what) const {
  assert(x.size() == size() && i < size());
  const ParameterType& type = free_.type(i);
  if (type.moves != what) return {};
  if (type.of_mode) return {{free_[i].index, type.per_unit}};
  const Law law = law_at(x);
  std::vector<FrequencySlope> slopes;
  for (std::size_t n = 0; n < initial_.basis.size(); ++n) {
    if (!free_.follows_law(what, n)) continue;
    const double share = free_.share(i, n, law.inharmonicity) / type.slope(x[i]);
    const double number =
        what == Moves::kFrequencies ? law.frequency(n) : initial_.basis.zeta[n] * law.damping(n);
    slopes.push_back({n, number * share});
  }
  return slopes;
}

}  // namespace modcal
