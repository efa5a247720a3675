#include "libcalib/parameters/parameter_options.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "libcalib/parameters/damping_choice.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

enum class FrequencyChoice { kNone, kAll, kListed };
constexpr std::array<std::string_view, 3> kFrequencyChoices = {"none", "all", "listed"};
FrequencyChoice frequency_choice(std::string_view word) {
  return enum_of<FrequencyChoice>(kFrequencyChoices, "choice of the frequencies", word);
}

}  // namespace

void ParameterRanges::visit(OptionVisitor& visitor) {
  for (const ParameterType& type : parameter_table()) {
    if (!type.range_option.key.empty()) visitor.value(type.range_option, &type.range(*this));
    if (type.kind != ParameterKind::kInharmonicity) continue;
    visitor("lowest_inharmonicity",
            "smallest B: the estimate of a string without stiffness scatters about "
            "0; automatic: half of what the law of the highest mode allows",
            {.range = Range::closed(-1.0, 0.0), .word = "automatic"}, lowest_inharmonicity);
  }
}

void ParameterRanges::require_valid() const {
  ParameterRanges copy = *this;
  for (const ParameterType& type : parameter_table()) {
    const OptionInfo& option = type.range_option;
    const double range = type.range(copy);
    MODCAL_REQUIRE(option.key.empty() || option.range.contains(range), "{} {:g} {} must be {}",
                   option.key, range, option.unit, option.range.text());
  }
}

double ParameterRanges::lowest_of(std::size_t modes) const {
  const double highest = static_cast<double>(modes);
  const double end = -1.0 / (highest * highest);  // 1 + B n² = 0
  if (std::isnan(lowest_inharmonicity)) return 0.5 * end;
  MODCAL_REQUIRE(lowest_inharmonicity > end && lowest_inharmonicity <= 0.0,
                 "lowest inharmonicity {:g} must lie in ({:g}, 0]: below, 1 + B n^2 of mode {} is "
                 "not positive",
                 lowest_inharmonicity, end, modes);
  return lowest_inharmonicity;
}

void FixedParameter::visit(OptionVisitor& visitor) {
  visitor("parameter", "f0, B, x_c, f_3 or zeta_3; of a further record: x_c 2", {.required = true},
          parameter);
  // The unit is that of the parameter, which stands before it.
  visitor("value", "the value it is held at, in the unit of the parameter",
          {.unit = unit_of_parameter(parameter), .word = "initial"}, value);
}

void ParameterPrior::visit(OptionVisitor& visitor) {
  visitor("parameter",
          "f0, B, x_c, f_3, zeta_3, damping, damping_power, gain, delay or corner; "
          "of a further record: x_c 2",
          {.required = true}, parameter);
  // The unit is that of the parameter, which stands before it.
  visitor("mean", "mean of the prior, in the unit of the parameter",
          {.unit = unit_of_parameter(parameter), .word = "initial"}, mean);
  visitor("deviation", "standard deviation of the prior, in the unit of the parameter",
          {.unit = unit_of_parameter(parameter), .range = Range::positive(), .required = true},
          deviation);
}

void PriorCorrelation::visit(OptionVisitor& visitor) {
  visitor("between", "two parameters that have priors", {.required = true}, between);
  visitor("value", "their correlation", {.range = Range::open(-1.0, 1.0), .required = true}, value);
}

void UnknownsOptions::visit(OptionVisitor& visitor) {
  visitor("damping",
          "damping ratios: fixed; one factor of all; factor and power of the mode "
          "number; each; auto: each of a record's to the bound, else fixed",
          {.choices = choices_of(kDampingChoices)}, damping);
  visitor("damping_width", "relative standard deviation of the prior of each damping ratio",
          {.range = Range::positive()}, damping_width);
  visitor(
      "damping_scatter",
      "of it what each damping ratio has for itself, about a curve that is smooth in the mode's "
      "number; of a record's 0.3",
      {.range = Range::positive(), .word = "all"}, damping_scatter);
  std::vector<std::string> free = free_sensors();
  if (response.free) free.emplace_back("response");
  if (exact_sensors) free.emplace_back("exact");
  std::vector<std::string_view> choices = sensor_names();
  choices.insert(choices.end(), {"response", "exact"});
  visitor("sensors",
          "what is free of the sensor at x = L against that at x = 0, response: a factor "
          "that is smooth in frequency; none named: all of a record's, under priors; "
          "exact: nothing",
          {.choices = choices}, free);
  const auto named = [&](std::string_view name) {
    return std::find(free.begin(), free.end(), name) != free.end();
  };
  exact_sensors = named("exact");
  response.free = named("response");
  response.visit(visitor);
  visitor("mains",
          "frequency of the mains, the amplitudes of whose lines are unknown at "
          "either end; 0: there is no hum; automatic: looked for in a record",
          {.unit = "Hz", .range = Range::non_negative(), .word = "automatic"}, mains);
  std::vector<std::string_view> own = {"x_c"};
  for (std::size_t i = 0; i < Sensor::kCount; ++i) {
    const ParameterType& type = sensor_type(i);
    sensor[i].free = named(type.name);
    const std::string meaning = fmt::format("{}; of what is free: start", type.meaning);
    visitor(type.name, meaning, {.unit = type.unit, .range = type.stated}, sensor[i].value);
    own.push_back(type.name);
  }
  own.push_back("damping");
  visitor("per_record", "what each stroke or pluck has for itself; the rest is shared by all",
          {.choices = own}, per_record);
  visitor("fixed", "parameters that are held at a value", fixed);
  visitor("priors", "Gaussian priors of single parameters", priors);
  visitor("correlations", "correlations of these priors", correlations);
}

std::vector<std::string> UnknownsOptions::free_sensors() const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < Sensor::kCount; ++i) {
    if (sensor[i].free) names.emplace_back(sensor_type(i).name);
  }
  return names;
}

void UnknownsOptions::require_contacts(std::size_t strokes) const {
  const auto require = [strokes](const std::string& parameter) {
    const std::optional<ParameterName> name = parse_parameter(parameter);
    MODCAL_REQUIRE(!name || name->kind != ParameterKind::kContact || name->record < strokes,
                   "\"{}\" is stated, but only strokes have a contact, and there {}: name one of "
                   "theirs, or state further_strokes",
                   parameter, strokes == 1 ? "is one" : fmt::format("are {}", strokes));
  };
  for (const ParameterPrior& prior : priors) require(prior.parameter);
  for (const FixedParameter& held : fixed) require(held.parameter);
}

bool UnknownsOptions::own(const ParameterName& name) const {
  return std::any_of(per_record.begin(), per_record.end(), [&](const std::string& text) {
    const std::optional<ParameterName> parsed = parse_parameter(text);
    return parsed && parsed->kind == name.kind && parsed->index == name.index;
  });
}

Sensor UnknownsOptions::sensors() const {
  Sensor result;
  for (std::size_t i = 0; i < Sensor::kCount; ++i) {
    result.*Sensor::value_of(i) = sensor_type(i).per_unit * sensor[i].value;
    result.free = result.free || sensor[i].free;
  }
  if (!response.free) return result;
  result.free = true;
  result.smooth.knots.resize(response.knots);
  result.smooth.spacing = 2.0 * std::numbers::pi * response.spacing;
  return result;
}

ModelPoint with_fixed(ModelPoint initial, const UnknownsOptions& options) {
  for (const FixedParameter& fixed : options.fixed) {
    const ParameterName name = require_parameter(fixed.parameter, initial.basis.size());
    const ParameterType& type = type_of(name);
    if (std::isnan(fixed.value) || !type.at || name.record > 0) continue;
    *type.at(initial, name.index) = type.per_unit * fixed.value;
  }
  return initial;
}

void ParameterOptions::visit(OptionVisitor& visitor) {
  visitor("frequencies", "free modal frequencies: none, all, or those of the listed modes",
          {.choices = choices_of(kFrequencyChoices)}, frequencies);
  visitor("modes", "mode numbers, with frequencies: listed", {.range = Range::at_least(1)}, modes);
  visitor("law", "free f0 and B of the stiff-string law", law);
  visitor("contact", "free contact location x_c", contact);
  unknowns.visit(visitor);
  visitor("law_width", "relative width of the prior of f_n about the law",
          {.range = Range::positive(), .word = "estimated"}, law_width);
  ranges.visit(visitor);
}

bool ParameterOptions::every_frequency() const {
  return frequency_choice(frequencies) == FrequencyChoice::kAll;
}

bool ParameterOptions::no_frequency() const {
  return frequency_choice(frequencies) == FrequencyChoice::kNone;
}

std::vector<std::string> ParameterOptions::names(std::size_t modes_of_model) const {
  const bool listed = frequency_choice(frequencies) == FrequencyChoice::kListed;
  MODCAL_REQUIRE(listed == !modes.empty(),
                 "modes are listed if and only if frequencies is \"listed\"; it is \"{}\" with {} "
                 "modes",
                 frequencies, modes.size());
  std::vector<std::string> names;
  if (every_frequency()) {
    for (std::size_t n = 1; n <= modes_of_model; ++n) names.push_back(fmt::format("f_{}", n));
  }
  for (const std::int64_t n : modes) names.push_back(fmt::format("f_{}", n));
  if (law) names.insert(names.end(), {"f0", "B"});
  if (contact) names.emplace_back("x_c");
  const DampingChoice damping = damping_choice(unknowns.damping);
  const bool power = damping == DampingChoice::kPower;
  if (damping == DampingChoice::kFactor || power) names.emplace_back("damping");
  if (power) names.emplace_back("damping_power");
  for (std::size_t n = 1; damping == DampingChoice::kEach && n <= modes_of_model; ++n) {
    names.push_back(fmt::format("zeta_{}", n));
  }
  const std::vector<std::string> sensors = unknowns.free_sensors();
  names.insert(names.end(), sensors.begin(), sensors.end());
  MODCAL_REQUIRE(!names.empty(),
                 "no parameter is free: ask for frequencies, law, contact, damping or sensors");
  return names;
}

}  // namespace modcal
