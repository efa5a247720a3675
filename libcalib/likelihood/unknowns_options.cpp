#include <numbers>

#include "libcalib/likelihood/string_unknowns.hpp"

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
  ListOf<FixedParameter> fixed_slot(fixed);
  visitor.list({.key = "fixed", .meaning = "parameters that are held at a value"}, fixed_slot);
  ListOf<ParameterPrior> prior_slot(priors);
  visitor.list({.key = "priors", .meaning = "Gaussian priors of single parameters"}, prior_slot);
  ListOf<PriorCorrelation> correlation_slot(correlations);
  visitor.list({.key = "correlations", .meaning = "correlations of these priors"},
               correlation_slot);
}

SensorPair UnknownsOptions::sensors() const {
  return {.gain = gain.value, .delay = delay.value, .corner = 2.0 * pi * corner.value};
}

}  // namespace modcal
