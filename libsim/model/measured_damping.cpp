#include "libsim/model/measured_damping.hpp"

#include "libsim/base/error.hpp"

namespace modcal {

void MeasuredDamping::Options::visit(OptionVisitor& visitor) {
  visitor.integers({.key = "modes",
                    .meaning = "numbers of the modes whose damping was measured",
                    .range = Range::at_least(1),
                    .required = true},
                   modes);
  visitor.numbers({.key = "ratios",
                   .meaning = "their damping ratios",
                   .unit = "1",
                   .range = {0.0, 1.0, true, false},
                   .required = true},
                  ratios);
  visitor.integer({.key = "degree",
                   .meaning = "degree of the polynomial of the mode number",
                   .range = Range::closed(0, 10)},
                  degree);
}

MeasuredDamping::MeasuredDamping(const Options& options) {
  MODCAL_REQUIRE(options.modes.size() == options.ratios.size(),
                 "{} modes and {} damping ratios were given: each mode needs one ratio",
                 options.modes.size(), options.ratios.size());
  const std::vector<std::size_t> modes(options.modes.begin(), options.modes.end());
  fit_ = fit_damping(modes, options.ratios, static_cast<std::size_t>(options.degree));
}

double MeasuredDamping::ratio(const DampedMode& mode) const { return fit_.ratio(mode.index + 1); }

}  // namespace modcal
