#include "libcalib/parameters/parameters.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "libcalib/parameters/stiff_string_fit.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

using std::numbers::pi;

Variable within_share(std::string name, std::string unit, double initial, double share) {
  return {.name = std::move(name),
          .unit = std::move(unit),
          .initial = initial,
          .lower = initial * (1.0 - share),
          .upper = initial * (1.0 + share),
          .scale = initial * share};
}

void require_ranges(const ParameterRanges& ranges) {
  MODCAL_REQUIRE(ranges.frequency > 0.0 && ranges.frequency < 1.0,
                 "frequency range {:g} must lie in (0, 1)", ranges.frequency);
  MODCAL_REQUIRE(ranges.inharmonicity > 0.0 && std::isfinite(ranges.inharmonicity),
                 "inharmonicity range {:g} must be > 0", ranges.inharmonicity);
  MODCAL_REQUIRE(ranges.contact > 0.0 && std::isfinite(ranges.contact),
                 "contact range {:g} m must be > 0", ranges.contact);
  for (const double share : {ranges.damping, ranges.gain}) {
    MODCAL_REQUIRE(share > 0.0 && share < 1.0, "range {:g} of damping or gain must lie in (0, 1)",
                   share);
  }
  for (const double range : {ranges.power, ranges.delay, ranges.corner}) {
    MODCAL_REQUIRE(range > 0.0 && std::isfinite(range),
                   "range {:g} of damping power, delay or corner must be > 0", range);
  }
}

double lowest_inharmonicity(const ParameterRanges& ranges, std::size_t modes) {
  const double highest = static_cast<double>(modes);
  const double end = -1.0 / (highest * highest);  // 1 + B n² = 0
  if (std::isnan(ranges.lowest_inharmonicity)) return 0.5 * end;
  MODCAL_REQUIRE(ranges.lowest_inharmonicity > end && ranges.lowest_inharmonicity <= 0.0,
                 "lowest inharmonicity {:g} must lie in ({:g}, 0]: below, 1 + B n^2 of mode {} is "
                 "not positive",
                 ranges.lowest_inharmonicity, end, modes);
  return ranges.lowest_inharmonicity;
}

}  // namespace

ParameterSet::ParameterSet(ModelPoint initial, std::span<const std::string> names,
                           const ParameterRanges& ranges)
    : initial_(std::move(initial)),
      follows_(initial_.basis.size(), false),
      damped_(initial_.basis.size(), false) {
  require_ranges(ranges);
  MODCAL_REQUIRE(!names.empty(), "a calibration needs at least one free parameter");
  MODCAL_REQUIRE(initial_.contact > 0.0 && initial_.contact < initial_.basis.length,
                 "contact {:g} m must lie inside the string, in (0, {:g}) m", initial_.contact,
                 initial_.basis.length);
  const bool law_free = std::any_of(names.begin(), names.end(), [](const std::string& name) {
    return name == "f0" || name == "B";
  });
  if (law_free) {
    std::vector<double> frequencies(initial_.basis.size());
    for (std::size_t n = 0; n < frequencies.size(); ++n) {
      frequencies[n] = initial_.basis.frequency(n);
    }
    const StiffStringFit fit = fit_stiff_string(frequencies);
    law_ = {fit.fundamental,
            std::max(fit.inharmonicity, lowest_inharmonicity(ranges, frequencies.size()))};
    std::fill(follows_.begin(), follows_.end(), true);
  }
  for (const std::string& name : names) {
    MODCAL_REQUIRE(std::none_of(parameters_.begin(), parameters_.end(),
                                [&](const Parameter& p) { return p.variable.name == name; }),
                   "parameter \"{}\" is named twice", name);
    parameters_.push_back(parameter(name, ranges));
    const Parameter& added = parameters_.back();
    if (added.kind == ParameterKind::kFrequency) follows_[added.mode] = false;
    if (added.kind == ParameterKind::kDampingRatio) damped_[added.mode] = true;
  }
}

Parameter ParameterSet::parameter(const std::string& name, const ParameterRanges& ranges) const {
  const UnknownName of = require_unknown(name, initial_.basis.size());
  MODCAL_REQUIRE(of.record == 0, "parameter \"{}\": an objective compares one record alone", name);
  switch (of.kind) {
    case ParameterKind::kFundamental:
      return {within_share(name, "Hz", law_.fundamental, ranges.frequency), of.kind};
    case ParameterKind::kInharmonicity: {
      // The highest mode moves by 0.5 B N² of its frequency: a step of 1e-5 is sensible for any N
      // up to some hundred.
      const double lower = std::max(law_.inharmonicity - ranges.inharmonicity,
                                    lowest_inharmonicity(ranges, initial_.basis.size()));
      return {
          {name, "1", law_.inharmonicity, lower, law_.inharmonicity + ranges.inharmonicity, 1e-5},
          of.kind};
    }
    case ParameterKind::kContact: {
      const double x = initial_.contact;
      // Ends of the string are no contact: nothing is excited there.
      const double margin = 1e-6 * initial_.basis.length;
      return {{name, "m", x, std::max(margin, x - ranges.contact),
               std::min(initial_.basis.length - margin, x + ranges.contact), ranges.contact},
              of.kind};
    }
    case ParameterKind::kFrequency:
      return {within_share(name, "Hz", initial_.basis.frequency(of.mode), ranges.frequency),
              of.kind, of.mode};
    case ParameterKind::kDampingRatio:
    case ParameterKind::kDampingFactor:
    case ParameterKind::kDampingPower:
      return damping_parameter(name, of, ranges);
    case ParameterKind::kGain:
    case ParameterKind::kDelay:
    case ParameterKind::kCorner:
      break;
  }
  return sensor_parameter(name, of, ranges);
}

Parameter ParameterSet::damping_parameter(const std::string& name, const UnknownName& of,
                                          const ParameterRanges& ranges) const {
  if (of.kind == ParameterKind::kDampingPower) {
    return {{name, "1", 0.0, -ranges.power, ranges.power, 0.1}, of.kind};
  }
  const bool one = of.kind == ParameterKind::kDampingRatio;
  return {within_share(name, "1", one ? initial_.basis.zeta[of.mode] : 1.0, ranges.damping),
          of.kind, of.mode};
}

Parameter ParameterSet::sensor_parameter(const std::string& name, const UnknownName& of,
                                         const ParameterRanges& ranges) const {
  const SensorPair& sensors = initial_.sensors;
  if (of.kind == ParameterKind::kGain) {
    return {within_share(name, "1", sensors.gain, ranges.gain), of.kind};
  }
  if (of.kind == ParameterKind::kDelay) {
    return {{name, "s", sensors.delay, sensors.delay - ranges.delay, sensors.delay + ranges.delay,
             ranges.delay},
            of.kind};
  }
  const double corner = 0.5 * sensors.corner / pi;
  return {{name, "Hz", corner, 0.0, corner + ranges.corner, ranges.corner}, of.kind};
}

std::vector<Variable> ParameterSet::variables() const {
  std::vector<Variable> result;
  for (const Parameter& parameter : parameters_) result.push_back(parameter.variable);
  return result;
}

bool ParameterSet::has(ParameterKind kind) const {
  return std::any_of(parameters_.begin(), parameters_.end(),
                     [kind](const Parameter& parameter) { return parameter.kind == kind; });
}

std::vector<double> ParameterSet::start() const {
  std::vector<double> result;
  for (const Parameter& parameter : parameters_) result.push_back(parameter.variable.initial);
  return result;
}

ParameterSet::Law ParameterSet::law_at(std::span<const double> x) const {
  Law law = law_;
  for (std::size_t i = 0; i < size(); ++i) {
    if (parameters_[i].kind == ParameterKind::kFundamental) law.fundamental = x[i];
    if (parameters_[i].kind == ParameterKind::kInharmonicity) law.inharmonicity = x[i];
  }
  return law;
}

ModelPoint ParameterSet::model(std::span<const double> x) const {
  assert(x.size() == size());
  ModelPoint point = initial_;
  const Law law = law_at(x);
  for (std::size_t n = 0; n < follows_.size(); ++n) {
    if (!follows_[n]) continue;
    point.basis.omega[n] =
        2.0 * pi * stiff_string_frequency(law.fundamental, law.inharmonicity, n + 1);
  }
  for (std::size_t i = 0; i < size(); ++i) {
    const Parameter& parameter = parameters_[i];
    if (parameter.kind == ParameterKind::kFrequency) {
      point.basis.omega[parameter.mode] = 2.0 * pi * x[i];
    }
    if (parameter.kind == ParameterKind::kContact) point.contact = x[i];
  }
  set_damping_and_sensors(x, point);
  return point;
}

double ParameterSet::damping_at(std::span<const double> x, std::size_t mode) const {
  double change = 1.0;
  for (std::size_t i = 0; i < size(); ++i) {
    if (parameters_[i].kind == ParameterKind::kDampingFactor) change *= x[i];
    if (parameters_[i].kind == ParameterKind::kDampingPower) {
      change *= std::pow(static_cast<double>(mode + 1), x[i]);
    }
  }
  return change;
}

void ParameterSet::set_damping_and_sensors(std::span<const double> x, ModelPoint& point) const {
  point.sensors.free = has(ParameterKind::kGain) || has(ParameterKind::kDelay) ||
                       has(ParameterKind::kCorner) || point.sensors.free;
  if (has(ParameterKind::kDampingFactor) || has(ParameterKind::kDampingPower)) {
    for (std::size_t n = 0; n < damped_.size(); ++n) point.basis.zeta[n] *= damping_at(x, n);
  }
  for (std::size_t i = 0; i < size(); ++i) {
    const Parameter& parameter = parameters_[i];
    if (parameter.kind == ParameterKind::kDampingRatio) point.basis.zeta[parameter.mode] = x[i];
    if (parameter.kind == ParameterKind::kGain) point.sensors.gain = x[i];
    if (parameter.kind == ParameterKind::kDelay) point.sensors.delay = x[i];
    if (parameter.kind == ParameterKind::kCorner) point.sensors.corner = 2.0 * pi * x[i];
  }
}

std::vector<FrequencySlope> ParameterSet::damping_slopes(std::span<const double> x,
                                                         std::size_t i) const {
  assert(x.size() == size() && i < size());
  const Parameter& parameter = parameters_[i];
  if (parameter.kind == ParameterKind::kDampingRatio) return {{parameter.mode, 1.0}};
  const bool factor = parameter.kind == ParameterKind::kDampingFactor;
  if (!factor && parameter.kind != ParameterKind::kDampingPower) return {};
  std::vector<FrequencySlope> slopes;
  for (std::size_t n = 0; n < damped_.size(); ++n) {
    if (damped_[n]) continue;
    const double zeta = initial_.basis.zeta[n] * damping_at(x, n);
    slopes.push_back({n, zeta * (factor ? 1.0 / x[i] : std::log(static_cast<double>(n + 1)))});
  }
  return slopes;
}

std::vector<FrequencySlope> ParameterSet::frequency_slopes(std::span<const double> x,
                                                           std::size_t i) const {
  assert(x.size() == size() && i < size());
  const Parameter& parameter = parameters_[i];
  if (parameter.kind == ParameterKind::kFrequency) return {{parameter.mode, 2.0 * pi}};
  if (parameter.kind != ParameterKind::kFundamental &&
      parameter.kind != ParameterKind::kInharmonicity) {
    return {};
  }
  const Law law = law_at(x);
  std::vector<FrequencySlope> slopes;
  for (std::size_t index = 0; index < follows_.size(); ++index) {
    if (!follows_[index]) continue;
    const double n = static_cast<double>(index + 1);
    const double root = std::sqrt(1.0 + law.inharmonicity * n * n);
    const double slope = parameter.kind == ParameterKind::kFundamental
                             ? n * root
                             : 0.5 * law.fundamental * n * n * n / root;
    slopes.push_back({index, 2.0 * pi * slope});
  }
  return slopes;
}

}  // namespace modcal
