// What theory says of a bowed string: Helmholtz motion and Schelleng's largest bow force.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "libsim/dynamics/friction/friction_law.hpp"
#include "libsim/dynamics/scene/simulator.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal::bowed_string_oracles_test {
namespace {

using Complex = std::complex<double>;

constexpr double kRate = 51200.0;
constexpr std::size_t kWindow = 10240;  // the last 0.2 s

// Component of the last 0.2 s at f, Hann window.
Complex component(const Signal& signal, double f) {
  const std::size_t from = signal.size() - kWindow;
  Complex sum = 0.0;
  for (std::size_t k = 0; k < kWindow; ++k) {
    const double phase = 2.0 * std::numbers::pi * static_cast<double>(k);
    const double weight = 0.5 - 0.5 * std::cos(phase / kWindow);
    sum += weight * signal.samples[from + k] * std::polar(1.0, -phase * f / kRate);
  }
  return sum;
}

// The strongest frequency about the string's fundamental.
double playing_frequency(const Signal& signal) {
  double best = 0.0, strongest = 0.0;
  for (int i = 0; i < 440; ++i) {
    const double f = 185.0 + 0.05 * i;
    const double strength = std::abs(component(signal, f));
    if (strength > strongest) {
      strongest = strength;
      best = f;
    }
  }
  return best;
}

Simulation bowed(const char* simulator, double position, double force, double decay) {
  Scene scene = paper_scene();
  scene.bow.position = position;
  scene.bow.normal_force = force;
  CoulombExponential::Options friction;
  friction.decay = decay;
  scene.friction = Choice<FrictionLaw>::of<CoulombExponential>("coulomb_exponential", friction);
  return Choice<Simulator>(simulator).make()->simulate(scene, kRate, OutputRequest::all());
}

// Largest deviation of the first harmonics of R₁ from a sawtooth's: n a_n/(a_1/|a_1|)^n/|a_1| is
// (±i)^(n−1) for a ramp with a sudden return, whatever its origin in time; the sign tells which
// way it ramps.
double distance_from_sawtooth(const Signal& reaction, double f, double direction) {
  const Complex first = component(reaction, f);
  const Complex unit = first / std::abs(first);
  double worst = 0.0;
  Complex turned = unit, expected = 1.0;
  for (int n = 2; n <= 6; ++n) {
    turned *= unit;
    expected *= Complex(0.0, direction);
    const Complex harmonic =
        static_cast<double>(n) * component(reaction, n * f) / (turned * std::abs(first));
    worst = std::max(worst, std::abs(harmonic - expected));
  }
  return worst;
}

// Every simulator at its default step.
class BowedString : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(All, BowedString,
                         testing::Values("modal_event", "modal_exact", "newmark_explicit"));

// Helmholtz motion (Cremer, 1984): the string's speed at the bow jumps by v_b/β, and the force on
// the end is a sawtooth, harmonics ∝ (−1)^(n+1)/n: it grows while the string sticks.
TEST_P(BowedString, MovesAsHelmholtzSaw) {
  const double beta = 0.03 / 0.33;
  const Simulation run = bowed(GetParam(), 0.03, 0.88, 5.0);
  ASSERT_FALSE(run.diverged_at) << run.explanation;
  double sticking = 0.0, slipping = 0.0;
  std::size_t sticks = 0, slips = 0;
  for (std::size_t k = run.velocity.size() - kWindow; k < run.velocity.size(); ++k) {
    const double v = run.velocity.samples[k];
    if (v > 0.05) {
      sticking += v;
      ++sticks;
    } else if (v < -0.8) {  // past the rounded corners
      slipping += v;
      ++slips;
    }
  }
  const double jump =
      sticking / static_cast<double>(sticks) - slipping / static_cast<double>(slips);
  // The ripple of 50 modes rounds the slip: its plateau is within 5 % of the ideal string's.
  EXPECT_NEAR(jump, 0.1 / beta, 0.05 * 0.1 / beta);
  const double f = playing_frequency(run.left_reaction);
  EXPECT_NEAR(f, 196.0, 0.5);
  // The corner's width rounds harmonic n by about (n·0.1 ms·f)² ≈ 1 % at n = 6; a phase follows the
  // frequency's error of 0.025 Hz over 0.1 s, n − 1 times: 0.08. The other direction is 2 away.
  EXPECT_LT(distance_from_sawtooth(run.left_reaction, f, 1.0), 0.1);
  EXPECT_LT(distance_from_sawtooth(run.right_reaction, f, -1.0), 0.1);
}

// Above F_max = 2 Z₀ v_b/(β (μ_S − μ_D)) the bow can hold the string when the corner comes to
// release it (Schelleng, 1973). Measured limits lie within a factor of 1.5 of it (Woodhouse and
// Galluzzo, 2004): at half of it one slip a period, at one and a half of it no Helmholtz motion.
TEST_P(BowedString, LosesHelmholtzMotionAtSchellengsForce) {
  const Scene scene = paper_scene();
  const double impedance =
      2.0 * scene.string.length * scene.string.fundamental * scene.string.linear_density;
  const double position = 0.045, beta = position / scene.string.length;
  const double largest = 2.0 * impedance * 0.1 / (beta * 0.2);
  for (const double share : {0.5, 1.5}) {
    const Simulation run = bowed(GetParam(), position, share * largest, 20.0);
    ASSERT_FALSE(run.diverged_at) << run.explanation;
    const double f = playing_frequency(run.left_reaction);
    const double distance = distance_from_sawtooth(run.left_reaction, f, 1.0);
    // Bow and corner are wider under the larger force: twice the deviation of a light bow.
    if (share < 1.0) {
      EXPECT_LT(distance, 0.2);
    } else {
      EXPECT_GT(distance, 0.5);
    }
  }
}

}  // namespace
}  // namespace modcal::bowed_string_oracles_test
