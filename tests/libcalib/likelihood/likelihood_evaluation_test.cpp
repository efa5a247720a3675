#include "libcalib/likelihood/likelihood_evaluation.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <numbers>

#include "libcalib/optimizers/staged/newton_fit.hpp"
#include "libcalib/parameters/string_unknowns.hpp"
#include "libsim/base/task_loop.hpp"
#include "tests/libcalib/likelihood/bowed_case.hpp"

namespace modcal::likelihood_evaluation_test {
namespace {

constexpr double kBand = 2.0 * std::numbers::pi * 10300.0;

class OneSecond : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { bowed = bowed_case(0.0285, 1.39e-4, 1.0); }
  static WhitenedRecord record(double sigma, double noise = 0.01) {
    return WhitenedRecord::of(noisy(bowed, noise, 3), sigma, kBand);
  }
  static StringUnknowns law(const UnknownsOptions& options = {}) {
    return StringUnknowns::law(bowed.truth, 196.0, 1.39e-4, options);
  }
  static StringUnknowns every_unknown() {
    UnknownsOptions options{.damping = "each"};
    options.sensor[Sensor::kGain].free = options.sensor[Sensor::kDelay].free =
        options.sensor[Sensor::kCorner].free = true;
    options.sensor[Sensor::kDelay].value = 2e-6;
    options.sensor[Sensor::kCorner].value = 3.0;
    return StringUnknowns::frequencies(bowed.truth, options);
  }
  // Some standard deviations from the truth, so that the slopes are not those of noise alone.
  static ModelPoint beside(const StringUnknowns& unknowns) {
    Eigen::VectorXd theta = unknowns.start();
    theta[unknowns.contact()] = 5e-6;
    theta[0] += 1e-5;
    return unknowns.model(theta);
  }
  static BowedCase bowed;
};
BowedCase OneSecond::bowed;

// In units of standard deviations: √(J_iᵀJ_i) an unknown, √cost for the residual.
void expect_near(const LikelihoodPoint& a, const LikelihoodPoint& b, double error) {
  EXPECT_NEAR(a.cost / b.cost, 1.0, error);
  for (Eigen::Index i = 0; i < b.slope.size(); ++i) {
    const double own = std::sqrt(b.information(i, i));
    EXPECT_NEAR(a.slope[i] / own, b.slope[i] / own, error * std::sqrt(b.cost)) << i;
    if (a.information.size() == 0) continue;
    for (Eigen::Index j = 0; j <= i; ++j) {
      const double size = own * std::sqrt(b.information(j, j));
      EXPECT_NEAR(a.information(i, j) / size, b.information(i, j) / size, error) << i << ", " << j;
    }
  }
}

// A term at the nodes is off by 22e-14 of itself at most (mode_split.hpp). Errors of the end
// state's products grow by the inverse of the root of its ridge, 3e4: 7e-9, and the largest term of
// a sum may exceed the sum.
constexpr double kSkipped = 1e-8;

LikelihoodPoint twice(LikelihoodPoint point) {
  point.information = point.twice_weighted;
  return point;
}

TEST_F(OneSecond, FarModesAtNodesChangeNothing) {
  for (const double noise : {0.001, 0.1}) {
    for (const double sigma : {0.0, 20.0}) {
      const WhitenedRecord whitened = record(sigma, noise);
      for (const StringUnknowns& unknowns :
           {law(), StringUnknowns::frequencies(bowed.truth), every_unknown()}) {
        const ModelPoint point = beside(unknowns);
        const LikelihoodColumns columns = unknowns.columns(unknowns.start());
        const LikelihoodOutputs outputs{.twice_weighted = true};
        const LikelihoodPoint full =
            LikelihoodEvaluation(whitened, point, false).differentiate(columns, outputs);
        const LikelihoodPoint skipped =
            LikelihoodEvaluation(whitened, point).differentiate(columns, outputs);
        expect_near(skipped, full, kSkipped);
        expect_near(twice(skipped), twice(full), kSkipped);
      }
    }
  }
}

TEST_F(OneSecond, SlopeAloneIsThatOfTheColumns) {
  UnknownsOptions sensors{.damping = "power"};
  sensors.sensor[Sensor::kGain].free = sensors.sensor[Sensor::kDelay].free =
      sensors.sensor[Sensor::kCorner].free = true;
  sensors.sensor[Sensor::kDelay].value = 2e-6;
  sensors.sensor[Sensor::kCorner].value = 3.0;
  for (const double sigma : {0.0, 20.0}) {
    const WhitenedRecord whitened = record(sigma);
    for (const StringUnknowns& unknowns :
         {law(), law(sensors), StringUnknowns::frequencies(bowed.truth, {.damping = "each"})}) {
      const ModelPoint point = beside(unknowns);
      const LikelihoodColumns columns = unknowns.columns(unknowns.start());
      const LikelihoodPoint full = LikelihoodEvaluation(whitened, point).differentiate(columns, {});
      const LikelihoodPoint alone = LikelihoodEvaluation(whitened, point).slope(columns);
      // The same sums in another order.
      expect_near(alone, full, 1e-12);
    }
  }
}

// A string whose modes above the stated ones are in the model.
ModelPoint with_higher(ModelPoint point, bool bending) {
  point.higher = HigherModeLaw::above(point.basis, 196.0, 1.39e-4, 10300.0, bending);
  return point;
}

TEST_F(OneSecond, HigherModesChangeNoneOfThis) {
  UnknownsOptions sensors;
  sensors.sensor[Sensor::kGain].free = true;
  for (const bool bending : {false, true}) {
    ModelPoint truth = with_higher(bowed.truth, bending);
    // Beside modes above the band, whose decays are no unknowns.
    if (bending) truth.higher->ringing = 44;
    const std::vector<StringUnknowns> all = {StringUnknowns::law(truth, 196.0, 1.39e-4, sensors),
                                             StringUnknowns::frequencies(truth, sensors)};
    for (const double sigma : {0.0, 20.0}) {
      const WhitenedRecord whitened = record(sigma);
      for (const StringUnknowns& unknowns : all) {
        const ModelPoint point = beside(unknowns);
        const LikelihoodColumns columns = unknowns.columns(unknowns.start());
        const LikelihoodPoint full =
            LikelihoodEvaluation(whitened, point, false).differentiate(columns, {});
        // What is smooth at the record's end is nearly a sum of decays: there the ridge decides,
        // and an error of 1e-15 grows by its inverse, 1e9.
        constexpr double kDependent = 1e-6;
        expect_near(LikelihoodEvaluation(whitened, point).differentiate(columns, {}), full,
                    kDependent);
        expect_near(LikelihoodEvaluation(whitened, point).slope(columns), full, kDependent);
      }
    }
  }
}

// Half the difference quotients of the cost by some unknowns, in steps of a thousandth of a
// deviation: what is left is of third order. Returns the largest error, in √information.
double slope_error(const WhitenedRecord& whitened, const StringUnknowns& unknowns,
                   const Eigen::VectorXd& theta, Eigen::Index stride) {
  const auto cost = [&](const Eigen::VectorXd& at) {
    return LikelihoodEvaluation(whitened, unknowns.model(at)).slope(LikelihoodColumns{}).cost;
  };
  const LikelihoodColumns columns = unknowns.columns(theta);
  const ModelPoint point = unknowns.model(theta);
  const LikelihoodPoint at = LikelihoodEvaluation(whitened, point).slope(columns);
  const Eigen::VectorXd size = LikelihoodEvaluation(whitened, point)
                                   .differentiate(columns, {})
                                   .information.diagonal()
                                   .cwiseSqrt();
  double worst = 0.0;
  for (Eigen::Index i = 0; i < theta.size(); i += stride) {
    Eigen::VectorXd high = theta, low = theta;
    const double step = 1e-3 / size[i];
    high[i] += step, low[i] -= step;
    const double expected = 0.25 * (cost(high) - cost(low)) / step;
    worst = std::max(worst, std::abs(at.slope[i] - expected) / size[i]);
  }
  return worst;
}

// Beside an end state, too, where decays, sensors and what is smooth are nearly dependent.
TEST_F(OneSecond, SlopesAreThoseOfTheCostBesideHigherModes) {
  UnknownsOptions options;
  options.sensor[Sensor::kGain].free = true;
  for (const double sigma : {20.0, 0.0}) {
    const WhitenedRecord whitened = record(sigma);
    for (const bool bending : {false, true}) {
      ModelPoint truth = with_higher(bowed.truth, bending);
      truth.sensors.free = true;  // what a sensor holds is an unknown of the end state
      const StringUnknowns law = StringUnknowns::law(truth, 196.0, 1.39e-4, options);
      Eigen::VectorXd theta = law.start();
      theta[0] += 2e-5;  // off the optimum, where slopes are large
      EXPECT_LT(slope_error(whitened, law, theta, 1), 1e-4) << sigma << bending;
      options.damping = "each";
      const StringUnknowns every = StringUnknowns::frequencies(truth, options);
      EXPECT_LT(slope_error(whitened, every, every.start(), 5), 1e-4) << sigma << bending;
    }
  }
}

// 50 stated modes and some that stand for all others, against 1900 modes: the same H_1 and H_2.
TEST_F(OneSecond, HigherModesStandForNineteenHundred) {
  const WhitenedRecord whitened = record(20.0);
  const auto transfers = [&](const ModelPoint& point) {
    std::array<std::vector<Complex>, 2> found;
    LikelihoodOutputs outputs{.left = &found[0], .right = &found[1]};
    LikelihoodEvaluation(whitened, point)
        .differentiate(
            {.count = 0,
             .share_begin = std::vector<std::size_t>(likelihood_modes(point, 51200.0).size() + 1)},
            outputs);
    return found;
  };
  const auto few = transfers(with_higher(bowed.truth, false));
  // In so wide a band they stand for themselves.
  ModelPoint many = bowed.truth;
  many.higher = HigherModeLaw::above(many.basis, 196.0, 1.39e-4, 300000.0);
  const auto all = transfers(many);
  double error = 0.0, size = 0.0;
  for (std::size_t end = 0; end < 2; ++end) {
    for (std::size_t k = 0; k < few[end].size(); ++k) {
      error = std::max(error, std::abs(few[end][k] - all[end][k]));
      size = std::max(size, 1.0 / whitened.deviation[end]);  // of a static force
    }
  }
  EXPECT_LT(error, 1e-5 * size);
}

// Of frequencies, the contact, damping shared by all modes or each mode's own, and sensors, which
// no mode's products tell.
TEST_F(OneSecond, RowsAreThoseOfTheWholeInformation) {
  UnknownsOptions sensors;
  sensors.sensor[Sensor::kGain].free = sensors.sensor[Sensor::kCorner].free = true;
  sensors.sensor[Sensor::kCorner].value = 3.0;
  const StringUnknowns frequencies = StringUnknowns::frequencies(bowed.truth);
  const StringUnknowns sensed = StringUnknowns::frequencies(bowed.truth, sensors);
  const StringUnknowns every = every_unknown();
  struct Case {
    const StringUnknowns* unknowns;
    std::vector<std::size_t> wanted;
  };
  const std::vector<Case> cases = {{&frequencies, {7}},
                                   {&frequencies, {0, 10, 43, 50, 51}},
                                   {&sensed, {3, 51, 52}},
                                   {&sensed, {1, 10, 43, 50}},
                                   {&every, {20, 70}}};
  for (const double sigma : {0.0, 20.0}) {
    const WhitenedRecord whitened = record(sigma);
    for (const Case& the : cases) {
      const ModelPoint point = beside(*the.unknowns);
      const LikelihoodColumns columns = the.unknowns->columns(the.unknowns->start());
      ASSERT_TRUE(LikelihoodEvaluation::may_give_rows(columns, the.wanted));
      const LikelihoodPoint full = LikelihoodEvaluation(whitened, point).differentiate(columns, {});
      LikelihoodPoint some = LikelihoodEvaluation(whitened, point).rows(columns, the.wanted);
      ASSERT_EQ(some.information.rows(), static_cast<Eigen::Index>(the.wanted.size()));
      const Eigen::MatrixXd rows = some.information;
      some.information = full.information;
      for (std::size_t i = 0; i < the.wanted.size(); ++i) {
        const auto row = static_cast<Eigen::Index>(the.wanted[i]);
        some.information.row(row) = rows.row(static_cast<Eigen::Index>(i));
        some.information.col(row) = some.information.row(row).transpose();
      }
      expect_near(some, full, kSkipped);
    }
  }
}

TEST_F(OneSecond, RowsOfTooManyUnknownsAreAllRows) {
  const StringUnknowns unknowns = StringUnknowns::frequencies(bowed.truth);
  const LikelihoodColumns columns = unknowns.columns(unknowns.start());
  const ProjectedLikelihood likelihood(record(0.0));
  const ModelPoint point = beside(unknowns);
  const std::vector<std::size_t> many = {0, 1, 2, 3, 4, 5, 6};
  const LikelihoodPoint all = likelihood.rows(point, columns, many);
  EXPECT_TRUE(all.information == likelihood.evaluate(point, columns).information);
  const LikelihoodPoint none = likelihood.rows(point, columns, {});
  EXPECT_EQ(none.information.rows(), 0);
  EXPECT_TRUE(none.slope == likelihood.slope(point, columns).slope);
}

// Information in refused trials and where the last step ends decides nothing.
TEST_F(OneSecond, NewtonStepsWithoutInformationEndAtTheSameOptimum) {
  std::size_t slopes = 0, partial = 0;
  for (const double noise : {0.001, 0.01, 0.1}) {
    const ProjectedLikelihood likelihood(record(0.0, noise));
    for (const StringUnknowns& unknowns : {law(), StringUnknowns::frequencies(bowed.truth)}) {
      Eigen::VectorXd start = unknowns.start();
      start[0] += 1e-4 * noise;
      start[unknowns.contact()] += 1e-4 * noise;
      NewtonOptions options{.steps = 20, .tolerance = 1e-4, .frequency_cap = 1e-3};
      if (!unknowns.is_law()) {
        options.prior = Eigen::VectorXd::Constant(50, 1.0 / (2e-3 * 2e-3)).asDiagonal();
      }
      FitTarget everywhere{
          .evaluate =
              [&](const Eigen::VectorXd& theta) {
                return likelihood.evaluate(unknowns.model(theta), unknowns.columns(theta));
              },
          .admits = [&](const Eigen::VectorXd& theta) { return unknowns.admits(theta); },
          .capped = unknowns.is_law() ? 0 : 50};
      const NewtonFit full = newton_fit(everywhere, start, options);
      const NewtonFit lazy = newton_fit(likelihood, unknowns, start, options);
      EXPECT_TRUE(full.converged);
      EXPECT_TRUE(lazy.converged);
      slopes += lazy.slopes;
      partial += lazy.partial;
      const LikelihoodPoint at = likelihood.evaluate(
          unknowns.model(full.theta), unknowns.columns(full.theta), {.twice_weighted = true});
      const Eigen::VectorXd deviation = fit_covariance(at, options).diagonal().cwiseSqrt();
      // The decrease left is below half the tolerance in both: 7e-3 each, and convergence is
      // quadratic, so that the last step leaves less than a seventh of that.
      const Eigen::VectorXd apart = (full.theta - lazy.theta).cwiseQuotient(deviation);
      EXPECT_LT(apart.cwiseAbs().maxCoeff(), 1e-3) << noise << ", " << unknowns.size();
    }
  }
  EXPECT_GT(slopes, 0u);
  EXPECT_GT(partial, 0u);  // steps late in a fit move a few weakly seen modes alone
}

TEST_F(OneSecond, AKnownStartSavesItsEvaluationAndNoBit) {
  const ProjectedLikelihood likelihood(record(0.0));
  const StringUnknowns unknowns = StringUnknowns::frequencies(bowed.truth);
  const Eigen::VectorXd start = unknowns.start();
  NewtonOptions options{.frequency_cap = 1e-3};
  options.prior = Eigen::VectorXd::Constant(50, 1.0 / (2e-3 * 2e-3)).asDiagonal();
  const NewtonFit alone = newton_fit(likelihood, unknowns, start, options);
  const LikelihoodPoint at =
      likelihood.evaluate(unknowns.model(start), unknowns.columns(start), {.twice_weighted = true});
  options.at_start = &at;
  const NewtonFit told = newton_fit(likelihood, unknowns, start, options);
  EXPECT_TRUE(told.theta == alone.theta);
  EXPECT_EQ(told.objective, alone.objective);
  EXPECT_EQ(told.evaluations + 1, alone.evaluations);
}

TEST_F(OneSecond, TakesOtherDataOfTheSameModel) {
  UnknownsOptions sensors;
  sensors.sensor[Sensor::kDelay].free = true;
  sensors.sensor[Sensor::kDelay].value = 2e-6;
  const StringUnknowns unknowns = law(sensors);
  const ModelPoint point = beside(unknowns);
  const LikelihoodColumns columns = unknowns.columns(unknowns.start());
  const WhitenedRecord whitened = record(0.0), other = whitened.noise(7);
  LikelihoodEvaluation evaluation(whitened, point);
  evaluation.differentiate(columns, {});
  evaluation.take(other);
  const LikelihoodPoint again = evaluation.differentiate(columns, {});
  const LikelihoodPoint anew = LikelihoodEvaluation(other, point).differentiate(columns, {});
  EXPECT_EQ(again.cost, anew.cost);
  EXPECT_TRUE(again.information == anew.information);
}

// Runs `work` with so many threads, more than the machine has if need be.
template <typename Work>
void with_threads(int threads, const Work& work) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  tbb::task_arena(threads).execute(work);
}

void expect_same_bits(const LikelihoodPoint& a, const LikelihoodPoint& b) {
  EXPECT_EQ(a.cost, b.cost);
  EXPECT_TRUE(a.slope == b.slope);
  EXPECT_TRUE(a.information == b.information);
  EXPECT_TRUE(a.twice_weighted == b.twice_weighted);
}

TEST_F(OneSecond, ThreadsDoNotChangeABit) {
  const WhitenedRecord whitened = record(0.0);
  for (const StringUnknowns& unknowns : {law(), StringUnknowns::frequencies(bowed.truth)}) {
    const ModelPoint point = beside(unknowns);
    const LikelihoodColumns columns = unknowns.columns(unknowns.start());
    const auto evaluate = [&] {
      return LikelihoodEvaluation(whitened, point).differentiate(columns, {.twice_weighted = true});
    };
    const std::vector<std::size_t> wanted = {0, static_cast<std::size_t>(unknowns.contact())};
    LikelihoodPoint one, slope, rows;
    with_threads(1, [&] {
      one = evaluate();
      slope = LikelihoodEvaluation(whitened, point).slope(columns);
      rows = LikelihoodEvaluation(whitened, point).rows(columns, wanted);
    });
    for (const int threads : {2, 3}) {
      with_threads(threads, [&] {
        expect_same_bits(evaluate(), one);
        expect_same_bits(LikelihoodEvaluation(whitened, point).slope(columns), slope);
        expect_same_bits(LikelihoodEvaluation(whitened, point).rows(columns, wanted), rows);
        // Inside the tasks of a sweep, whose own loops share the threads.
        std::vector<LikelihoodPoint> found(5);
        for_each_task(found.size(), [&](std::size_t i) { found[i] = evaluate(); });
        for (const LikelihoodPoint& each : found) expect_same_bits(each, one);
      });
    }
  }
}

}  // namespace
}  // namespace modcal::likelihood_evaluation_test
