#include "libinverse/joint/joint_options.hpp"

#include <cmath>

#include "libsim/base/words.hpp"

namespace modcal {
namespace {

constexpr std::array<std::string_view, 4> kTruncations = {"shifted_contour", "transient", "wrapped",
                                                          "auto"};
constexpr std::array<std::string_view, 2> kOffsetRules = {"arrival", "none"};

}  // namespace

std::optional<Truncation> truncation_of(const std::string& name) {
  if (name == kTruncations.back()) return std::nullopt;
  return enum_of<Truncation>(kTruncations, "truncation", name);
}

OffsetRule offset_rule_of(const std::string& name) {
  return enum_of<OffsetRule>(kOffsetRules, "offset rule", name);
}

void JointOptions::require() const {
  const Truncation stated = truncation_of(truncation).value_or(Truncation::kShiftedContour);
  const bool shifted = stated == Truncation::kShiftedContour;
  offset_rule_of(offset);
  MODCAL_REQUIRE(points >= 3 && points <= 1280, "{} points on the curve: 3 to 1280 are possible",
                 points);
  MODCAL_REQUIRE(std::isnan(sigma) || sigma > 0.0, "contour at {:g} 1/s must be > 0", sigma);
  MODCAL_REQUIRE(std::isnan(sigma) || shifted,
                 "sigma {:g} 1/s is for the shifted contour: leave it out with truncation \"{}\"",
                 sigma, truncation);
}

void JointOptions::visit(OptionVisitor& visitor) {
  visitor("truncation",
          "what is done about the ends of the record: shifted_contour (both reactions, at rest at "
          "first), transient (any state at either end, unknowns), wrapped (nothing) or auto (what "
          "suits the record)",
          {.choices = choices_of(kTruncations)}, truncation);
  visitor("sigma",
          "contour's distance from the frequency axis; auto: from length, noise "
          "and damping, about 2 over the record's length",
          {.unit = "Hz", .range = Range::positive(), .word = "auto"}, sigma);
  visitor("offset",
          "static level of the sensors; arrival: the mean before the first wave "
          "arrives, for records that start at rest",
          {.choices = choices_of(kOffsetRules)}, offset);
  for (std::size_t r = 0; r < 2; ++r) {
    visitor(r == 0 ? "noise_rms_1" : "noise_rms_2",
            r == 0 ? "noise of one sample of the reaction at x = 0"
                   : "noise of one sample of the reaction at x = L",
            {.unit = "N", .range = Range::non_negative(), .word = "measured"}, noise_rms[r]);
  }
  visitor("band_limit",
          "nothing is identified above this frequency; auto: three modes below "
          "the highest for a record, half the sample rate for a simulation",
          {.unit = "Hz", .range = Range::positive(), .word = "auto"}, band_limit);
  visitor("limit_to_top_mode", "sharp band limit at the highest mode, in place of band_limit",
          limit_to_top_mode);
  visitor("points", "points on the curve of evidence over the parameter",
          {.range = Range::closed(3, 1280)}, points);
  transfer.visit(visitor);
  for (std::size_t r = 0; r < 2; ++r) {
    visitor(r == 0 ? "gain1" : "gain2",
            r == 0 ? "gain of the sensor at x = 0" : "gain of the sensor at x = L",
            {.range = Range::positive()}, sensors[r].gain);
  }
  for (std::size_t r = 0; r < 2; ++r) {
    visitor(r == 0 ? "delay1" : "delay2",
            r == 0 ? "delay of the channel of x = 0" : "delay of the channel of x = L",
            {.unit = "s"}, sensors[r].delay);
  }
}

}  // namespace modcal
