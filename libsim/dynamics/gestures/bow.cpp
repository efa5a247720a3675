#include "libsim/dynamics/gestures/bow.hpp"

#include <cmath>

namespace modcal {
namespace {

void visit_noise(OptionVisitor& visitor, std::string_view key, std::string_view meaning,
                 GestureNoise& noise) {
  visitor(key, meaning, noise.present, noise);
}

double time_of_lowest(const PiecewiseLinear& function) {
  for (std::size_t i = 0; i < function.times().size(); ++i) {
    if (function.values()[i] == function.lowest()) return function.times()[i];
  }
  return 0.0;
}

}  // namespace

void Bow::visit(OptionVisitor& visitor) {
  visitor("position", "contact point x_c, from the end x = 0",
          {.unit = "m", .range = Range::positive(), .required = true}, position);
  visit_levels(visitor);
  visitor("width", "width of the bow hair along the string",
          {.unit = "m", .range = Range::non_negative()}, width);
  visitor("points", "contact points over the width", {.range = Range::closed(1, 16)}, points);
  visit_course(visitor);
}

void Bow::visit_levels(OptionVisitor& visitor) {
  visitor("velocity", "bow velocity", {.unit = "m/s", .range = Range::any()}, velocity);
  visitor("normal_force", "force that presses the bow on the string",
          {.unit = "N", .range = Range::non_negative()}, normal_force);
}

void Bow::visit_course(OptionVisitor& visitor) {
  visitor("velocity_gesture", "factor of the velocity against time", velocity_gesture);
  visitor("force_gesture", "factor of the normal force against time", force_gesture);
  visit_noise(visitor, "velocity_noise", "band-limited noise on the velocity", velocity_noise);
  visit_noise(visitor, "force_noise", "band-limited noise on the normal force", force_noise);
}

std::vector<double> Bow::contact_points() const {
  MODCAL_REQUIRE(points >= 1 && points <= 16, "{} contact points: there are 1 to 16", points);
  MODCAL_REQUIRE(width >= 0.0 && std::isfinite(width), "bow width {:g} m must be >= 0", width);
  MODCAL_REQUIRE(width == 0.0 || points > 1,
                 "a bow {:g} m wide needs several contact points: set bow.points to 2 or more",
                 width);
  std::vector<double> result;
  const auto count = static_cast<double>(points);
  for (int i = 0; i < points; ++i) {
    result.push_back(position + width * ((i + 0.5) / count - 0.5));
  }
  return result;
}

BowMotion bow_motion(const Bow& bow, double duration) {
  MODCAL_REQUIRE(std::isfinite(bow.velocity), "bow velocity must be a finite number");
  MODCAL_REQUIRE(bow.normal_force >= 0.0 && std::isfinite(bow.normal_force),
                 "normal force {:g} N must be finite and >= 0", bow.normal_force);
  BowMotion motion;
  motion.velocity = bow.velocity_gesture.make()
                        ->over(duration)
                        .product(bow.velocity_noise.factor(duration, "bow velocity"))
                        .scaled(bow.velocity);
  motion.normal_force = bow.force_gesture.make()
                            ->over(duration)
                            .product(bow.force_noise.factor(duration, "normal force"))
                            .scaled(bow.normal_force);
  const double lowest = motion.normal_force.lowest();
  MODCAL_REQUIRE(lowest >= 0.0,
                 "the normal force falls to {:g} N at {:g} s: a bow can be lifted (0 N) but cannot "
                 "pull; keep the factors of bow.force_gesture >= 0 and bow.force_noise small",
                 lowest, time_of_lowest(motion.normal_force));
  return motion;
}

}  // namespace modcal
