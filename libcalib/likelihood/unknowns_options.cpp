#include <algorithm>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "libcalib/likelihood/string_unknowns.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

using std::numbers::pi;

void visit_unknown(OptionVisitor& visitor, const OptionInfo& info, UnknownOption& unknown,
                   const Range& range) {
  visitor.group(info, [&](OptionVisitor& members) {
    members.flag({.key = "free", .meaning = "found from the data"}, unknown.free);
    members.number({.key = "value",
                    .meaning = "fixed value; of what is free: start",
                    .unit = info.unit,
                    .range = range},
                   unknown.value);
  });
}

}  // namespace

void UnknownsOptions::visit(OptionVisitor& visitor) {
  visitor.text({.key = "damping",
                .meaning = "fixed; one factor of all damping ratios; factor and power of the mode "
                           "number; each under a prior about the stated ones",
                .choices = {"fixed", "factor", "power", "each"}},
               damping);
  visitor.number({.key = "damping_width",
                  .meaning = "relative standard deviation of the prior of each damping ratio",
                  .unit = "1",
                  .range = Range::positive()},
                 damping_width);
  visit_unknown(
      visitor,
      {.key = "gain", .meaning = "gain of the sensor at x = L over that at x = 0", .unit = "1"},
      gain, Range::positive());
  visit_unknown(visitor,
                {.key = "delay",
                 .meaning = "delay of the sensor at x = L against that at x = 0",
                 .unit = "s"},
                delay, Range::any());
  visit_unknown(visitor,
                {.key = "corner",
                 .meaning = "corner of a high-pass of the sensor at x = L that the other has not",
                 .unit = "Hz"},
                corner, Range::non_negative());
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
    MODCAL_REQUIRE(!held, "per_record names {}, which is fixed: state {}: {{free: true}}", name,
                   name);
    MODCAL_REQUIRE(
        parsed->kind != UnknownKind::kDampingFactor || damping == "factor",
        "per_record names damping, which is {}: a factor alone can be each record's own, "
        "state damping: factor",
        damping);
  }
}

SensorPair UnknownsOptions::sensors() const {
  return {.gain = gain.value,
          .delay = delay.value,
          .corner = 2.0 * pi * corner.value,
          .free = gain.free || delay.free || corner.free};
}

}  // namespace modcal
