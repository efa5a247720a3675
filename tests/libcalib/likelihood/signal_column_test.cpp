#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libcalib/identifiability/misfit_causes.hpp"
#include "libcalib/likelihood/likelihood_evaluation.hpp"
#include "libcalib/parameters/string_unknowns.hpp"
#include "tests/libcalib/likelihood/bowed_case.hpp"

namespace modcal::signal_column_test {
namespace {

constexpr double kBand = 2.0 * std::numbers::pi * 10300.0;

class SignalColumns : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { bowed = bowed_case(0.0285, 1.39e-4, 0.25); }
  static WhitenedRecord record() { return WhitenedRecord::of(noisy(bowed, 0.01, 3), 0.0, kBand); }
  static BowedCase bowed;
};
BowedCase SignalColumns::bowed;

struct Transfers {
  std::vector<Complex> left, right, force;
};
Transfers transfers(const ProjectedLikelihood& likelihood, const ModelPoint& point) {
  Transfers found;
  likelihood.evaluate(point, {},
                      {.force = &found.force, .left = &found.left, .right = &found.right});
  return found;
}

// What x_c changes of both records is a signal like any other. The column of x_c holds no decays,
// as its slope of the modes' amplitudes is the end state's.
TEST_F(SignalColumns, OfAParameterAreItsColumn) {
  const ProjectedLikelihood likelihood(record());
  const StringUnknowns unknowns =
      StringUnknowns::frequencies(bowed.truth).without_damping_and_sensors();
  const Eigen::VectorXd theta = unknowns.start();
  constexpr double kStep = 1e-6;  // m, of a mode shape that is at most 50 π/L steep: error 1e-7
  const auto at = [&](double change) {
    Eigen::VectorXd moved = theta;
    moved[unknowns.contact()] += change;
    return transfers(likelihood, unknowns.model(moved));
  };
  const Transfers here = at(0.0), below = at(-kStep), above = at(kStep);
  const std::size_t padded = likelihood.record().root_weight.size();
  SignalColumn signal{PlanarVector(padded), PlanarVector(padded)};
  for (std::size_t k = 0; k < here.force.size(); ++k) {
    const Complex per_step = here.force[k] / (2.0 * kStep);
    signal.left.set(k, (above.left[k] - below.left[k]) * per_step);
    signal.right.set(k, (above.right[k] - below.right[k]) * per_step);
  }
  const LikelihoodColumns own = unknowns.columns(theta);
  const LikelihoodPoint point =
      likelihood.evaluate(bowed.truth, own.with(std::span(&signal, 1)), {.twice_weighted = true});
  const Eigen::Index contact = unknowns.contact(), last = point.slope.size() - 1;
  ASSERT_EQ(last, unknowns.size());
  const double size = std::sqrt(point.information(contact, contact));
  EXPECT_NEAR(point.slope[last] / size, point.slope[contact] / size, 1e-4);
  for (Eigen::Index i = 0; i <= last; ++i) {
    const double scale = size * std::sqrt(point.information(i, i));
    EXPECT_NEAR(point.information(last, i) / scale, point.information(contact, i) / scale, 1e-5);
    EXPECT_NEAR(point.twice_weighted(last, i) / scale, point.twice_weighted(contact, i) / scale,
                1e-5);
  }
}

// However much there is of a signal whose amplitude is free, the rest of the record is the same.
TEST_F(SignalColumns, ThatAreFreeAreNoMatter) {
  WhitenedRecord plain = record();
  const std::vector<MisfitCause> causes = misfit_causes(ProjectedLikelihood(plain), bowed.truth);
  for (const MisfitCause& cause : causes) {
    if (cause.name != "drift of the tuning") continue;
    plain.signals = cause.columns;
    WhitenedRecord changed = plain;
    const auto add = [](const PlanarVector& signal, PlanarVector& record) {
      for (std::size_t k = 0; k < signal.size(); ++k) {
        record.set(k, record.at(k) + 1e-3 * signal.at(k));
      }
    };
    add(cause.columns.front().left, changed.left);
    add(cause.columns.front().right, changed.right);
    const ProjectedLikelihood with(changed), without(plain);
    const double cost = without.cost(bowed.truth);
    // The ridge of the end state leaves 1e-9 of what it takes.
    EXPECT_NEAR(with.cost(bowed.truth) / cost, 1.0, 1e-5);
    EXPECT_LT(with.degrees_of_freedom(0, bowed.truth),
              ProjectedLikelihood(record()).degrees_of_freedom(0, bowed.truth));
    changed.signals.clear();
    EXPECT_GT(ProjectedLikelihood(changed).cost(bowed.truth), 1.2 * cost);
  }
}

TEST_F(SignalColumns, AreCutWithTheirRecord) {
  WhitenedRecord whole = record();
  whole.signals = {{whole.left, whole.right}};
  const WhitenedRecord part = whole.slice(300, 100);
  ASSERT_EQ(part.signals.size(), 1u);
  for (const std::size_t k : {0u, 99u}) {
    EXPECT_EQ(part.signals[0].left.at(k), part.left.at(k));
    EXPECT_EQ(part.signals[0].right.at(k), part.right.at(k));
  }
}

TEST_F(SignalColumns, LinesAreCutWithTheirRecord) {
  NoisyRecords records = noisy(bowed, 0.01, 1);
  records.lines = {50.0, 100.0};
  const WhitenedRecord whole = WhitenedRecord::of(records, 0.0, kBand);
  const WhitenedRecord part = whole.slice(40, 100);
  ASSERT_TRUE(part.waves && part.waves->size() == 2u);
  for (std::size_t line = 0; line < 2; ++line) {
    for (std::size_t wave = 0; wave < 4; ++wave) {
      for (const std::size_t k : {0u, 10u, 99u}) {
        const Complex there = (*whole.waves)[line][wave].at(40 + k);
        EXPECT_LT(std::abs((*part.waves)[line][wave].at(k) - there), 1e-12 * std::abs(there));
      }
    }
  }
}

}  // namespace
}  // namespace modcal::signal_column_test
