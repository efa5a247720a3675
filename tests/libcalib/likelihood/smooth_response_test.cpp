#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numbers>

#include "libcalib/likelihood/likelihood_evaluation.hpp"
#include "libcalib/likelihood/pluck/pluck_likelihood.hpp"
#include "libcalib/parameters/string_unknowns.hpp"
#include "tests/libcalib/likelihood/bowed_case.hpp"
#include "tests/libcalib/likelihood/pluck_record_case.hpp"

namespace modcal::smooth_response_test {
namespace {

using Index = Eigen::Index;

constexpr double kBand = 2.0 * std::numbers::pi * 10300.0;

TEST(SmoothResponse, IsLinearBetweenItsKnotsAndConstantAboveTheLast) {
  const SmoothResponse smooth{.knots = {{1.0, 2.0}, {3.0, 0.0}, {-1.0, 1.0}}, .spacing = 10.0};
  EXPECT_EQ(smooth.at(0.0), std::complex<double>(1.0, 2.0));
  EXPECT_EQ(smooth.at(5.0), std::complex<double>(2.0, 1.0));
  EXPECT_EQ(smooth.at(10.0), std::complex<double>(3.0, 0.0));
  EXPECT_EQ(smooth.at(20.0), std::complex<double>(-1.0, 1.0));
  EXPECT_EQ(smooth.at(1e4), std::complex<double>(-1.0, 1.0));
  EXPECT_EQ(SmoothResponse().at(5.0), 0.0);
  EXPECT_TRUE(SmoothResponse().zero());
  EXPECT_FALSE(smooth.zero());
}

TEST(ResponseOptions, HaveAKnotAModeOrMore) {
  const ModalBasis basis = make_modal_basis(paper_scene().string);  // 196 Hz
  const double top = basis.frequency(basis.size() - 1);
  const ResponseOptions automatic = ResponseOptions().laid_out(basis);
  EXPECT_NEAR(automatic.spacing, basis.frequency(0), 1e-9);
  EXPECT_GE(static_cast<double>(automatic.knots - 1) * automatic.spacing, top);
  ResponseOptions stated{.spacing = 500.0};
  EXPECT_EQ(stated.laid_out(basis).knots,
            static_cast<std::size_t>(std::ceil(1.02 * top / 500.0)) + 1);
  stated.spacing = 1.0;
  EXPECT_THROW(stated.laid_out(basis), InvalidInput);
}

class WithResponse : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { bowed = bowed_case(0.0285, 1.39e-4, 1.0); }

  static WhitenedRecord record(double sigma) {
    return WhitenedRecord::of(noisy(bowed, 0.02, 3), sigma, kBand);
  }
  static UnknownsOptions options(bool gain) {
    UnknownsOptions result{.response = {.free = true, .spacing = 700.0}};
    result.response = result.response.laid_out(bowed.truth.basis);
    result.sensor[Sensor::kGain].free = gain;
    return result;
  }
  // A model whose response is not 1, a little beside the truth.
  static ModelPoint reference(const UnknownsOptions& options) {
    ModelPoint point = bowed.truth;
    point.contact += 2e-5;
    point.sensors = options.sensors();
    for (std::size_t k = 0; k < point.sensors.smooth.knots.size(); ++k) {
      const double place = static_cast<double>(k);
      point.sensors.smooth.knots[k] = {2e-3 * std::cos(place), 3e-3 * std::sin(2.0 * place)};
    }
    return point;
  }
  // Few columns that all modes share, and many.
  static std::vector<StringUnknowns> unknowns(bool gain) {
    const ModelPoint point = reference(options(gain));
    return {StringUnknowns::law(point, 196.0, 1.39e-4, options(gain)),
            StringUnknowns::frequencies(point, options(gain))};
  }
  static BowedCase bowed;
};
BowedCase WithResponse::bowed;

TEST_F(WithResponse, StandsBehindWhatHasAName) {
  const UnknownsOptions free = options(true);
  const StringUnknowns law = unknowns(true)[0];
  const auto knots = static_cast<Index>(free.response.knots);
  EXPECT_EQ(law.size(), 5 + 2 * knots);  // f0, B, x_c, damping, gain
  EXPECT_EQ(law.named(), 5);
  Eigen::VectorXd theta = law.start();
  theta[law.named() + 2] = 1e-3;
  theta[law.named() + 3] = -2e-3;
  const ModelPoint moved = law.model(theta);
  EXPECT_EQ(moved.sensors.smooth.knots[1] - law.model(law.start()).sensors.smooth.knots[1],
            std::complex<double>(1e-3, -2e-3));
  EXPECT_LT((law.theta_of(moved) - theta).tail(2 * knots).norm(), 1e-15);
  EXPECT_EQ(law.without_damping_and_sensors().size(), 3);
  theta[law.named()] = 0.8;
  EXPECT_FALSE(law.admits(theta));
}

TEST_F(WithResponse, HasTheRootsOfItsVariancesForDeviations) {
  const StringUnknowns law = unknowns(true)[0];
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Constant(law.size(), law.size(), 0.1);
  for (Index i = 0; i < law.size(); ++i) {
    covariance(i, i) = static_cast<double>((i + 1) * (i + 1));
  }
  const std::vector<Complex> deviations = law.response_deviations(covariance);
  ASSERT_EQ(deviations.size(), options(true).response.knots);
  for (std::size_t k = 0; k < deviations.size(); ++k) {
    const double place = static_cast<double>(law.named()) + 2.0 * static_cast<double>(k) + 1.0;
    EXPECT_EQ(deviations[k], Complex(place, place + 1.0)) << k;
  }
}

TEST_F(WithResponse, IsHeldByItsPriorAboutNothing) {
  const StringUnknowns law = unknowns(false)[0];
  const QuadraticPrior prior = law.prior(law.start());
  const ModelPoint at = law.model(law.start());
  for (std::size_t k = 0; k < at.sensors.smooth.knots.size(); ++k) {
    const Index i = law.named() + 2 * static_cast<Index>(k);
    EXPECT_NEAR(prior.precision(i, i), 1.0 / (5e-3 * 5e-3), 1e-6 / (5e-3 * 5e-3));
    EXPECT_NEAR(prior.mean[i], -at.sensors.smooth.knots[k].real(), 1e-12);
    EXPECT_NEAR(prior.mean[i + 1], -at.sensors.smooth.knots[k].imag(), 1e-12);
  }
}

TEST_F(WithResponse, GradientIsTheDifferenceQuotient) {
  for (const double sigma : {0.0, 40.0}) {
    const ProjectedLikelihood likelihood(record(sigma));
    for (const StringUnknowns& all : unknowns(true)) {
      const Eigen::VectorXd start = all.start();
      const LikelihoodPoint at = likelihood.evaluate(all.model(start), all.columns(start));
      for (Index i = all.named() - 1; i < all.size(); ++i) {
        Eigen::VectorXd step = Eigen::VectorXd::Zero(all.size());
        step[i] = 1e-5;
        const double quotient =
            (likelihood.cost(all.model(start + step)) - likelihood.cost(all.model(start - step))) /
            2e-5;
        // As for other columns (projected_likelihood_test).
        const double size = std::sqrt(at.information(i, i) * at.cost);
        EXPECT_NEAR(quotient, 2.0 * at.slope[i], 1e-4 * size + 1e-9 * at.cost)
            << i << ", sigma " << sigma;
      }
    }
  }
}

TEST_F(WithResponse, GradientOfAPluckIsTheDifferenceQuotient) {
  const PluckLikelihood pluck(
      WhitenedRecord::of(plucked_records(1.39e-4, 0.5, 0.01, 5), 0.0, kBand));
  const StringUnknowns all = unknowns(true)[1];
  const Eigen::VectorXd start = all.start();
  const LikelihoodPoint at = pluck.evaluate(all.model(start), all.columns(start));
  for (Index i = all.named(); i < all.size(); ++i) {
    Eigen::VectorXd step = Eigen::VectorXd::Zero(all.size());
    step[i] = 1e-3;  // of a nearly linear residual; its square is some 1e-6 of the slope
    const double quotient =
        (pluck.cost(all.model(start + step)) - pluck.cost(all.model(start - step))) / 2e-3;
    // What is projected out leaves rounding of 1e-10 of the cost.
    const double size = std::sqrt(at.information(i, i) * at.cost);
    EXPECT_NEAR(quotient, 2.0 * at.slope[i], 1e-4 * size + 1e-10 * at.cost / 2e-3) << i;
  }
}

TEST(Sensor, IsUndoneWithItsSmoothResponse) {
  // A line in a bin, a quarter of the way between two knots.
  constexpr double kRate = 1000.0;
  constexpr std::size_t kSamples = 500;
  const double omega = 2.0 * std::numbers::pi * 120.0;
  Sensor sensor{.gain = 1.1};
  sensor.smooth = {.knots = {0.0, {0.02, 0.03}, {-0.01, 0.01}}, .spacing = omega / 1.25};
  const std::complex<double> read = sensor.response({0.0, omega});
  std::vector<double> samples(kSamples);
  for (std::size_t j = 0; j < kSamples; ++j) {
    samples[j] = (read * std::polar(1.0, omega * static_cast<double>(j) / kRate)).real();
  }
  const std::vector<double> undone = sensor.undone(samples, kRate);
  for (std::size_t j = 0; j < kSamples; ++j) {
    EXPECT_NEAR(undone[j], std::cos(omega * static_cast<double>(j) / kRate), 1e-12);
  }
}

// Largest difference in units of the columns' own lengths.
double difference(const Eigen::MatrixXd& found, const Eigen::MatrixXd& expected,
                  const LikelihoodPoint& at) {
  const Eigen::VectorXd norms =
      at.information.diagonal().cwiseMax(1e-30).cwiseSqrt().cwiseInverse();
  return (norms.asDiagonal() * (found - expected) * norms.asDiagonal()).cwiseAbs().maxCoeff();
}

WhitenedRecord weighted(WhitenedRecord record) {
  for (std::size_t k = 0; k < record.bins; ++k) {
    record.root_weight[k] = 0.3 + 0.7 * static_cast<double>(k % 7) / 6.0;
  }
  return record;
}

TEST_F(WithResponse, InformationIsThatOfTheColumns) {
  for (const double sigma : {0.0, 40.0}) {
    const WhitenedRecord whitened = weighted(record(sigma));
    for (const StringUnknowns& all : unknowns(true)) {
      const ModelPoint point = all.model(all.start());
      const LikelihoodColumns columns = all.columns(all.start());
      Eigen::MatrixXd jacobian;
      const LikelihoodPoint at =
          LikelihoodEvaluation(whitened, point)
              .differentiate(columns, {.twice_weighted = true, .jacobian = &jacobian});
      Eigen::VectorXd weights(jacobian.rows());
      for (Index i = 0; i < weights.size(); ++i) {
        weights[i] = whitened.root_weight[static_cast<std::size_t>(i / 2)];
      }
      const Eigen::MatrixXd twice = weights.asDiagonal() * jacobian;
      EXPECT_LT(difference(at.twice_weighted, twice.transpose() * twice, at), 1e-9) << sigma;
      const LikelihoodPoint alone = LikelihoodEvaluation(whitened, point).slope(columns);
      const Eigen::VectorXd errors = at.information.diagonal().cwiseMax(1e-30).cwiseSqrt();
      EXPECT_LT((alone.slope - at.slope).cwiseQuotient(errors).norm(), 1e-11 * std::sqrt(at.cost));
      // At sigma = 0 the ridge of the end state stands between the two.
      if (sigma == 0.0) continue;
      EXPECT_LT(difference(at.information, jacobian.transpose() * jacobian, at), 1e-8);
    }
  }
}

// A knot is half of either neighbor and all of its own of twice as many, and all together are the
// gain: identities of the columns, whatever is projected out of them.
TEST_F(WithResponse, InformationOfManyKnotsIsThatOfFewer) {
  const WhitenedRecord whitened = weighted(record(0.0));
  UnknownsOptions coarse = options(true), fine = coarse;
  fine.response.spacing = 0.5 * coarse.response.spacing;
  fine.response.knots = 2 * coarse.response.knots - 1;
  for (const bool law : {true, false}) {
    const auto of = [&](const UnknownsOptions& free) {
      ModelPoint point = bowed.truth;
      point.contact += 2e-5;
      point.sensors = free.sensors();
      return law ? StringUnknowns::law(point, 196.0, 1.39e-4, free)
                 : StringUnknowns::frequencies(point, free);
    };
    const StringUnknowns few = of(coarse), many = of(fine);
    const auto at = [&](const StringUnknowns& all) {
      return LikelihoodEvaluation(whitened, all.model(all.start()))
          .differentiate(all.columns(all.start()), {.twice_weighted = true});
    };
    const LikelihoodPoint point = at(few), finer = at(many);
    const Index named = few.named();
    Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(many.size(), few.size());
    sums.topLeftCorner(named, named).setIdentity();
    for (Index i = 0; i < few.size() - named; ++i) {
      const Index own = named + 2 * i - i % 2;  // real and imaginary parts in turn
      sums(own, named + i) = 1.0;
      if (own - 2 >= named) sums(own - 2, named + i) = 0.5;
      if (own + 2 < many.size()) sums(own + 2, named + i) = 0.5;
    }
    // Products of the same numbers, added up in another order.
    EXPECT_LT(difference(sums.transpose() * finer.information * sums, point.information, point),
              1e-8);
    EXPECT_LT(
        difference(sums.transpose() * finer.twice_weighted * sums, point.twice_weighted, point),
        1e-8);
    Eigen::VectorXd all = Eigen::VectorXd::Zero(few.size());
    for (Index i = named; i < few.size(); i += 2) all[i] = 1.0;
    const double by_gain = point.information(named - 1, named - 1);
    EXPECT_NEAR(all.dot(point.information * all), by_gain, 1e-8 * by_gain);
    EXPECT_NEAR(all.dot(point.slope), point.slope[named - 1],
                1e-9 * std::sqrt(by_gain * point.cost));
  }
}

TEST_F(WithResponse, ThreadsAndNodesChangeNothing) {
  const WhitenedRecord whitened = record(0.0);
  for (const StringUnknowns& all : unknowns(true)) {
    const ModelPoint point = all.model(all.start());
    const LikelihoodColumns columns = all.columns(all.start());
    const auto evaluate = [&](int threads, bool nodes) {
      const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                        static_cast<std::size_t>(threads));
      return LikelihoodEvaluation(whitened, point, nodes)
          .differentiate(columns, {.twice_weighted = true});
    };
    const LikelihoodPoint one = evaluate(1, true), two = evaluate(2, true),
                          full = evaluate(2, false);
    EXPECT_TRUE(one.information == two.information);
    EXPECT_TRUE(one.slope == two.slope);
    EXPECT_TRUE(one.twice_weighted == two.twice_weighted);
    // As without a response (likelihood_evaluation_test).
    EXPECT_LT(difference(one.information, full.information, full), 1e-8);
  }
}

}  // namespace
}  // namespace modcal::smooth_response_test
