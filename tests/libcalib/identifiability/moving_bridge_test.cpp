// A bridge that moves: what it makes of the modes, against the scheme of benchmarks/truth.
#include "libcalib/identifiability/moving_bridge.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "benchmarks/truth/bridge.hpp"
#include "benchmarks/truth/truth.hpp"
#include "libcalib/identifiability/tuning.hpp"
#include "tests/libcalib/likelihood/bowed_case.hpp"

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

// Four quarters of a step are one.
TEST(MovingBridge, IsTriedAQuarterOfAStepBeside) {
  const auto [below, above] = places_beside(430.0);
  EXPECT_NEAR(std::pow(above / 430.0, 4.0), kBodyStep, 1e-14);
  EXPECT_NEAR(std::pow(430.0 / below, 4.0), kBodyStep, 1e-14);
}

// What the amplitudes make of the columns leaves the record, bin by bin; beyond the band nothing
// changes. Whitened spectra go through two transforms: rounding of their largest bin.
TEST(MovingBridge, IsTakenOutOfARecord) {
  const BowedCase bowed = bowed_case(0.03, 0.0, 0.1);
  NoisyRecords records = noisy(bowed, 0.01, 1);
  constexpr double kHighest = 2.0 * M_PI * 5000.0, kAll = 2.0 * M_PI * 10000.0;
  const WhitenedRecord before = WhitenedRecord::of(records, 0.0, kAll);
  const std::vector<ScoreTest> modes = {body(430.0, 0.1)};
  take_out(modes, bowed.truth, kHighest, records);
  const WhitenedRecord after = WhitenedRecord::of(records, 0.0, kAll);
  NoisyRecords recorded = noisy(bowed, 0.01, 1);
  recorded.on_bridge = recorded.reactions[1];
  recorded.body = {430.0};
  const ProjectedLikelihood whole(WhitenedRecord::of(recorded, 0.0, kHighest));
  const std::vector<MisfitCause> causes = bridges_at(whole, bowed.truth, recorded.body);
  ASSERT_EQ(causes.size(), 1u);
  double largest = 0.0;
  for (std::size_t k = 0; k < before.bins; ++k) {
    largest = std::max({largest, std::abs(before.left.at(k)), std::abs(before.right.at(k))});
  }
  double taken = 0.0;
  for (std::size_t k = 0; k < before.bins; ++k) {
    Complex left, right;
    for (Eigen::Index j = 0; j < 3 && k < whole.record().bins; ++j) {
      const SignalColumn& column = causes[0].columns[static_cast<std::size_t>(j)];
      left += modes[0].amplitudes[j] * column.left.at(k);
      right += modes[0].amplitudes[j] * column.right.at(k);
    }
    EXPECT_LT(std::abs(before.left.at(k) - after.left.at(k) - left), 1e-12 * largest) << k;
    EXPECT_LT(std::abs(before.right.at(k) - after.right.at(k) - right), 1e-12 * largest) << k;
    taken = std::max(taken, std::abs(right));
  }
  EXPECT_GT(taken, 1e-3 * largest);
}

}  // namespace
}  // namespace modcal::moving_bridge_test
