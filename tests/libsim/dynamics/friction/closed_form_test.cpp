#include <gtest/gtest.h>

#include <cmath>

#include "libsim/dynamics/friction/sliding_laws.hpp"

namespace modcal::closed_form_test {
namespace {

// Root of u + b (F_D + ΔF e^{−Cu}) = w by bisection in extended precision.
long double sliding_speed(const ExponentialSliding& law, long double b, long double w) {
  long double low = 0.0L, high = w;
  for (int i = 0; i < 200; ++i) {
    const long double u = 0.5L * (low + high);
    const long double force = law.dynamic_force + law.force_drop * std::exp(-law.decay * u);
    (u + b * force < w ? low : high) = u;
  }
  return 0.5L * (low + high);
}

TEST(ExponentialSliding, ClosedFormIsTheRootOfTheStep) {
  for (const double number : {1e-12, 1e-3, 0.02, 0.05}) {  // C b ΔF
    for (const double decay : {1e-3, 5.0, 400.0}) {
      const ExponentialSliding law{.dynamic_force = 0.2, .force_drop = 0.3, .decay = decay};
      const double b = number * (1.0 - 1e-15) / (decay * law.force_drop);
      const ExponentialSliding::ClosedForm closed(law, b);
      ASSERT_TRUE(closed.valid());
      for (const double reduced : {0.0, 1e-9, 0.1, 1.0, 30.0}) {  // C u
        const double w = b * law.at(0.0).force + reduced / decay;
        const long double u = sliding_speed(law, b, w);
        const double force =
            static_cast<double>(law.dynamic_force + law.force_drop * std::exp(-law.decay * u));
        // The exponent's roundings, of |C w| ≤ 31 and of the terms it is summed from, and ten of 1.
        const double tolerance = force * 2.3e-16 * (10.0 + 4.0 * reduced);
        EXPECT_NEAR(closed.force(1.0, w, 0.0, 0.0), -force, tolerance);
        EXPECT_NEAR(closed.force(-1.0, -w + 0.1 * 0.7, 0.1, 0.7), force,
                    tolerance + law.force_drop * decay * 2.3e-16);
      }
    }
  }
  const ExponentialSliding law{.dynamic_force = 0.2, .force_drop = 0.3, .decay = 5.0};
  EXPECT_FALSE(ExponentialSliding::ClosedForm(law, 0.06 / 1.5).valid());
}

}  // namespace
}  // namespace modcal::closed_form_test
