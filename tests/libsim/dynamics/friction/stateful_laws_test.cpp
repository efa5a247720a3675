#include <gtest/gtest.h>

#include <cmath>

#include "libsim/base/error.hpp"
#include "libsim/base/random.hpp"
#include "libsim/dynamics/friction/friction_law.hpp"
#include "libsim/dynamics/friction/sliding_laws.hpp"

namespace modcal::stateful_laws_test {
namespace {

ThermalSliding thermal() { return std::get<ThermalSliding>(Thermal({}).stateful()); }

BristleFriction bristle(const char* model) {
  ElastoPlastic::Options options;
  options.model = model;
  BristleFriction law = std::get<BristleFriction>(ElastoPlastic(options).stateful());
  law.damping = 2.0;
  return law;
}

TEST(Thermal, HeatsUpTowardsItsBalanceAsAnExponential) {
  // With one coefficient for all temperatures the heat balance is linear:
  // ϑ(t) = P/(G + S u) (1 − e^{−(G + S u) t/H}), P = μ F_N u.
  ThermalSliding law{
      .hot = 0.5, .drop = 0.0, .capacity = 5e-6, .conductance = 2e-3, .carried = 1e-3};
  const double speed = 0.4, normal_force = 2.0, h = 1e-5;
  const double loss = 2e-3 + 1e-3 * speed, power = 0.5 * normal_force * speed;
  for (int k = 1; k <= 1000; ++k) {
    law.advance(h, speed, normal_force * law.at(speed).force);
    const double expected = power / loss * -std::expm1(-loss * k * h / 5e-6);
    ASSERT_NEAR(law.rise, expected, 1000 * 2.3e-16 * power / loss);  // exact but for rounding
  }
}

TEST(Thermal, SteadySlidingBalancesFrictionHeatAndLosses) {
  ThermalSliding law = thermal();
  const double speed = 0.2, normal_force = 0.5;
  for (int k = 0; k < 20000; ++k) law.advance(1e-5, speed, normal_force * law.at(speed).force);
  // 0.2 s are 80 times H/G: what is left of the start is below rounding.
  const double produced = normal_force * law.at(speed).force * speed;
  EXPECT_NEAR((2e-3 + 1e-3 * speed) * law.rise / produced, 1.0, 1e-12);
  EXPECT_GT(law.rise, 1.0);
}

TEST(Thermal, CoolsWhileSticking) {
  ThermalSliding law = thermal();
  law.rise = 30.0;
  law.advance(2.5e-3, 0.0, 0.3);  // H/G
  EXPECT_NEAR(law.rise, 30.0 * std::exp(-1.0), 1e-13);
  law.conductance = 0.0;
  const double before = law.rise;
  law.advance(1.0, 0.0, 0.3);
  EXPECT_EQ(law.rise, before);
}

TEST(Thermal, SoftensFromTheColdCoefficientToTheHotOne) {
  ThermalSliding law = thermal();
  law.rise = -1000.0;
  EXPECT_DOUBLE_EQ(law.at(0.0).force, 0.8);
  law.rise = 20.0;
  EXPECT_DOUBLE_EQ(law.at(0.0).force, 0.5);
  law.rise = 1e5;
  EXPECT_DOUBLE_EQ(law.at(0.0).force, 0.2);
}

// Friction turns work into heat: the force opposes every slip, and the contact never holds more
// heat than was rubbed into it.
TEST(Thermal, NeverGivesEnergy) {
  ThermalSliding law = thermal();
  constexpr std::size_t kSteps = 20000;
  std::vector<double> slips(kSteps), steps(kSteps);
  fill_standard_normal(StreamKey(5).with("slips"), slips);
  fill_uniform(StreamKey(5).with("steps"), steps);
  double rubbed = 0.0;
  for (std::size_t k = 0; k < kSteps; ++k) {
    const double slip = 2.0 * slips[k], h = 1e-4 * steps[k];
    const double magnitude = 1.5 * law.at(std::abs(slip)).force;
    ASSERT_GE(magnitude, 0.0);  // f = −sgn(slip)·magnitude: f·slip ≤ 0
    rubbed += magnitude * std::abs(slip) * h;
    law.advance(h, std::abs(slip), magnitude);
    ASSERT_GE(law.rise, 0.0);
    ASSERT_LE(law.capacity * law.rise, rubbed * (1.0 + 1e-12));
  }
}

TEST(ElastoPlastic, SteadySlidingFollowsTheSteadyCurve) {
  for (const char* model : {"elasto_plastic", "lugre"}) {
    for (const double slip : {-0.5, -0.03, 0.002, 0.2}) {
      BristleFriction law = bristle(model);
      double force = 0.0;
      for (int k = 0; k < 200000; ++k) {
        const auto step = law.step(1e-5, slip, 1.5);
        law.deflection = step.deflection;
        force = step.force;
      }
      const double curve = 1.5 * (0.2 + 0.2 * std::exp(-slip * slip / 0.01));
      // The ramp α approaches 1 quadratically, so that z approaches g/σ₀ from below as 1/t at
      // worst, 1/(number of relaxation lengths); LuGre exponentially.
      EXPECT_NEAR(-force * (slip < 0 ? -1 : 1) / curve, 1.0, 1e-3) << model << slip;
    }
  }
}

TEST(ElastoPlastic, ASmallLoadIsCarriedElastically) {
  // Pushed to and fro below breakaway the bristles return: no creep; LuGre creeps.
  for (const char* model : {"elasto_plastic", "lugre"}) {
    BristleFriction law = bristle(model);
    double travel = 0.0;
    for (int k = 0; k < 1000; ++k) {
      const double slip = 1e-3 * std::cos(2.0 * std::numbers::pi * k / 250.0) + 2e-4;
      travel += slip * 1e-6;
      law.deflection = law.step(1e-6, slip, 1.0).deflection;
    }
    if (std::string_view(model) == "lugre") {
      EXPECT_LT(law.deflection, travel * (1.0 - 1e-6));
    } else {
      EXPECT_NEAR(law.deflection, travel, 1e-20);
    }
  }
}

// Passivity: the work of the slip is at least what the bristles store, for any state, slip, force
// and step.
TEST(ElastoPlastic, NeverGivesMoreEnergyThanItsBristlesHold) {
  std::vector<double> u(40000);
  fill_uniform(StreamKey(5).with("bristles"), u);
  for (std::size_t i = 0; i + 4 <= u.size(); i += 4) {
    BristleFriction law = bristle(i % 8 == 0 ? "lugre" : "elasto_plastic");
    law.damping = 50.0 * u[i];  // far past the bound that the law keeps by itself
    const double normal_force = std::pow(10.0, -2.0 + 3.0 * u[i + 1]);
    law.deflection = (u[i + 2] < 0.5 ? -1.0 : 1.0) * 3.0 * u[i + 2] * 0.4 * normal_force / 1e5;
    const double slip = (u[i + 3] < 0.5 ? -1.0 : 1.0) * std::pow(10.0, -6.0 + 8.0 * u[i + 1]);
    const double h = 1e-7 * std::pow(10.0, 4.0 * u[i + 3]);
    const auto step = law.step(h, slip, normal_force);
    const double work = -step.force * slip * h;
    const double stored =
        0.5e5 * (step.deflection * step.deflection - law.deflection * law.deflection);
    const double scale = std::abs(work) + 0.5e5 * law.deflection * law.deflection;
    ASSERT_GE(work - stored, -1e-14 * scale) << i;
  }
}

TEST(StatefulLaws, SayThatTheyHaveAStateAndRefuseToBeACurve) {
  for (const char* name : {"thermal", "elasto_plastic"}) {
    const auto law = Choice<FrictionLaw>(name).make();
    EXPECT_TRUE(law->has_state()) << name;
    EXPECT_THROW(law->sliding(1.0), InvalidInput) << name;
  }
  EXPECT_FALSE(Choice<FrictionLaw>("hyperbolic").make()->has_state());
  EXPECT_THROW(Thermal({.cold_coefficient = 0.1, .hot_coefficient = 0.2}), InvalidInput);
  ElastoPlastic::Options options;
  options.model = "brush";
  EXPECT_THROW(ElastoPlastic{options}, InvalidInput);
}

}  // namespace
}  // namespace modcal::stateful_laws_test
