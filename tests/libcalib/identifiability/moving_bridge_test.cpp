// A bridge that moves: what it makes of the modes, against the scheme of benchmarks/truth.
#include "libcalib/identifiability/moving_bridge.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "benchmarks/truth/bridge.hpp"
#include "benchmarks/truth/truth.hpp"
#include "libcalib/identifiability/tuning.hpp"

namespace modcal::moving_bridge_test {
namespace {

constexpr std::size_t kModes = 12;
const truth::TruthString kString{.inharmonicity = 0.0};

struct Pinned {
  ModalBasis basis;
  std::vector<truth::WaveMode> modes;
};

Pinned pinned() {
  Pinned string{.basis = {.length = kString.length, .tension = kString.tension()}};
  for (std::size_t n = 1; n <= kModes; ++n) {
    const auto number = static_cast<double>(n);
    const double omega = 2.0 * M_PI * kString.fundamental * number, zeta = 1e-3 / std::sqrt(number);
    string.basis.omega.push_back(omega);
    string.basis.zeta.push_back(zeta);
    string.basis.mass.push_back(0.5 * kString.linear_density * kString.length);
    string.modes.push_back({.omega = omega, .decay = zeta * omega});
  }
  return string;
}

ScoreTest body(double frequency, double mass) {
  ScoreTest test{.cause = std::string(kBridge), .place = frequency, .amplitude = 1.0 / mass};
  test.amplitudes = Eigen::Vector3d(1.0 / mass, 0.0, 0.0);
  return test;
}

// Both solve the same equation: what they leave of it is rounding, of numbers as large as ω.
TEST(MovingBridge, PutsModesWhereTheSchemeHasThem) {
  for (const double frequency : {150.0, 430.0, 1400.0}) {
    const Pinned string = pinned();
    const truth::Bridge bridge(
        kString, {.body_frequency = frequency, .body_damping = kBodyDamping, .bridge_mass = 0.1},
        {.intervals = 64, .time_step = 1e-5});
    const std::vector<truth::WaveMode> truth = bridge.coupled(string.modes);
    ModalBasis found = string.basis;
    const std::vector<ScoreTest> modes = {body(frequency, 0.1)};
    put_on_bridge(found, modes);
    double moved = 0.0;
    for (std::size_t n = 0; n < kModes; ++n) {
      EXPECT_NEAR(found.omega[n] / truth[n].omega, 1.0, 1e-12) << frequency << " Hz, " << n;
      EXPECT_NEAR(found.zeta[n], truth[n].decay / truth[n].omega, 1e-12) << frequency;
      moved = std::max(moved, std::abs(truth[n].omega / string.modes[n].omega - 1.0));
    }
    EXPECT_GT(moved, 1e-4) << frequency;
  }
}

// Two modes of half the compliance each, at one place, are one.
TEST(MovingBridge, AddsModesOfTheBody) {
  ModalBasis one = pinned().basis, two = one;
  put_on_bridge(one, std::vector<ScoreTest>{body(430.0, 0.1)});
  put_on_bridge(two, std::vector<ScoreTest>{body(430.0, 0.2), body(430.0, 0.2)});
  for (std::size_t n = 0; n < kModes; ++n) {
    EXPECT_NEAR(two.omega[n] / one.omega[n], 1.0, 1e-13);
    EXPECT_NEAR(two.zeta[n], one.zeta[n], 1e-13);
  }
  ModalBasis rigid = pinned().basis;
  put_on_bridge(rigid, {});
  EXPECT_EQ(rigid.omega, pinned().basis.omega);
}

// A change by all five amplitudes is a mode of the body at each of three places.
TEST(MovingBridge, ChangesAModeOfTheBody) {
  ScoreTest change = body(430.0, 0.5);
  change.amplitudes = Eigen::VectorXd{{2.0, 0.25, 0.5, -3.0, 4.0}};
  std::vector<ScoreTest> changed = {body(430.0, 0.1)};
  add_to_body(change, changed);
  ASSERT_EQ(changed.size(), 1u);
  EXPECT_DOUBLE_EQ(changed[0].amplitude, 13.0);
  EXPECT_EQ(changed[0].detail, "at 430 Hz, of 0.0769 kg");
  EXPECT_EQ(changed[0].amplitudes, (Eigen::VectorXd{{12.0, 0.25, 0.5, -3.0, 4.0}}));
  const auto [below, above] = places_beside(430.0);
  std::vector<ScoreTest> three;
  for (const ScoreTest& mode :
       {body(430.0, 1.0 / 12.0), body(below, -1.0 / 3.0), body(above, 0.25)}) {
    add_to_body(mode, three);
  }
  ASSERT_EQ(three.size(), 3u);
  ModalBasis one = pinned().basis, other = one;
  ASSERT_TRUE(put_on_bridge(one, changed));
  ASSERT_TRUE(put_on_bridge(other, three));
  for (std::size_t n = 0; n < kModes; ++n) {
    EXPECT_NEAR(other.omega[n] / one.omega[n], 1.0, 1e-13);
    EXPECT_NEAR(other.zeta[n], one.zeta[n], 1e-13);
  }
}

}  // namespace
}  // namespace modcal::moving_bridge_test
