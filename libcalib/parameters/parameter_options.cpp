// The section "parameters" of a calibration.
#include "libcalib/parameters/parameters.hpp"
#include "libsim/base/error.hpp"

namespace modcal {

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
  visitor.text({.key = "damping",
                .meaning = "damping ratios: fixed; one factor of all; factor and power of the mode "
                           "number; each",
                .choices = {"fixed", "factor", "power", "each"}},
               damping);
  visitor.texts({.key = "sensors",
                 .meaning = "what is free of the sensor at x = L against that at x = 0",
                 .choices = {"gain", "delay", "corner"}},
                sensors);
  ranges.visit(visitor);
}

std::vector<std::string> ParameterOptions::names(std::size_t modes_of_model) const {
  const bool listed = frequencies == "listed";
  MODCAL_REQUIRE(listed == !modes.empty(),
                 "modes are listed if and only if frequencies is \"listed\"; it is \"{}\" with {} "
                 "modes",
                 frequencies, modes.size());
  std::vector<std::string> names;
  if (frequencies == "all") {
    for (std::size_t n = 1; n <= modes_of_model; ++n) names.push_back(fmt::format("f_{}", n));
  }
  for (const std::int64_t n : modes) names.push_back(fmt::format("f_{}", n));
  if (law) names.insert(names.end(), {"f0", "B"});
  if (contact) names.emplace_back("x_c");
  if (damping == "factor" || damping == "power") names.emplace_back("damping");
  if (damping == "power") names.emplace_back("damping_power");
  for (std::size_t n = 1; damping == "each" && n <= modes_of_model; ++n) {
    names.push_back(fmt::format("zeta_{}", n));
  }
  names.insert(names.end(), sensors.begin(), sensors.end());
  MODCAL_REQUIRE(!names.empty(),
                 "no parameter is free: ask for frequencies, law, contact, damping or sensors");
  return names;
}

}  // namespace modcal
