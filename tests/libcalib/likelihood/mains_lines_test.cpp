#include "libcalib/likelihood/mains_lines.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libcalib/likelihood/likelihood_evaluation.hpp"
#include "libcalib/likelihood/pluck/pluck_likelihood.hpp"
#include "libcalib/parameters/string_unknowns.hpp"
#include "tests/libcalib/likelihood/bowed_case.hpp"
#include "tests/libcalib/likelihood/pluck_record_case.hpp"

namespace modcal::mains_lines_test {
namespace {

using std::numbers::pi;

constexpr double kBand = 2.0 * pi * 10300.0;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Harmonics of F with amplitudes `level`/h of each reaction's deviation, which change by `growth`
// of it in a second.
NoisyRecords with_hum(NoisyRecords records, const BowedCase& bowed, double mains, double level,
                      double growth = 0.0, int first = 1) {
  for (std::size_t r = 0; r < 2; ++r) {
    for (std::size_t j = 0; j < records.samples(); ++j) {
      const double time = static_cast<double>(j) / records.sample_rate;
      const double turn = 2.0 * pi * mains * time;
      for (int h = first; h <= 8; ++h) {
        records.reactions[r][j] += level * (1.0 + growth * time) * bowed.spread[r] / h *
                                   std::cos(h * turn + 0.7 * h + 2.0 * static_cast<double>(r));
      }
    }
  }
  return records;
}

class OneSecondOfMains : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { bowed = bowed_case(0.0285, 1.39e-4, 1.0); }
  static BowedCase bowed;
};
BowedCase OneSecondOfMains::bowed;

TEST_F(OneSecondOfMains, OfHumAreFound) {
  const NoisyRecords records = noisy(bowed, 0.01, 3);
  ModelPoint start = bowed.truth;
  for (double& omega : start.basis.omega) omega *= 1.015;
  start.contact += 1e-3;
  EXPECT_TRUE(mains_lines(records, start, kNan).empty());
  for (const double mains : {49.93, 60.11}) {
    for (const double level : {0.003, 0.01, 0.05}) {
      const std::vector<double> lines =
          mains_lines(with_hum(records, bowed, mains, level), start, kNan);
      ASSERT_GE(lines.size(), 8u) << mains << ", " << level;
      // Noise alone leaves √24 s/(2π a T √N) = 3.4e-3 s/a Hz (Rife and Boorstyn, 1974), s of the
      // noise, a of the line, the window twice that; the string's motion, which a start that is off
      // leaves in it, some times more.
      EXPECT_NEAR(lines[0], mains, 3e-2 * 0.01 / level + 5e-3) << level;
      for (std::size_t h = 1; h <= lines.size(); ++h) {
        EXPECT_DOUBLE_EQ(lines[h - 1], lines[0] * static_cast<double>(h));
      }
    }
  }
}

// 100 Hz is nearer to half of the string's 196 Hz than lines may be to a mode.
TEST_F(OneSecondOfMains, AreFoundByTheSecondHarmonicWhereTheFirstIsMissing) {
  const NoisyRecords records = noisy(bowed, 0.01, 3);
  const std::vector<double> lines =
      mains_lines(with_hum(records, bowed, 49.93, 0.05, 0.0, 2), bowed.truth, kNan);
  ASSERT_GE(lines.size(), 8u);
  EXPECT_NEAR(lines[0], 49.93, 1e-2);
}

TEST_F(OneSecondOfMains, AreFoundInWhatAFitLeaves) {
  const NoisyRecords records = noisy(bowed, 0.01, 3);
  const auto found = [&](const NoisyRecords& of) {
    return mains_lines(ProjectedLikelihood(WhitenedRecord::of(of, 0.0, kBand)), bowed.truth, kNan);
  };
  EXPECT_TRUE(found(records).empty());
  for (const double level : {0.001, 0.003, 0.05}) {
    const std::vector<double> lines = found(with_hum(records, bowed, 49.93, level));
    ASSERT_GE(lines.size(), 8u) << level;
    // Of noise alone, twice 3.4e-3 s/a Hz as above; three deviations.
    EXPECT_NEAR(lines[0], 49.93, 3.0 * 2.0 * 3.4e-3 * 0.01 / level) << level;
  }
}

TEST_F(OneSecondOfMains, AreTheSameWithinAHundredthOfABin) {
  NoisyRecords records = noisy(bowed, 0.01, 3);
  EXPECT_TRUE(same_lines({}, records));
  EXPECT_FALSE(same_lines({50.0, 100.0}, records));
  records.lines = {50.0, 100.0};
  EXPECT_TRUE(same_lines({50.0045, 100.009}, records));
  EXPECT_FALSE(same_lines({50.0055, 100.011}, records));
}

// Two and a half bins below the fourteenth harmonic, halfway between two modes.
TEST_F(OneSecondOfMains, AreNotDrawnByAnotherLine) {
  NoisyRecords records = with_hum(noisy(bowed, 0.01, 3), bowed, 50.0, 0.01);
  for (std::size_t j = 0; j < records.samples(); ++j) {
    records.reactions[0][j] +=
        0.05 * bowed.spread[0] *
        std::cos(2.0 * pi * 697.5 * static_cast<double>(j) / records.sample_rate);
  }
  const std::vector<double> lines = mains_lines(records, bowed.truth, kNan);
  ASSERT_FALSE(lines.empty());
  // As above; drawn, they would be at 697.5/14 = 49.82 Hz.
  EXPECT_NEAR(lines[0], 50.0, 3.5e-2);
}

TEST_F(OneSecondOfMains, AreAsStated) {
  const NoisyRecords records = noisy(bowed, 0.01, 3);
  EXPECT_TRUE(mains_lines(with_hum(records, bowed, 50.0, 0.1), bowed.truth, 0.0).empty());
  const std::vector<double> stated = mains_lines(records, bowed.truth, 25.0);
  ASSERT_EQ(stated.size(), 8u);
  EXPECT_EQ(stated[0], 25.0);
}

TEST(MainsLines, AreNotLookedForInAShortRecord) {
  const BowedCase bowed = bowed_case(0.0285, 1.39e-4, 0.1);
  const NoisyRecords records = with_hum(noisy(bowed, 0.01, 3), bowed, 50.0, 0.1);
  EXPECT_TRUE(mains_lines(records, bowed.truth, kNan).empty());
}

TEST_F(OneSecondOfMains, AreNoMatterToTheFit) {
  const NoisyRecords plain = noisy(bowed, 0.01, 3);
  ModelPoint point = bowed.truth;
  point.contact += 1e-5;
  const StringUnknowns unknowns = StringUnknowns::frequencies(point);
  const LikelihoodColumns columns = unknowns.columns(unknowns.start());
  for (const double sigma : {0.0, 20.0}) {
    // The mains wander: amplitude and phase change in the record.
    NoisyRecords records = plain, hum = with_hum(plain, bowed, 50.3, 0.02, 0.5);
    const double wrong =
        LikelihoodEvaluation(WhitenedRecord::of(hum, sigma, kBand), point).slope({}).cost;
    for (int h = 1; h <= 8; ++h) records.lines.push_back(50.3 * h);
    hum.lines = records.lines;
    const WhitenedRecord of_plain = WhitenedRecord::of(records, sigma, kBand);
    const WhitenedRecord of_hum = WhitenedRecord::of(hum, sigma, kBand);
    const LikelihoodPoint a =
        LikelihoodEvaluation(of_plain, point).differentiate(columns, {.twice_weighted = true});
    const LikelihoodPoint b =
        LikelihoodEvaluation(of_hum, point).differentiate(columns, {.twice_weighted = true});
    EXPECT_GT(wrong, 1.05 * a.cost);
    // What the end state costs, in which the lines count a thousandth of their power over that of
    // the record, is a little less where that holds the lines.
    EXPECT_NEAR(b.cost / a.cost, 1.0, 1e-5) << sigma;
    for (Eigen::Index i = 0; i < a.slope.size(); ++i) {
      const double own = std::sqrt(a.information(i, i));
      EXPECT_NEAR(a.slope[i] / own, b.slope[i] / own, 1e-4) << i << ", sigma " << sigma;
      EXPECT_NEAR(a.information(i, i) / b.information(i, i), 1.0, 1e-4) << i;
    }
    // Some rows, and the slope alone, hold the lines alike.
    const std::vector<std::size_t> wanted = {0, 50};
    const LikelihoodPoint rows = LikelihoodEvaluation(of_hum, point).rows(columns, wanted);
    EXPECT_LT((rows.information.row(1) - b.information.row(50)).norm(),
              1e-8 * b.information.row(50).norm());
    EXPECT_LT((rows.slope - b.slope).norm(), 1e-8 * b.slope.norm() + 1e-8 * std::sqrt(b.cost));
    EXPECT_NEAR(LikelihoodEvaluation(of_hum, point).slope(columns).cost, b.cost, 1e-9 * b.cost);
  }
}

TEST(MainsLines, OfEitherEndAreNoMatterToAPluck) {
  NoisyRecords records = plucked_records(1.39e-4, 0.5, 0.01, 7);
  for (int h = 1; h <= 3; ++h) records.lines.push_back(50.3 * h);
  Scene scene = paper_scene();
  scene.string.inharmonicity = 1.39e-4;
  const ModelPoint truth{make_modal_basis(scene.string), 0.03};
  const auto cost = [&] {
    return PluckLikelihood(WhitenedRecord::of(records, 0.0, kBand)).cost(truth);
  };
  const double without = cost();
  for (std::size_t r = 0; r < 2; ++r) {
    const double level = 5.0 * records.deviation[r];
    for (std::size_t j = 0; j < records.samples(); ++j) {
      const double turn = 2.0 * pi * 50.3 * static_cast<double>(j) / records.sample_rate;
      records.reactions[r][j] += level * std::cos(turn + 1.0) + level * std::sin(3.0 * turn);
    }
    EXPECT_NEAR(cost() / without, 1.0, 1e-6) << r;
  }
}

}  // namespace
}  // namespace modcal::mains_lines_test
