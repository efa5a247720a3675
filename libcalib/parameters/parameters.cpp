#include "libcalib/parameters/parameters.hpp"

#include <fmt/format.h>

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
                           const ParameterRanges& ranges, std::size_t records,
                           std::span<const HeldParameter> held)
    : initial_(std::move(initial)) {
  ranges.require_valid();
  MODCAL_REQUIRE(!names.empty(), "a calibration needs at least one free parameter");
  for (const HeldParameter& one : held) {
    const ParameterType& type = type_of(one);
    if (type.at && one.record == 0) *type.at(initial_, one.index) = type.per_unit * one.value;
  }
  MODCAL_REQUIRE(initial_.contact > 0.0 && initial_.contact < initial_.basis.length,
                 "contact {:g} m must lie inside the string, in (0, {:g}) m", initial_.contact,
                 initial_.basis.length);
  std::vector<ParameterName> all;
  for (const std::string& text : names) {
    const ParameterName name = require_parameter(text, initial_.basis.size());
    MODCAL_REQUIRE(name.record < records, "parameter \"{}\": {}", text,
                   records == 1 ? std::string("an objective compares one record alone")
                                : fmt::format("there are {} records", records));
    MODCAL_REQUIRE(std::ranges::find(all, name) == all.end(), "parameter \"{}\" is named twice",
                   text);
    all.push_back(name);
  }
  for (std::size_t r = 0; r < records; ++r) records_.push_back(of_record(r, all, held));
  take_law(ranges, held);
  for (const ParameterName& name : all) parameters_.push_back({name, variable(name, ranges)});
}

void ParameterSet::take_law(const ParameterRanges& ranges, std::span<const HeldParameter> held) {
  const auto find = [held](ParameterKind kind) {
    return std::ranges::find(held, kind, &HeldParameter::kind);
  };
  const auto fundamental = find(ParameterKind::kFundamental);
  const auto inharmonicity = find(ParameterKind::kInharmonicity);
  of_law_ = law_is_free() || fundamental != held.end() || inharmonicity != held.end();
  if (!of_law_) return;
  law_.fundamental = fundamental != held.end()
                         ? fundamental->value
                         : value_of({.kind = ParameterKind::kFundamental}, initial_);
  law_.inharmonicity = inharmonicity != held.end()
                           ? inharmonicity->value
                           : std::max(value_of({.kind = ParameterKind::kInharmonicity}, initial_),
                                      limits(ParameterKind::kInharmonicity, ranges).lowest);
}

ParameterSet::OfRecord ParameterSet::of_record(std::size_t record,
                                               std::span<const ParameterName> names,
                                               std::span<const HeldParameter> held) const {
  OfRecord result{.free = FreeParameters(initial_.basis.size()), .places = {}, .contact = {}};
  for (const HeldParameter& one : held) {
    if (type_of(one).of_mode) result.free.fix(one);
    if (one.kind == ParameterKind::kContact && one.record == record) result.contact = one.value;
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    ParameterName own = names[i];
    own.record = record;
    const bool held_contact = own.kind == ParameterKind::kContact && result.contact.has_value();
    const bool shared =
        names[i].record == 0 && !held_contact && std::ranges::find(names, own) == names.end();
    if (names[i].record != record && !shared) continue;
    own.record = 0;
    result.free.add(own);
    result.places.push_back(i);
  }
  return result;
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

ParameterSet::Law ParameterSet::law_at(std::span<const double> x, std::size_t record) const {
  Law law = law_;
  const OfRecord& of = records_[record];
  const auto take = [&](ParameterKind kind, double& value) {
    if (const auto i = of.free.find(kind)) value = x[of.places[*i]];
  };
  take(ParameterKind::kFundamental, law.fundamental);
  take(ParameterKind::kInharmonicity, law.inharmonicity);
  take(ParameterKind::kDampingFactor, law.factor);
  take(ParameterKind::kDampingPower, law.power);
  return law;
}

ModelPoint ParameterSet::model(std::span<const double> x, std::size_t record) const {
  assert(x.size() == size() && record < records());
  const OfRecord& of = records_[record];
  ModelPoint point = initial_;
  const Law law = law_at(x, record);
  for (std::size_t n = 0; n < point.basis.size(); ++n) {
    if (of_law_ && of.free.follows_law(Moves::kFrequencies, n)) {
      point.basis.omega[n] = law.frequency(n);
    }
    if (of.free.follows_law(Moves::kDamping, n)) point.basis.zeta[n] *= law.damping(n);
  }
  if (point.higher && of_law_) {
    point.higher->fundamental = law.fundamental;
    point.higher->inharmonicity = law.inharmonicity;
  }
  if (of.contact) point.contact = *of.contact;
  for (std::size_t i = 0; i < of.free.size(); ++i) {
    const ParameterType& type = of.free.type(i);
    if (type.at) *type.at(point, of.free[i].index) = type.per_unit * x[of.places[i]];
    if (type.moves == Moves::kSensor) point.sensors.free = true;
  }
  return point;
}

std::vector<FrequencySlope> ParameterSet::slopes(std::span<const double> x, std::size_t i,
                                                 Moves what) const {
  assert(x.size() == size() && i < size());
  const OfRecord& first = records_.front();
  const auto own = std::ranges::find(first.places, i);
  const ParameterType& type = type_of(parameters_[i]);
  if (type.moves != what || own == first.places.end()) return {};
  if (type.of_mode) return {{parameters_[i].index, type.per_unit}};
  const Law law = law_at(x, 0);
  std::vector<FrequencySlope> slopes;
  const auto place = static_cast<std::size_t>(own - first.places.begin());
  for (std::size_t n = 0; n < initial_.basis.size(); ++n) {
    if (!first.free.follows_law(what, n)) continue;
    const double share = first.free.share(place, n, law.inharmonicity) / type.slope(x[i]);
    const double number =
        what == Moves::kFrequencies ? law.frequency(n) : initial_.basis.zeta[n] * law.damping(n);
    slopes.push_back({n, number * share});
  }
  return slopes;
}

}  // namespace modcal
