#include "libinverse/joint/joint_options.hpp"

#include <cmath>

#include "libsim/base/error.hpp"

namespace modcal {

Truncation truncation_of(const std::string& name) {
  if (name == "shifted_contour") return Truncation::kShiftedContour;
  if (name == "transient") return Truncation::kTransient;
  MODCAL_REQUIRE(name == "wrapped",
                 "unknown truncation \"{}\": shifted_contour, transient or wrapped", name);
  return Truncation::kWrapped;
}

void JointOptions::require() const {
  truncation_of(truncation);
  MODCAL_REQUIRE(offset == "arrival" || offset == "none",
                 "unknown offset rule \"{}\": arrival or none", offset);
  MODCAL_REQUIRE(points >= 3 && points <= 1280, "{} points on the curve: 3 to 1280 are possible",
                 points);
  MODCAL_REQUIRE(std::isnan(sigma) || sigma > 0.0, "contour at {:g} 1/s must be > 0", sigma);
  MODCAL_REQUIRE(std::isnan(sigma) || truncation == "shifted_contour",
                 "sigma {:g} 1/s is for the shifted contour: leave it out with truncation \"{}\"",
                 sigma, truncation);
}

void JointOptions::visit(OptionVisitor& visitor) {
  visitor.text({.key = "truncation",
                .meaning = "what is done about the ends of the record: shifted_contour (at rest at "
                           "first), transient (any state at either end, unknowns) or wrapped "
                           "(nothing)",
                .choices = {"shifted_contour", "transient", "wrapped"}},
               truncation);
  visitor.number({.key = "sigma",
                  .meaning = "contour's distance from the frequency axis; auto: from length, noise "
                             "and damping, about 2 over the record's length",
                  .unit = "Hz",
                  .range = Range::positive(),
                  .word = "auto"},
                 sigma);
  visitor.text({.key = "offset",
                .meaning = "static level of the sensors; arrival: the mean before the first wave "
                           "arrives, for records that start at rest",
                .choices = {"arrival", "none"}},
               offset);
  for (std::size_t r = 0; r < 2; ++r) {
    visitor.number({.key = r == 0 ? "noise_rms1" : "noise_rms2",
                    .meaning = r == 0 ? "noise of one sample of the reaction at x = 0"
                                      : "noise of one sample of the reaction at x = L",
                    .unit = "N",
                    .range = Range::non_negative(),
                    .word = "measured"},
                   noise_rms[r]);
  }
  visitor.number({.key = "band_limit",
                  .meaning = "nothing is identified above this frequency",
                  .unit = "Hz",
                  .range = Range::positive(),
                  .word = "none"},
                 band_limit);
  visitor.flag({.key = "limit_to_top_mode",
                .meaning = "sharp band limit at the highest mode, in place of band_limit"},
               limit_to_top_mode);
  visitor.integer({.key = "points",
                   .meaning = "points on the curve of evidence over the parameter",
                   .range = Range::closed(3, 1280)},
                  points);
  transfer.visit(visitor);
  sensors.visit(visitor);
}

}  // namespace modcal
