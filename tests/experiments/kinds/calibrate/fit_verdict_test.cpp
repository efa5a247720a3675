#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "experiments/kinds/calibrate/calibrate.hpp"

namespace modcal {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

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
  EXPECT_THAT(contradiction(result_of(true, far_off)),
              AllOf(HasSubstr("priors stated, that of x_c most (370 deviations)"),
                    Not(HasSubstr("fit is wrong"))));
  EXPECT_THAT(contradiction(result_of(false, {})),
              AllOf(HasSubstr("the fit is wrong: reduced chi2 1.4000"), Not(HasSubstr("priors"))));
  EXPECT_THAT(contradiction(result_of(false, far_off)),
              AllOf(HasSubstr("the fit is wrong"), HasSubstr("; the data contradict the priors")));
  EXPECT_EQ(contradiction(result_of(true, {})), "");
}

}  // namespace
}  // namespace modcal
