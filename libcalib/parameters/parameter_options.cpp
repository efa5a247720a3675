#include "libcalib/parameters/parameter_options.hpp"

#include <algorithm>
#include <array>
#include <numbers>
#include <optional>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

constexpr std::array kSensors = {"gain", "delay", "corner"};

}  // namespace

void ParameterRanges::visit(OptionVisitor& visitor) {
  visitor.number({.key = "frequency_range",
                  .meaning = "how far f_n and f0 may move, relative to their initial values",
                  .unit = "1",
                  .range = Range::open(0.0, 1.0)},
                 frequency);
  visitor.number({.key = "inharmonicity_range",
                  .meaning = "how far B may move",
                  .unit = "1",
                  .range = Range::positive()},
                 inharmonicity);
  visitor.number(
      {.key = "lowest_inharmonicity",
       .meaning = "smallest B: the estimate of a string without stiffness scatters about "
                  "0; automatic: half of what the law of the highest mode allows",
       .unit = "1",
       .range = Range::closed(-1.0, 0.0),
       .word = "automatic"},
      lowest_inharmonicity);
  visitor.number({.key = "contact_range",
                  .meaning = "how far x_c may move",
                  .unit = "m",
                  .range = Range::positive()},
                 contact);
  visitor.number({.key = "damping_range",
                  .meaning = "how far zeta_n and their factor may move, relative to their initial "
                             "values",
                  .unit = "1",
                  .range = Range::open(0.0, 1.0)},
                 damping);
  visitor.number({.key = "power_range",
                  .meaning = "how far the exponent of the mode number in zeta_n may move",
                  .unit = "1",
                  .range = Range::positive()},
                 power);
  visitor.number({.key = "gain_range",
                  .meaning = "how far the gain may move, relative to its initial value",
                  .unit = "1",
                  .range = Range::open(0.0, 1.0)},
                 gain);
  visitor.number({.key = "delay_range",
                  .meaning = "how far the delay may move",
                  .unit = "s",
                  .range = Range::positive()},
                 delay);
  visitor.number({.key = "corner_range",
                  .meaning = "how far the corner may rise",
                  .unit = "Hz",
                  .range = Range::positive()},
                 corner);
}

void UnknownsOptions::visit(OptionVisitor& visitor) {
  visitor.text({.key = "damping",
                .meaning = "damping ratios: fixed; one factor of all; factor and power of the mode "
                           "number; each",
                .choices = {"fixed", "factor", "power", "each"}},
               damping);
  visitor.number({.key = "damping_width",
                  .meaning = "relative standard deviation of the prior of each damping ratio",
                  .unit = "1",
                  .range = Range::positive()},
                 damping_width);
  std::vector<std::string> free = free_sensors();
  visitor.texts({.key = "sensors",
                 .meaning = "what is free of the sensor at x = L against that at x = 0",
                 .choices = {kSensors.begin(), kSensors.end()}},
                free);
  UnknownOption* const sensors[] = {&gain, &delay, &corner};
  for (std::size_t i = 0; i < kSensors.size(); ++i) {
    sensors[i]->free = std::find(free.begin(), free.end(), kSensors[i]) != free.end();
  }
  visitor.number(
      {.key = "gain",
       .meaning = "gain of the sensor at x = L over that at x = 0; of what is free: start",
       .unit = "1",
       .range = Range::positive()},
      gain.value);
  visitor.number({.key = "delay",
                  .meaning = "delay of the sensor at x = L against that at x = 0, likewise",
                  .unit = "s"},
                 delay.value);
  visitor.number({.key = "corner",
                  .meaning = "corner of a high-pass of the sensor at x = L that the other has not, "
                             "likewise",
                  .unit = "Hz",
                  .range = Range::non_negative()},
                 corner.value);
  visitor.texts({.key = "per_record",
                 .meaning = "what each stroke or pluck has for itself; the rest is shared by all",
                 .choices = {"x_c", "gain", "delay", "corner", "damping"}},
                per_record);
  ListOf<FixedParameter> fixed_slot(fixed);
  visitor.list({.key = "fixed", .meaning = "parameters that are held at a value"}, fixed_slot);
  ListOf<ParameterPrior> prior_slot(priors);
  visitor.list({.key = "priors", .meaning = "Gaussian priors of single parameters"}, prior_slot);
  ListOf<PriorCorrelation> correlation_slot(correlations);
  visitor.list({.key = "correlations", .meaning = "correlations of these priors"},
               correlation_slot);
}

std::vector<std::string> UnknownsOptions::free_sensors() const {
  std::vector<std::string> names;
  const bool free[] = {gain.free, delay.free, corner.free};
  for (std::size_t i = 0; i < kSensors.size(); ++i) {
    if (free[i]) names.emplace_back(kSensors[i]);
  }
  return names;
}

bool UnknownsOptions::own(UnknownKind kind) const {
  return std::any_of(per_record.begin(), per_record.end(), [kind](const std::string& name) {
    const std::optional<UnknownName> parsed = parse_unknown(name);
    return parsed && parsed->kind == kind;
  });
}

void UnknownsOptions::require_sharing() const {
  std::vector<std::string> seen;
  for (const std::string& name : per_record) {
    const std::optional<UnknownName> parsed = parse_unknown(name);
    const bool known =
        parsed && parsed->record == 0 &&
        (parsed->kind == UnknownKind::kContact || parsed->kind == UnknownKind::kDampingFactor ||
         parsed->kind == UnknownKind::kGain || parsed->kind == UnknownKind::kDelay ||
         parsed->kind == UnknownKind::kCorner);
    MODCAL_REQUIRE(known,
                   "\"{}\" cannot be each record's own: x_c, gain, delay, corner and damping can",
                   name);
    MODCAL_REQUIRE(std::find(seen.begin(), seen.end(), name) == seen.end(),
                   "per_record names \"{}\" twice", name);
    seen.push_back(name);
    const bool held = (parsed->kind == UnknownKind::kGain && !gain.free) ||
                      (parsed->kind == UnknownKind::kDelay && !delay.free) ||
                      (parsed->kind == UnknownKind::kCorner && !corner.free);
    MODCAL_REQUIRE(!held, "per_record names {}, which is fixed: name it among the sensors", name);
    MODCAL_REQUIRE(
        parsed->kind != UnknownKind::kDampingFactor || damping == "factor",
        "per_record names damping, which is {}: a factor alone can be each record's own, "
        "state damping: factor",
        damping);
  }
}

void UnknownsOptions::require_contacts(std::size_t strokes) const {
  const auto require = [strokes](const std::string& parameter) {
    const std::optional<UnknownName> name = parse_unknown(parameter);
    MODCAL_REQUIRE(!name || name->kind != UnknownKind::kContact || name->record < strokes,
                   "\"{}\" is stated, but only strokes have a contact, and there {}: name one of "
                   "theirs, or state further_strokes",
                   parameter, strokes == 1 ? "is one" : fmt::format("are {}", strokes));
  };
  for (const ParameterPrior& prior : priors) require(prior.parameter);
  for (const FixedParameter& held : fixed) require(held.parameter);
}

SensorPair UnknownsOptions::sensors() const {
  return {.gain = gain.value,
          .delay = delay.value,
          .corner = 2.0 * std::numbers::pi * corner.value,
          .free = gain.free || delay.free || corner.free};
}

void ParameterOptions::visit(OptionVisitor& visitor) {
  visitor.text({.key = "frequencies",
                .meaning = "free modal frequencies: none, all, or those of the listed modes",
                .choices = {"none", "all", "listed"}},
               frequencies);
  visitor.integers({.key = "modes",
                    .meaning = "mode numbers, with frequencies: listed",
                    .range = Range::at_least(1)},
                   modes);
  visitor.flag({.key = "law", .meaning = "free f0 and B of the stiff-string law"}, law);
  visitor.flag({.key = "contact", .meaning = "free contact location x_c"}, contact);
  unknowns.visit(visitor);
  visitor.number({.key = "law_width",
                  .meaning = "relative width of the prior of f_n about the law",
                  .unit = "1",
                  .range = Range::positive(),
                  .word = "estimated"},
                 law_width);
  ranges.visit(visitor);
}

bool ParameterOptions::every_frequency() const { return frequencies == "all"; }

std::vector<std::string> ParameterOptions::names(std::size_t modes_of_model) const {
  const bool listed = frequencies == "listed";
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
  const std::string& damping = unknowns.damping;
  if (damping == "factor" || damping == "power") names.emplace_back("damping");
  if (damping == "power") names.emplace_back("damping_power");
  for (std::size_t n = 1; damping == "each" && n <= modes_of_model; ++n) {
    names.push_back(fmt::format("zeta_{}", n));
  }
  const std::vector<std::string> sensors = unknowns.free_sensors();
  names.insert(names.end(), sensors.begin(), sensors.end());
  MODCAL_REQUIRE(!names.empty(),
                 "no parameter is free: ask for frequencies, law, contact, damping or sensors");
  return names;
}

}  // namespace modcal
