#include "libcalib/objectives/spectral_peak.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hwy/targets.h>
#include <tbb/global_control.h>

#include <numbers>

#include "libcalib/optimizers/systematic_search.hpp"
#include "libcalib/parameters/parameter_options.hpp"
#include "libsim/base/error.hpp"
#include "tests/libcalib/calibration_case.hpp"
#include "tests/libcalib/slope_check.hpp"

namespace modcal::spectral_peak_test {
namespace {

using Names = std::vector<std::string>;

constexpr double kRate = 12800.0;
constexpr std::size_t kSamples = 6400;

const SpectralPeak kPaper{SpectralPeak::Options{}};

std::vector<std::string> all_frequencies(std::size_t modes) {
  return ParameterOptions{.frequencies = "all"}.names(modes);
}

// Eq. 17 as it stands: Σ_r Σ_k |R_r/H_r| Δω/f_s over the bins within 4 % of f*.
double integral(const CalibrationData& data, const ModelPoint& model, double center) {
  const FrequencyGrid grid = data.grid();
  double sum = 0.0;
  for (const End end : {End::kLeft, End::kRight}) {
    if (!data.has(end)) continue;
    const auto transfer = reaction_transfer(model.basis, model.contact, end, grid);
    for (std::size_t k = 0; k < grid.bins; ++k) {
      const double f = grid.omega(k) / (2.0 * std::numbers::pi);
      if (std::abs(f - center) > 0.04 * center) continue;
      sum += std::abs(data.reaction(end)[k] / transfer[k]) * grid.spacing / data.sample_rate;
    }
  }
  return sum;
}

CalibrationData one_sided(CalibrationData data, End missing) {
  data.reactions[static_cast<std::size_t>(missing)].clear();
  return data;
}

TEST(SpectralPeak, IsTheIntegralOfTheForceOverTheBandsOfTheFreeModes) {
  const CalibrationData data = exact_data(paper_truth(20), kSamples, kRate, 196.0);
  const ModelPoint initial = with_frequency_errors(paper_truth(20), 0.02, 1);
  const ParameterSet parameters(initial, Names{"f_2", "f_19"});
  const auto function = kPaper.bind(data, parameters);
  const std::vector<double> x = {395.0, 3700.0};
  const ModelPoint model = parameters.model(x);
  const double expected = integral(data, model, initial.basis.frequency(1)) +
                          integral(data, model, initial.basis.frequency(18));
  // Sums of 20 terms that cancel near zeros of H by at most some hundreds.
  EXPECT_NEAR(function->value(x), expected, 1e-11 * expected);
}

// The scan's tolerance: the numerator rest·D + a cancels near zeros of H by at most some hundreds,
// as the sum of 20 terms does that it is compared with.
constexpr double kScanTolerance = 1e-11;

TEST(SpectralPeak, ScanIsThatOfOneModeInABandAboutItsCurrentFrequency) {
  const CalibrationData both = exact_data(paper_truth(20), kSamples, kRate, 196.0);
  const ModelPoint initial = with_frequency_errors(paper_truth(20), 0.02, 1);
  const ParameterSet parameters(initial, all_frequencies(20));
  for (const auto& data : {both, one_sided(both, End::kLeft), one_sided(both, End::kRight)}) {
    const auto function = kPaper.bind(data, parameters);
    std::vector<double> x = parameters.start();
    const auto scanner = function->scanner(x);
    for (const std::size_t i : {0, 4, 10, 19}) {
      const std::vector<double> candidates = {0.975 * x[i], x[i], 1.01 * x[i]};
      std::vector<double> values(3);
      scanner->scan(i, candidates, values);
      const double center = x[i];
      for (std::size_t j = 0; j < 3; ++j) {
        x[i] = candidates[j];
        const double expected = integral(data, parameters.model(x), center);
        EXPECT_NEAR(values[j], expected, kScanTolerance * expected) << i << " " << j;
      }
      scanner->move(i, candidates[2]);
    }
    scanner->refresh();
    std::vector<double> value(1);
    scanner->scan(10, std::span(x).subspan(10, 1), value);
    const double expected = integral(data, parameters.model(x), x[10]);
    EXPECT_NEAR(value[0], expected, kScanTolerance * expected);
  }
}

TEST(SpectralPeak, ScanOfAnotherParameterIsTheWholeObjective) {
  const CalibrationData data = exact_data(paper_truth(12), kSamples, kRate, 196.0);
  const ParameterSet parameters(paper_truth(12), Names{"x_c", "f_2"});
  const auto function = kPaper.bind(data, parameters);
  const auto scanner = function->scanner(parameters.start());
  std::vector<double> value(1);
  scanner->scan(0, std::vector<double>{0.0305}, value);
  EXPECT_EQ(value[0], function->value(std::vector<double>{0.0305, 392.0}));
  scanner->move(0, 0.0305);
  scanner->scan(1, std::vector<double>{390.0}, value);
  const double expected = integral(data, parameters.model(std::vector<double>{0.0305, 390.0}), 392);
  EXPECT_NEAR(value[0], expected, kScanTolerance * expected);
}

TEST(SpectralPeak, GradientIsThatOfTheValue) {
  const CalibrationData both = exact_data(paper_truth(12, 1e-4), kSamples, kRate, 196.0);
  const ModelPoint initial = with_frequency_errors(paper_truth(12, 1e-4), 0.01, 2);
  const ParameterSet parameters(initial, Names{"f_2", "f_7", "f0", "B", "x_c"});
  for (const auto& data : {both, one_sided(both, End::kLeft)}) {
    const auto function = kPaper.bind(data, parameters);
    // A resonance is 2ζ = 2e-3 of a frequency wide, 1/30 of a scale; steps of 1e-5 scales are 3e-4
    // of that, and differences right to about the square, 1e-7, times factors of the sharpest bins.
    expect_slopes_match(*function, parameters.variables(), parameters.start(), 1e-5, 1e-5);
  }
}

// 20 lies 5 % above 19: of bands of 4 % to either side, the bins between 0.96 f_20 and 1.04 f_19
// are in both and count twice, in the value and in its slopes.
TEST(SpectralPeak, BinsOfTwoBandsCountTwice) {
  const CalibrationData data = exact_data(paper_truth(20, 1e-4), kSamples, kRate, 196.0);
  const ModelPoint initial = with_frequency_errors(paper_truth(20, 1e-4), 0.005, 3);
  const ParameterSet parameters(initial, Names{"f_19", "f_20", "x_c"});
  const double left = initial.basis.frequency(18), right = initial.basis.frequency(19);
  ASSERT_LT(0.96 * right + 4.0 * kRate / kSamples, 1.04 * left);
  const auto function = kPaper.bind(data, parameters);
  std::vector<double> x = parameters.start();
  x[0] *= 1.002;
  const ModelPoint model = parameters.model(x);
  const double expected = integral(data, model, left) + integral(data, model, right);
  EXPECT_NEAR(function->value(x), expected, 1e-11 * expected);  // as in the first test
  // Steps and their errors are those of GradientIsThatOfTheValue.
  expect_slopes_match(*function, parameters.variables(), x, 1e-5, 1e-5);
}

// 10 lies 11 % above 9, 28 lies 6.7 % below 30, and the half band is 4 %.
TEST(SpectralPeak, ReachOfAFrequencyIsTwiceTheHalfBand) {
  const CalibrationData data = exact_data(paper_truth(30), 25600, 25600.0, 196.0);
  const ParameterSet parameters(paper_truth(30), Names{"f_9", "f_10", "f_28", "f_30", "x_c"});
  const auto function = kPaper.bind(data, parameters);
  const auto scanner = function->scanner(parameters.start());
  EXPECT_FALSE(scanner->reaches(1, 0));
  EXPECT_TRUE(scanner->reaches(2, 3));
  EXPECT_TRUE(scanner->reaches(4, 0));
  EXPECT_TRUE(scanner->reaches(0, 4));
  scanner->move(2, 0.918 * 30 * 196.0);  // 8.2 % below f_30
  EXPECT_FALSE(scanner->reaches(2, 3));
}

TEST(SpectralPeak, SearchWithoutSettledModesEndsOnTheBestCandidateOfEveryMode) {
  const ModelPoint truth = paper_truth(30);
  const CalibrationData data = exact_data(truth, 25600, 25600.0, 196.0);
  const ModelPoint initial = with_frequency_errors(truth, 0.02, 1);
  const ParameterSet parameters(initial, all_frequencies(30));
  const auto function = kPaper.bind(data, parameters);
  const auto search = [&](bool skip) {
    return ModeByMode({.skip_settled = skip}).minimize(*function, parameters.variables(), {});
  };
  const OptimizationResult whole = search(false), result = search(true);
  // Modes settle within five loops or so, the last one searches all.
  EXPECT_LT(result.evaluations, 0.75 * static_cast<double>(whole.evaluations));
  EXPECT_EQ(result.searched.back(), 30);
  ASSERT_EQ(result.scans.size(), 60u);
  for (std::size_t i = 0; i < 30; ++i) {
    const CoordinateScan& last = result.scans[30 + i];
    EXPECT_EQ(last.chosen, result.x[i]);
    // Half a step is 0.06 %: the two places between which a settled mode goes to and fro.
    EXPECT_NEAR(result.x[i], whole.x[i], 1.01 * 0.06 / 49.0 * whole.x[i]) << "mode " << i + 1;
  }
}

TEST(SpectralPeak, SearchHasTheSameBitsForAnyNumberOfThreads) {
  const CalibrationData data = exact_data(paper_truth(30), 25600, 25600.0, 196.0);
  const ModelPoint initial = with_frequency_errors(paper_truth(30), 0.02, 1);
  const ParameterSet parameters(initial, all_frequencies(30));
  const auto function = kPaper.bind(data, parameters);
  for (const ModeByMode::Options& options :
       {ModeByMode::Options{.loops = 2}, {.loops = 6, .skip_settled = true}}) {
    const auto search = [&](std::size_t threads) {
      const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
      return ModeByMode(options).minimize(*function, parameters.variables(), {});
    };
    const OptimizationResult serial = search(1);
    for (const std::size_t threads : {2, 3}) {
      const OptimizationResult parallel = search(threads);
      EXPECT_EQ(parallel.x, serial.x);
      EXPECT_EQ(parallel.value, serial.value);
      EXPECT_EQ(parallel.searched, serial.searched);
      for (std::size_t i = 0; i < serial.scans.size(); ++i) {
        EXPECT_EQ(parallel.scans[i].values, serial.scans[i].values);
      }
    }
  }
}

/// One instruction set for the kernels while it lives.
class OnlyTarget {
 public:
  explicit OnlyTarget(std::int64_t target) { set(target); }
  ~OnlyTarget() { set(0); }

 private:
  static void set(std::int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
};

TEST(SpectralPeak, EveryInstructionSetScansTheSameValues) {
  const CalibrationData data = exact_data(paper_truth(20), kSamples, kRate, 196.0);
  const ParameterSet parameters(with_frequency_errors(paper_truth(20), 0.02, 1),
                                all_frequencies(20));
  const auto function = kPaper.bind(data, parameters);
  const auto x = parameters.start();
  const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  for (const std::int64_t target : targets) {
    const OnlyTarget only(target);
    const auto scanner = function->scanner(x);
    for (const std::size_t i : {0, 13, 18}) {
      const std::vector<double> candidates = {0.98 * x[i], x[i], 1.013 * x[i]};
      std::vector<double> values(3);
      scanner->scan(i, candidates, values);
      for (std::size_t j = 0; j < 3; ++j) {
        auto moved = x;
        moved[i] = candidates[j];
        const double expected = integral(data, parameters.model(moved), x[i]);
        EXPECT_NEAR(values[j], expected, kScanTolerance * expected)
            << hwy::TargetName(target) << " " << i << " " << j;
      }
    }
  }
}

TEST(SpectralPeak, RefusesWhatItCannotIntegrate) {
  const CalibrationData data = exact_data(paper_truth(12), kSamples, kRate, 196.0);
  const Names names = {"f_1"};
  ModelPoint undamped = paper_truth(12);
  undamped.basis.zeta[3] = 0.0;
  EXPECT_THROW(kPaper.bind(data, ParameterSet(undamped, names)), InvalidInput);
  EXPECT_THROW(kPaper.bind(data, ParameterSet(paper_truth(33), names)), InvalidInput);
  const CalibrationData coarse = exact_data(paper_truth(12), 50, kRate, 196.0);
  EXPECT_THROW(kPaper.bind(coarse, ParameterSet(paper_truth(12), names)), InvalidInput);
  EXPECT_THROW(SpectralPeak({.half_band = 0.0}), InvalidInput);
}

}  // namespace
}  // namespace modcal::spectral_peak_test
