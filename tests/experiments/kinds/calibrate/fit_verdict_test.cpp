#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "experiments/kinds/calibrate/calibrate.hpp"

namespace modcal::fit_verdict_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

CalibrationResult with(const ContinuationResult& found) {
  CalibrationResult result;
  result.continuation = std::make_shared<ContinuationResult>(found);
  return result;
}

ContinuationResult result_of(bool fits, const PriorMisfit& priors) {
  ContinuationResult found;
  found.chi2 = fits ? 1.001 : 1.4;
  found.chi2_deviation = 0.008;
  found.fits = fits;
  found.priors = priors;
  found.right = fits && !priors.contradicted();
  return found;
}

TEST(FitVerdict, TellsAWrongFitFromWrongPriors) {
  const PriorMisfit far_off{.chi2 = 136900.0, .count = 2, .farthest = "x_c", .deviations = 370.0};
  EXPECT_THAT(contradiction(with(result_of(true, far_off))),
              AllOf(HasSubstr("priors stated, that of x_c most (370 deviations)"),
                    Not(HasSubstr("fit is wrong"))));
  EXPECT_THAT(contradiction(with(result_of(false, {}))),
              AllOf(HasSubstr("the fit is wrong: reduced chi2 1.4000"), Not(HasSubstr("priors"))));
  EXPECT_THAT(contradiction(with(result_of(false, far_off))),
              AllOf(HasSubstr("the fit is wrong"), HasSubstr("; the data contradict the priors")));
  EXPECT_EQ(contradiction(with(result_of(true, {}))), "");
}

TEST(FitVerdict, TellsARecordThatRunsBackwards) {
  CalibrationResult result = with(result_of(false, {}));
  for (int n = 1; n <= 3; ++n) {
    result.parameters.push_back(
        {.name = fmt::format("zeta_{}", n), .initial = 1e-3, .final = 1e-5, .at_bound = n < 3});
  }
  EXPECT_THAT(contradiction(result), HasSubstr("the rows stand in reverse"));
  result.parameters[1].at_bound = false;
  EXPECT_THAT(contradiction(result), Not(HasSubstr("in reverse")));
  // Damping that ends at its largest is a string that rings for shorter than stated.
  for (CalibratedParameter& one : result.parameters)
    one = {.name = one.name, .initial = 1e-3, .final = 1e-1, .at_bound = true};
  EXPECT_THAT(contradiction(result), Not(HasSubstr("in reverse")));
}

TEST(FitVerdict, NamesAChannelThatIsLaterThanIsLookedFor) {
  CalibrationResult result = with(result_of(false, {}));
  result.parameters.push_back({.name = "delay", .final = 5e-5, .at_bound = true});
  EXPECT_THAT(contradiction(result),
              AllOf(HasSubstr("x = L is later by 50 us or more"), HasSubstr("record.right.delay")));
  result.parameters[0].final = -5e-5;
  EXPECT_THAT(contradiction(result), HasSubstr("record.left.delay: 50 us more"));
  result.parameters[0].at_bound = false;
  EXPECT_THAT(contradiction(result), Not(HasSubstr("is later")));
}

TEST(CalibrationWarnings, RefuseWhatHasNoDeviation) {
  CalibrationOutcome outcome;
  ContinuationResult found = result_of(true, {});
  found.covariance.names = {"f1", "f2", "f3", "f4", "x_c"};
  found.covariance.matrix = Eigen::MatrixXd::Identity(5, 5);
  outcome.result.continuation = std::make_shared<ContinuationResult>(found);
  StudyResult right;
  add_calibration_warnings(outcome, right);
  EXPECT_EQ(right.status, report::Status::kOk);
  for (Eigen::Index i = 0; i < 4; ++i) found.covariance.matrix(i, i) = -1.0;
  outcome.result.continuation = std::make_shared<ContinuationResult>(found);
  StudyResult refused;
  add_calibration_warnings(outcome, refused);
  EXPECT_EQ(refused.status, report::Status::kFailed);
  // What refuses it stands in the head of the report, in the place of the values.
  EXPECT_THAT(refused.answer, HasSubstr("tells of f1, f2, 2 more is not known"));
  EXPECT_EQ(right.answer, "");
  EXPECT_THAT(refused.summary, HasSubstr("tells of f1, f2, 2 more is not known"));
}

}  // namespace
}  // namespace modcal::fit_verdict_test
