#include "libcalib/likelihood/bin_weights.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "libcalib/optimizers/staged/continuation.hpp"
#include "libcalib/parameters/string_unknowns.hpp"
#include "libsim/base/error.hpp"
#include "tests/libcalib/likelihood/bowed_case.hpp"

namespace modcal::bin_weights_test {
namespace {

constexpr double kAutomatic = std::numeric_limits<double>::quiet_NaN();

TEST(WeightsOfExcess, TellLinesFromNoise) {
  // |f̂|² of a flat floor of S = 0.2 with a line of S = 50 every hundred bins: exponential, mean
  // 1 + S.
  constexpr std::size_t kBins = 20000;
  std::vector<double> draw(kBins), excess(kBins), gain(kBins, 3.0);
  fill_uniform(StreamKey(7).with("weights"), draw);
  const auto signal = [](std::size_t k) { return k % 100 == 50 ? 50.0 : 0.2; };
  for (std::size_t k = 0; k < kBins; ++k) {
    excess[k] = -(1.0 + signal(k)) * std::log(1.0 - draw[k]) - 1.0;
  }
  const std::vector<double> weights = weights_of_excess(excess, gain);
  double floor = 0.0, lines = 0.0;
  for (std::size_t k = 0; k < kBins; ++k) {
    if (k % 100 == 50) lines += weights[k] / 200.0;
    if (k % 100 < 40 || k % 100 > 60) floor += weights[k] / (kBins * 0.79);
  }
  // 0.2/1.2; S of 121 bins is known to 1.2/11, which the curvature of w turns into less than 0.01;
  // 165 independent stretches bring the scatter to 0.007. Four of both.
  EXPECT_NEAR(floor, 1.0 / 6.0, 0.04);
  // A line's 51 x, x exponential, is spread over five bins, and without proof (x < 0.3, 0.26 of
  // them) it has the floor's weight: 0.26/6 + ∫ S/(1 + S) e^−x dx = 0.71. 200 lines: 0.024.
  EXPECT_NEAR(lines, 0.71, 0.1);
}

TEST(WeightsOfExcess, AreZeroWhereThereIsLessThanNoise) {
  const std::vector<double> weights =
      weights_of_excess(std::vector<double>(300, -0.1), std::vector<double>(300, 1.0));
  for (const double weight : weights) EXPECT_EQ(weight, 0.0);
}

TEST(InformationWeights, RefuseALikelihoodThatHasWeights) {
  const BowedCase bowed = bowed_case(0.03, 0.0, 0.05);
  ProjectedLikelihood likelihood(WhitenedRecord::of(
      noisy(bowed, 0.1, 1), 0.0, likelihood_band(bowed.truth, kAutomatic, 51200.0)));
  likelihood.set_weights(std::vector<double>(likelihood.record().bins, 0.5));
  const StringUnknowns law = StringUnknowns::law(bowed.truth, 196.0, 0.0);
  EXPECT_THROW(information_weights(likelihood, bowed.truth, law.columns(law.start())),
               InvalidInput);
}

TEST(InformationWeights, ScoreHasTheVarianceThatTheCovarianceTakes) {
  // Var Re JᴴWe = ½ E JᵀW²J: the middle of the sandwich H⁻¹(2 JᵀW²J)H⁻¹.
  const BowedCase bowed = bowed_case(0.0285, 1.39e-4, 0.1);
  const double highest = likelihood_band(bowed.truth, kAutomatic, 51200.0);
  const StringUnknowns law = StringUnknowns::law(bowed.truth, 196.0, 1.39e-4);
  const LikelihoodColumns columns = law.columns(law.start());
  const ProjectedLikelihood first(WhitenedRecord::of(noisy(bowed, 0.1, 999), 0.0, highest));
  const std::vector<double> weights = information_weights(first, bowed.truth, columns);
  constexpr int kDraws = 400;
  Eigen::MatrixXd variance = Eigen::MatrixXd::Zero(4, 4), expected = variance;
  for (std::uint64_t seed = 0; seed < kDraws; ++seed) {
    ProjectedLikelihood likelihood(WhitenedRecord::of(noisy(bowed, 0.1, seed), 0.0, highest));
    likelihood.set_weights(weights);
    const LikelihoodPoint at = likelihood.evaluate(bowed.truth, columns, {.twice_weighted = true});
    variance += at.slope * at.slope.transpose() / kDraws;
    expected += 0.5 * at.twice_weighted / kDraws;
  }
  for (Eigen::Index i = 0; i < 4; ++i) {
    // A variance of 400 draws is known to √(2/400) = 0.07; four of them.
    EXPECT_NEAR(variance(i, i) / expected(i, i), 1.0, 0.28) << i;
  }
}

// Mean square of what an estimate of B adds to the error of the efficient one, in squared bounds,
// to first order: δ = −(J̃ᵀJ)⁻¹J̃ᵀe with J̃ = w J of the noisy record, J̃ = J of the clean one where
// it is efficient. The two errors differ by noise that the efficient one is free of.
struct LossOfB {
  double none = 0.0, estimated = 0.0, known = 0.0;
};

LossOfB loss_of_b(const BowedCase& bowed, double inharmonicity, double level, int draws) {
  const double highest = likelihood_band(bowed.truth, kAutomatic, 51200.0);
  const StringUnknowns law = StringUnknowns::law(bowed.truth, 196.0, inharmonicity);
  const LikelihoodColumns columns = law.columns(law.start());
  const ProjectedLikelihood whole(WhitenedRecord::of(noisy(bowed, level, 1, false), 0.0, highest));
  Eigen::MatrixXd clean, jacobian;
  std::vector<Complex> force;
  std::vector<double> known;
  const Eigen::MatrixXd inverse =
      whole.evaluate(bowed.truth, columns, {.jacobian = &clean, .force = &force, .gain = &known})
          .information.inverse();
  clean.conservativeResize(static_cast<Eigen::Index>(2 * known.size()), Eigen::NoChange);
  const double bound = 0.5 * inverse(1, 1);
  for (std::size_t k = 0; k < known.size(); ++k) {
    const double signal = known[k] * std::norm(force[k]);
    known[k] = signal / (1.0 + signal);
  }
  LossOfB loss;
  for (int seed = 0; seed < draws; ++seed) {
    const ProjectedLikelihood likelihood(
        WhitenedRecord::of(noisy(bowed, level, static_cast<std::uint64_t>(seed)), 0.0, highest));
    std::vector<double> residuals;
    likelihood.evaluate(bowed.truth, columns, {.residuals = &residuals, .jacobian = &jacobian});
    // Of the bins, without the cost of the end state.
    const auto numbers = static_cast<Eigen::Index>(2 * known.size());
    const Eigen::Map<const Eigen::VectorXd> e(residuals.data(), numbers);
    jacobian.conservativeResize(numbers, Eigen::NoChange);
    const double efficient = (inverse * (clean.transpose() * e))[1];
    const auto added = [&](const std::vector<double>& weights) {
      Eigen::VectorXd twice(e.size());
      for (Eigen::Index i = 0; i < e.size(); ++i)
        twice[i] = weights[static_cast<std::size_t>(i / 2)];
      const Eigen::MatrixXd instrument = twice.asDiagonal() * jacobian;
      const Eigen::VectorXd error =
          (instrument.transpose() * clean).inverse() * (instrument.transpose() * e);
      return std::pow(error[1] - efficient, 2) / (bound * draws);
    };
    loss.none += added(std::vector<double>(known.size(), 1.0));
    loss.known += added(known);
    loss.estimated += added(information_weights(likelihood, bowed.truth, columns));
  }
  return loss;
}

TEST(InformationWeights, LoseLittleMoreThanWeightsOfTheTrueForce) {
  // A stiff string at 10 % noise. Over 100 draws the loss is 2.2 without weights, 0.31 with the
  // true |F|², 0.36 with these. The mean of 16 squares is known to √(2/16) = 0.35.
  const LossOfB loss = loss_of_b(bowed_case(0.03, 4e-4, 1.0), 4e-4, 0.1, 16);
  EXPECT_GT(loss.none, 0.8);
  EXPECT_LT(loss.known, 0.31 * (1.0 + 4.0 * 0.35));
  EXPECT_LT(loss.estimated, 0.5 * loss.none);
  // The same draws: what separates the two is a tenth of a bound.
  EXPECT_LT(loss.estimated, 1.6 * loss.known);
}

}  // namespace
}  // namespace modcal::bin_weights_test
