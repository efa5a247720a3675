#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libsim/base/error.hpp"
#include "libsim/dynamics/friction/friction_law.hpp"
#include "libsim/dynamics/scene/string_regime.hpp"
#include "libsim/model/damping.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal::bow_force_limits_test {
namespace {

using std::numbers::pi;

// Friction that falls at once: Δμ = 0.2 at any slip speed.
Scene step_friction(double beta) {
  Scene scene = paper_scene();
  scene.bow.position = beta * scene.string.length;
  scene.friction = Choice<FrictionLaw>::of<CoulombExponential>(
      "coulomb_exponential",
      {.static_coefficient = 0.4, .dynamic_coefficient = 0.2, .decay = 1e6, .adherence = {}});
  return scene;
}

double impedance(const StringModel& string) { return string.linear_density * string.wave_speed(); }

TEST(SchellengLimits, HighestIsTwoImpedancesTimesTheVelocityJumpOverTheFrictionFall) {
  for (const double beta : {0.02, 0.1, 0.4}) {
    const Scene scene = step_friction(beta);
    const double expected = 2.0 * impedance(scene.string) * 0.1 / (beta * 0.2);
    EXPECT_NEAR(schelleng_limits(scene).highest, expected, 1e-12 * expected);
    Scene mirrored = scene;
    mirrored.bow.position = scene.string.length - scene.bow.position;
    EXPECT_NEAR(schelleng_limits(mirrored).highest, expected, 1e-12 * expected);
  }
}

// Damping ratios ζ_n = Z₀/(π n R) of a string that ends on a resistance R.
class BridgeLoss final : public DampingLaw {
 public:
  struct Options {
    double impedance_ratio = 0.0;  // Z₀/R
    void visit(OptionVisitor& /*visitor*/) {}
  };
  explicit BridgeLoss(const Options& options) : options_(options) {}

 private:
  double ratio(const DampedMode& mode) const override {
    return options_.impedance_ratio / (pi * static_cast<double>(mode.index + 1));
  }
  Options options_;
};

// A resistance R at the bridge: ζ_n = Z₀/(π n R). The sum over the odd n ≤ 1/β lacks
// Σ_{odd n > 1/β} 1/n² ≤ β/2 + β² of π²/8.
TEST(SchellengLimits, LowestIsSchellengsForALossAtTheBridge) {
  const double resistance = 200.0;  // [N s/m]
  for (const double beta : {0.02, 0.05}) {
    Scene scene = step_friction(beta);
    const double z = impedance(scene.string);
    scene.string.damping = Choice<DampingLaw>::of<BridgeLoss>("constant", {z / resistance});
    const double expected = z * z * 0.1 / (2.0 * resistance * beta * beta * 0.2);
    const double lowest = schelleng_limits(scene).lowest;
    EXPECT_LE(lowest, expected);
    EXPECT_GE(lowest, expected * (1.0 - (beta / 2.0 + beta * beta) / (pi * pi / 8.0)));
  }
}

TEST(SchellengLimits, LowestIsProportionalToTheLosses) {
  const auto lowest = [](double ratio) {
    Scene scene = step_friction(0.1);
    scene.string.damping =
        Choice<DampingLaw>::of<ConstantDamping>("constant", ConstantDamping::Options{ratio});
    return schelleng_limits(scene).lowest;
  };
  EXPECT_NEAR(lowest(3e-3) / lowest(1e-3), 3.0, 1e-12);
  // 4 Z₀ v_b ζ/(π β² Δμ) (1 + 1/3 + 1/5 + 1/7 + 1/9).
  const double expected = 4.0 * impedance(paper_scene().string) * 0.1 * 1e-3 / (pi * 0.01 * 0.2) *
                          (1.0 + 1.0 / 3 + 1.0 / 5 + 1.0 / 7 + 1.0 / 9);
  EXPECT_NEAR(lowest(1e-3), expected, 1e-12);
}

TEST(SchellengLimits, NeedAContactInsideTheString) {
  Scene scene = paper_scene();
  scene.bow.position = 0.33;
  EXPECT_THROW(schelleng_limits(scene), InvalidInput);
}

// Sum of the modes with Fejér's weights, whose error beside a jump falls like 1/N.
double contact_velocity(const ModalBasis& basis, const ModalState& state, double contact,
                        double t) {
  const auto shape = basis.shape_at(contact);
  double v = 0.0;
  for (std::size_t n = 0; n < basis.size(); ++n) {
    const double weight = 1.0 - static_cast<double>(n + 1) / static_cast<double>(basis.size() + 1);
    v += weight * shape[n] * state.velocity[n] * std::cos(basis.omega[n] * t);
  }
  return v;
}

TEST(HelmholtzMotion, SticksAndSlipsAtTheContact) {
  StringModel string = paper_scene().string;
  string.modes = 2000;
  const ModalBasis basis = make_modal_basis(string);
  const double period = 1.0 / string.fundamental;
  for (const double contact : {0.03, 0.1, 0.3}) {
    const double beta = relative_bow_position(contact, string.length);
    const ModalState state = helmholtz_motion(basis, contact, 0.1);
    const double slip = -0.1 * (1.0 - beta) / beta;
    double square = 0.0;
    for (int k = 0; k < 100; ++k) {
      const double phase = (k + 0.5) / 100.0;  // the slip is at 1/2 ± β/2
      const double v = contact_velocity(basis, state, contact, phase * period);
      square += v * v / 100.0;
      const double from_switch = std::abs(std::abs(phase - 0.5) - 0.5 * beta);
      if (from_switch < 0.01) continue;
      const bool slips = std::abs(phase - 0.5) < 0.5 * beta;
      // Fejér's kernel leaves jump/(π² N δ) at the distance δ (in periods) of a jump of v_b/β, from
      // two of them.
      const double tolerance = 2.0 * 0.1 / beta / (pi * pi * 2000.0 * from_switch);
      EXPECT_NEAR(v, slips ? slip : 0.1, tolerance) << contact << " at " << phase;
    }
    // 100 points see the slip's length to 1 % of the period.
    const double rms = helmholtz_velocity_rms(beta, 0.1);
    EXPECT_NEAR(square, rms * rms, 0.01 * slip * slip);
  }
}

}  // namespace
}  // namespace modcal::bow_force_limits_test
