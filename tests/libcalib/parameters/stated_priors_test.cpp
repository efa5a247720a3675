// What is known beforehand, in a fit to synthetic truth.
#include "libcalib/parameters/stated_priors.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "libcalib/calibration.hpp"
#include "libcalib/optimizers/staged/continuation.hpp"
#include "libcalib/optimizers/staged/newton_fit.hpp"
#include "libsim/base/error.hpp"
#include "tests/libcalib/likelihood/bowed_case.hpp"
#include "tests/libcalib/optimizers/staged/as_calibration.hpp"

namespace modcal::stated_priors_test {
namespace {

constexpr double kBand = 2.0 * std::numbers::pi * 10300.0;
constexpr double kInharmonicity = 1.39e-4;

UnknownsOptions stating(std::vector<ParameterPrior> priors,
                        std::vector<PriorCorrelation> correlations = {}) {
  UnknownsOptions options;
  options.sensor[Sensor::kGain].free = options.sensor[Sensor::kDelay].free = true;
  options.priors = std::move(priors);
  options.correlations = std::move(correlations);
  return options;
}

ModelPoint stiff_string() {
  Scene scene = paper_scene();
  scene.string.inharmonicity = kInharmonicity;
  return {make_modal_basis(scene.string), 0.0285};
}

TEST(StatedPriors, HaveTheCovarianceStated) {
  const UnknownsOptions options =
      stating({{"gain", 1.0, 0.02}, {"delay", 1e-6, 2e-6}}, {{{"gain", "delay"}, 0.5}});
  ModelPoint point = stiff_string();
  point.sensors.gain = 1.1;
  const StringUnknowns unknowns =
      StringUnknowns::law(point, 196.0, 0.0, options, StatedPriors(options, point));
  const Eigen::Index at =
      static_cast<Eigen::Index>(*unknowns.parameters().find(ParameterKind::kSensor, Sensor::kGain));
  const QuadraticPrior prior = unknowns.prior(unknowns.start());
  const Eigen::Matrix2d covariance = prior.precision.block<2, 2>(at, at).inverse();
  EXPECT_NEAR(covariance(0, 0), 0.02 * 0.02, 1e-12);
  EXPECT_NEAR(covariance(1, 1), 4e-12, 1e-20);
  EXPECT_NEAR(covariance(0, 1), 0.5 * 0.02 * 2e-6, 1e-15);
  EXPECT_NEAR(prior.mean[at], std::log(1.0 / 1.1), 1e-12);
  EXPECT_NEAR(prior.mean[at + 1], 1e-6, 1e-18);
  EXPECT_FALSE(unknowns.parameters().find(ParameterKind::kSensor, Sensor::kCorner));
}

TEST(StatedPriors, OfALawAreThoseOfFrequenciesThatScatterAboutIt) {
  // δ = L l + scatter, l = (ln f0, B) Gaussian: δ ~ N(L m, W⁻¹ + L C Lᵀ).
  const double f0 = 196.5, b = 1.4e-4, width = 3e-4;
  const UnknownsOptions options =
      stating({{"f0", f0, 0.1}, {"B", b, 2e-6}, {"x_c", 0.029, 1e-3}}, {{{"B", "f0"}, -0.6}});
  const ModelPoint point = stiff_string();
  const StringUnknowns unknowns =
      StringUnknowns::frequencies(point, options, StatedPriors(options, point));
  const QuadraticPrior prior =
      unknowns.prior(unknowns.start(), {Eigen::VectorXd::Constant(50, width), kInharmonicity});
  Eigen::MatrixXd slopes(50, 2);
  Eigen::VectorXd expected(50);
  for (Eigen::Index i = 0; i < 50; ++i) {
    const double n2 = static_cast<double>((i + 1) * (i + 1));
    slopes(i, 0) = 1.0;
    slopes(i, 1) = 0.5 * n2 / (1.0 + kInharmonicity * n2);
    expected[i] = std::log(f0 / 196.0) + slopes(i, 1) * (b - kInharmonicity);
  }
  const double sd = 0.1 / f0;
  const Eigen::Matrix2d law{{sd * sd, -0.6 * sd * 2e-6}, {-0.6 * sd * 2e-6, 4e-12}};
  Eigen::MatrixXd covariance = slopes * law * slopes.transpose();
  covariance.diagonal().array() += width * width;
  const Eigen::MatrixXd found = prior.precision.topLeftCorner(50, 50).inverse();
  EXPECT_LT((found - covariance).cwiseAbs().maxCoeff(), 1e-8 * covariance.maxCoeff());
  EXPECT_LT((prior.mean.head(50) - expected).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_NEAR(prior.mean[unknowns.contact()], 0.029 - 0.0285, 1e-12);
  EXPECT_NEAR(prior.precision(unknowns.contact(), unknowns.contact()), 1e6, 1e-3);
}

// Fit to half a second at 2 % with and without what is stated.
class Posterior : public testing::Test {
 protected:
  BowedCase bowed = bowed_case(0.0285, kInharmonicity, 0.5);
  ProjectedLikelihood whole{WhitenedRecord::of(noisy(bowed, 0.02, 5), 0.0, kBand)};

  NewtonFit fit(const StringUnknowns& unknowns, const QuadraticPrior& prior) const {
    return newton_fit(whole, unknowns, unknowns.start(),
                      {.tolerance = 1e-8, .prior = prior.precision, .prior_mean = prior.mean});
  }
};

TEST_F(Posterior, IsThatOfTwoGaussians) {
  const StringUnknowns plain = StringUnknowns::law(bowed.truth, 196.0, kInharmonicity);
  const NewtonFit data = newton_fit(whole, plain, plain.start(), {.tolerance = 1e-8});
  const Eigen::MatrixXd hessian = 2.0 * data.point.information;
  const Eigen::VectorXd sd = hessian.inverse().diagonal().cwiseSqrt();
  // As certain as the data, two standard deviations off.
  UnknownsOptions options;
  options.priors = {{"f0", 196.0 * std::exp(data.theta[0] + 2.0 * sd[0]), 196.0 * sd[0]},
                    {"B", data.theta[1] - 2.0 * sd[1], sd[1]},
                    {"x_c", 0.0285 + data.theta[2], sd[2]},
                    {"damping", std::exp(data.theta[3]), sd[3]}};
  options.correlations = {{{"f0", "B"}, 0.3}, {{"x_c", "B"}, -0.4}};
  const StringUnknowns stated = StringUnknowns::law(bowed.truth, 196.0, kInharmonicity, options,
                                                    StatedPriors(options, bowed.truth));
  const QuadraticPrior prior = stated.prior(stated.start());
  const NewtonFit found = fit(stated, prior);
  const Eigen::MatrixXd both = hessian + prior.precision;
  const Eigen::VectorXd posterior =
      both.ldlt().solve(hessian * data.theta + prior.precision * prior.mean);
  // The likelihood is quadratic to some percent over two standard deviations.
  for (Eigen::Index i = 0; i < 4; ++i) {
    EXPECT_NEAR((found.theta[i] - posterior[i]) / sd[i], 0.0, 0.05) << i;
    const double information = 2.0 * found.point.information(i, i) + prior.precision(i, i);
    EXPECT_NEAR(information / both(i, i), 1.0, 0.05) << i;
  }
  EXPECT_GT(std::abs(found.theta[0] - data.theta[0]), 0.3 * sd[0]);
}

TEST_F(Posterior, OfWhatTheDataDoNotTellIsThePrior) {
  // Mode 3 under a prior much tighter than half a second of data.
  UnknownsOptions options;
  options.damping = "each";
  options.priors = {{"f_3", 589.0, 589.0e-7}, {"zeta_3", 1.2e-3, 1.2e-9}};
  const StringUnknowns stated =
      StringUnknowns::frequencies(bowed.truth, options, StatedPriors(options, bowed.truth));
  const QuadraticPrior prior =
      stated.prior(stated.start(), {Eigen::VectorXd::Constant(50, 2e-3), kInharmonicity});
  const NewtonFit found = fit(stated, prior);
  const ModelPoint model = stated.model(found.theta);
  EXPECT_NEAR(model.basis.frequency(2), 589.0, 1e-3);
  EXPECT_NEAR(model.basis.zeta[2], 1.2e-3, 1e-7);
}

// Scatter 0.3 of a width 1: two modes differ by √2·0.3 beside what the smooth curve changes between
// them, the mean of many is known to almost the width.
TEST(DampingPrior, HoldsACurveAndAScatter) {
  UnknownsOptions options;
  options.damping = "each";
  options.damping_width = 1.0;
  options.damping_scatter = 0.3;
  const ModelPoint point = stiff_string();
  const StringUnknowns unknowns =
      StringUnknowns::frequencies(point, options, StatedPriors(options, point));
  const Eigen::MatrixXd precision =
      unknowns.prior(unknowns.start(), {Eigen::VectorXd::Constant(50, 2e-3), kInharmonicity})
          .precision;
  const auto place = [&](std::size_t mode) {
    return static_cast<Eigen::Index>(
        *unknowns.parameters().find(ParameterKind::kDampingRatio, mode - 1));
  };
  const Eigen::Index first = place(1), count = static_cast<Eigen::Index>(point.basis.size());
  const Eigen::MatrixXd covariance = precision.block(first, first, count, count).inverse();
  const auto between = [&](std::size_t a, std::size_t b) {
    return covariance(place(a) - first, place(b) - first);
  };
  EXPECT_NEAR(between(20, 20), 1.0, 1e-9);
  EXPECT_NEAR(between(20, 21), 0.91 * std::exp(-0.5 * std::pow(std::log(21.0 / 20.0), 2)), 1e-9);
  EXPECT_NEAR(between(1, 20), 0.91 * std::exp(-0.5 * std::pow(std::log(20.0), 2)), 1e-9);
}

TEST(PriorMisfit, IsMeasuredByTheCovarianceStated) {
  const UnknownsOptions options =
      stating({{"gain", 1.0, 0.02}, {"delay", 0.0, 2e-6}}, {{{"gain", "delay"}, 0.5}});
  const ModelPoint point = stiff_string();
  const StringUnknowns unknowns =
      StringUnknowns::law(point, 196.0, kInharmonicity, options, StatedPriors(options, point));
  Eigen::VectorXd theta = unknowns.start();
  EXPECT_EQ(unknowns.prior_misfit(theta).chi2, 0.0);
  theta[static_cast<Eigen::Index>(
      *unknowns.parameters().find(ParameterKind::kSensor, Sensor::kGain))] = 0.02;
  theta[static_cast<Eigen::Index>(
      *unknowns.parameters().find(ParameterKind::kSensor, Sensor::kDelay))] = -4e-6;
  const PriorMisfit misfit = unknowns.prior_misfit(theta);
  // (1, −2) under correlation 0.5: (1 + 2 + 4)/(1 − 0.25).
  EXPECT_NEAR(misfit.chi2, 28.0 / 3.0, 1e-10);
  EXPECT_EQ(misfit.count, 2u);
  EXPECT_EQ(misfit.farthest, "delay");
  EXPECT_NEAR(misfit.deviations, 2.0, 1e-12);
}

TEST(PriorMisfit, ContradictsBeyondThreeDeviationsOfOne) {
  EXPECT_FALSE((PriorMisfit{.chi2 = 8.99, .count = 1}.contradicted()));
  EXPECT_TRUE((PriorMisfit{.chi2 = 9.01, .count = 1}.contradicted()));
  EXPECT_FALSE((PriorMisfit{.chi2 = 9.01, .count = 2}.contradicted()));
  EXPECT_TRUE((PriorMisfit{.chi2 = NAN, .count = 1}.contradicted()));
  EXPECT_FALSE(PriorMisfit{}.contradicted());
}

TEST(PriorMisfit, OfFreeFrequenciesAsksTheLawTheyScatterAbout) {
  // Frequencies of the law with f0 and B exactly: the law through them is that one.
  const UnknownsOptions options = stating({{"f0", 196.2, 0.1}, {"B", kInharmonicity, 1e-6}});
  const ModelPoint point = stiff_string();
  const StringUnknowns unknowns =
      StringUnknowns::frequencies(point, options, StatedPriors(options, point));
  const LawScatter scatter{Eigen::VectorXd::Constant(50, 1e-6), kInharmonicity};
  const PriorMisfit misfit = unknowns.prior_misfit(unknowns.start(), scatter);
  // Fifty modes at 1e-6 tell f0 a thousand times better than its prior does.
  EXPECT_EQ(misfit.farthest, "f0");
  EXPECT_NEAR(misfit.deviations, 2.0 * (1.0 + 0.5 * 0.2 / 196.2), 1e-3);
  EXPECT_NEAR(misfit.chi2, 4.0, 1e-2);
}

TEST(PriorMisfit, IsFoundWhereTheDataDoNotContradictTheFit) {
  const BowedCase bowed = bowed_case(0.0285, kInharmonicity, 0.5);
  const NoisyRecords records = noisy(bowed, 0.02, 5);
  const CalibrationData data =
      CalibrationData::of_records(records.reactions[0], records.reactions[1], records.sample_rate);
  ContinuationOptions options{
      .law_width = 2e-3, .left_noise = records.deviation[0], .right_noise = records.deviation[1]};
  for (const bool frequencies : {false, true}) {
    options.frequencies = frequencies;
    options.unknowns.priors = {{"x_c", 0.04, 1e-3}, {"f0", 196.5, 1.0}};
    const ContinuationResult wrong = calibrate_by_continuation(bowed.truth, data, options);
    EXPECT_TRUE(wrong.fits) << wrong.chi2;
    EXPECT_FALSE(wrong.right);
    EXPECT_EQ(wrong.restarts, 0u);
    EXPECT_EQ(wrong.priors.count, 2u);
    EXPECT_EQ(wrong.priors.farthest, "x_c");
    // (28.5 − 40) mm; the data know x_c to less than a thousandth of that.
    EXPECT_NEAR(wrong.priors.deviations, 11.5, 0.02);
    EXPECT_TRUE(wrong.law.priors.contradicted());
    options.unknowns.priors[0].mean = 0.0275;
    EXPECT_TRUE(calibrate_by_continuation(bowed.truth, data, options).right);
  }
}

// The parameters of a calibration by their names.
const CalibratedParameter* named(const CalibrationResult& result, const std::string& name) {
  for (const CalibratedParameter& parameter : result.parameters) {
    if (parameter.name == name) return &parameter;
  }
  return nullptr;
}

TEST(FreedUnknowns, ComeBackUnderTheNamesOfTheirPriorsWithDeviations) {
  const BowedCase bowed = bowed_case(0.0285, kInharmonicity, 0.5);
  const NoisyRecords records = noisy(bowed, 0.01, 5);
  const std::vector<CalibrationData> data(
      2,
      CalibrationData::of_records(records.reactions[0], records.reactions[1], records.sample_rate));
  ModelPoint start = bowed.truth;
  for (std::size_t n = 0; n < 50; ++n) {
    start.basis.zeta[n] *= 1.1 * std::pow(static_cast<double>(n + 1), 0.05);
  }
  CalibrationOptions options = as_calibration({.law_width = 2e-3,
                                               .left_noise = records.deviation[0],
                                               .right_noise = records.deviation[1],
                                               .restarts = 0});
  UnknownsOptions& unknowns = options.parameters.unknowns;
  unknowns.damping = "power";
  unknowns.sensor[Sensor::kGain].free = unknowns.sensor[Sensor::kDelay].free = true;
  for (const std::size_t strokes : {1u, 2u}) {
    const CalibrationResult found =
        calibrate(start, as_records({data.begin(), data.begin() + strokes}), options);
    // What the names say: zeta_n = damping n^damping_power zeta_n(initial).
    const double truths[] = {1.0 / 1.1, -0.05, 1.0, 0.0};
    const char* names[] = {"damping", "damping_power", "gain", "delay"};
    for (std::size_t i = 0; i < 4; ++i) {
      const CalibratedParameter* parameter = named(found, names[i]);
      ASSERT_NE(parameter, nullptr) << names[i];
      EXPECT_GT(parameter->deviation, 0.0) << names[i];
      EXPECT_LT(std::abs(parameter->final - truths[i]), 6.0 * parameter->deviation) << names[i];
      EXPECT_FALSE(parameter->at_bound) << names[i];
    }
    const double factor = named(found, "damping")->final;
    const double power = named(found, "damping_power")->final;
    for (const std::size_t n : {1u, 7u, 50u}) {
      const double ratio = found.model.basis.zeta[n - 1] / start.basis.zeta[n - 1];
      EXPECT_NEAR(ratio, factor * std::pow(static_cast<double>(n), power), 1e-9) << n;
    }
  }
}

TEST(FreedUnknowns, AmongThemEveryDampingRatio) {
  const BowedCase bowed = bowed_case(0.0285, kInharmonicity, 0.5);
  const NoisyRecords records = noisy(bowed, 0.01, 5);
  const CalibrationData data =
      CalibrationData::of_records(records.reactions[0], records.reactions[1], records.sample_rate);
  CalibrationOptions options = as_calibration({.law_width = 2e-3,
                                               .left_noise = records.deviation[0],
                                               .right_noise = records.deviation[1],
                                               .restarts = 0});
  options.parameters.unknowns.damping = "each";
  options.parameters.unknowns.fixed = {{"zeta_5", 1e-3}};
  for (const std::size_t strokes : {1u, 2u}) {
    const CalibrationResult found =
        calibrate(bowed.truth, as_records(std::vector(strokes, data)), options);
    EXPECT_EQ(named(found, "damping"), nullptr);
    EXPECT_EQ(found.continuation->damping_power, 0.0);  // there is none
    EXPECT_EQ(named(found, "zeta_5"), nullptr);
    std::size_t count = 0;
    for (std::size_t n = 0; n < 50; ++n) {
      const CalibratedParameter* ratio = named(found, fmt::format("zeta_{}", n + 1));
      if (ratio == nullptr) continue;
      ++count;
      EXPECT_EQ(ratio->final, found.model.basis.zeta[n]);
      EXPECT_GT(ratio->deviation, 0.0);
      // No worse than the prior of 30 % in the logarithm, what noise adds to JᵀJ aside.
      EXPECT_LT(ratio->deviation, 0.5 * ratio->final) << n + 1;
      EXPECT_LT(std::abs(ratio->final - bowed.truth.basis.zeta[n]), 6.0 * ratio->deviation)
          << n + 1;
    }
    EXPECT_EQ(count, 49u);
    const std::vector<double> shape = found.model.basis.shape_at(found.model.contact);
    for (const CalibratedMode& mode : found.modes) EXPECT_EQ(mode.shape, shape[mode.number - 1]);
  }
}

TEST(StatedPriors, WithoutThoseOfSingleFrequenciesKeepTheRest) {
  const UnknownsOptions options =
      stating({{"f_3", 588.0, 0.1}, {"gain", 1.0, 0.02}, {"delay", 0.0, 2e-6}},
              {{{"gain", "delay"}, 0.5}, {{"f_3", "gain"}, 0.4}});
  const ModelPoint point = stiff_string();
  const StatedPriors rest = StatedPriors(options, point).without_frequencies();
  const StringUnknowns unknowns = StringUnknowns::law(point, 196.0, 0.0, options, rest);
  const Eigen::Index at =
      static_cast<Eigen::Index>(*unknowns.parameters().find(ParameterKind::kSensor, Sensor::kGain));
  const Eigen::Matrix2d covariance =
      unknowns.prior(unknowns.start()).precision.block<2, 2>(at, at).inverse();
  EXPECT_NEAR(covariance(0, 0), 0.02 * 0.02, 1e-12);
  EXPECT_NEAR(covariance(0, 1), 0.5 * 0.02 * 2e-6, 1e-15);
  EXPECT_FALSE(rest.has({.kind = ParameterKind::kFrequency, .index = 2}));
}

TEST(StatedPriors, ThatAreNoneAreRefusedWithTheReason) {
  const auto refused = [](const UnknownsOptions& options, const std::string& reason) {
    try {
      require_priors(options, 50, 2, 0.33);
      ADD_FAILURE() << "accepted, not refused for " << reason;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
    }
  };
  refused(stating({{"f_51", 1e4, 1.0}}), "unknown parameter \"f_51\"");
  refused(stating({{"F0", 196.0, 1.0}}), "unknown parameter \"F0\"");
  refused(stating({{"f0", 196.0, 1.0}, {"f0", 197.0, 1.0}}), "\"f0\" has two priors");
  refused(stating({{"x_c", 0.03, 1e-3}, {"x_c 1", 0.03, 1e-3}}), "\"x_c 1\" has two priors");
  refused(stating({{"x_c 3", 0.03, 1e-3}}), "there are 2 records");
  refused(stating({{"f0 2", 196.0, 1.0}}), "all records share it");
  refused(stating({{"f0", 196.0, 0.0}}), "deviation 0");
  refused(stating({{"f0", -196.0, 1.0}}), "mean -196");
  const double infinite = std::numeric_limits<double>::infinity();
  refused(stating({{"f0", infinite, 1.0}}), "must be finite");
  refused(stating({{"delay", -infinite, 1e-6}}), "must be finite");
  refused(stating({{"x_c", 0.4, 1e-3}}), "within (0, 0.33) m");
  refused(stating({{"x_c", -0.03, 1e-3}}), "within (0, 0.33) m");
  refused(stating({{"B", -4e-4, 1e-4}}), "must be above -0.0003");
  UnknownsOptions fixed;
  fixed.fixed = {{"B", -1e-3}};
  refused(fixed, "no string has such a law");
  fixed.fixed = {{"x_c", 0.33}};
  refused(fixed, "within (0, 0.33) m");
  refused(stating({{"corner", 4.0, 1.0}}), "among the sensors");
  refused(stating({{"zeta_3", 1e-3, 1e-4}, {"damping_power", 0.0, 0.1}}), "damping: power");
  refused(stating({}, {{{"f0", "B"}, 0.3}}), "f0 and B have a correlation and no priors");
  const std::vector<ParameterPrior> three = {
      {"f0", 196.0, 1.0}, {"B", 1e-4, 1e-5}, {"x_c", 0.03, 1e-3}};
  refused(stating(three, {{{"f0", "gain"}, 0.3}}), "\"gain\", which has no prior");
  refused(stating(three, {{{"f0", "f0"}, 0.3}}), "two different parameters");
  refused(stating(three, {{{"f0", "B"}, 1.0}}), "(-1, 1)");
  refused(stating(three, {{{"f0", "B"}, 0.3}, {{"B", "f0"}, 0.3}}), "stated twice");
  refused(stating(three, {{{"f0", "B"}, 0.9}, {{"B", "x_c"}, 0.9}, {{"f0", "x_c"}, -0.9}}),
          "belong to no Gaussian");
}

}  // namespace
}  // namespace modcal::stated_priors_test
