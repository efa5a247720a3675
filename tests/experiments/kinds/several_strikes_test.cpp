// Kind "fit_modes" on several strikes of the plate of configs/structures.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libsim/base/error.hpp"
#include "tests/experiments/kinds/structure_config.hpp"

namespace modcal::several_strikes_test {
namespace {

using structure_config::file_of, structure_config::run;
using testing::HasSubstr;

TEST(SeveralStrikes, SayHowFarAFurtherOneIsOff) {
  const StudyResult result =
      run("fit_plate.yaml", {"other_strikes=[{file: plate_other_strike.csv}]"});
  EXPECT_EQ(result.status, report::Status::kOk);
  EXPECT_THAT(result.summary, HasSubstr("from strike to strike frequencies differ by"));
  const auto both = file_of(result, "modes_fit.json"),
             one = file_of(run("fit_plate.yaml"), "modes_fit.json");
  ASSERT_EQ(both["strikes"].size(), 2u);
  EXPECT_EQ(both["strikes"][1]["strike"], "plate_other_strike.csv");
  // Stiffness was changed by 1e-3, of normal numbers: the strikes' own frequencies lie on both
  // sides of those of both.
  EXPECT_LT(both["strikes"][0]["shift"].get<double>() * both["strikes"][1]["shift"].get<double>(),
            0.0);
  // Two strikes tell how far a third is off, and that is more than what one leaves of itself.
  EXPECT_GT(both["modes"][5]["f_sd_hz"].get<double>(),
            10.0 * one["modes"][5]["f_sd_hz"].get<double>());
  EXPECT_FALSE(one.contains("strikes"));
}

TEST(SeveralStrikes, NameTheOneThatIsNoneOfThese) {
  // The other strike's first part before its end alone: the structure rings when it begins.
  const StudyResult result =
      run("fit_plate.yaml", {"other_strikes=[{file: plate_other_strike.csv, start: 0.1 s}]"});
  EXPECT_EQ(result.status, report::Status::kFailed);
  EXPECT_THAT(result.answer, HasSubstr("of plate_other_strike.csv from 0.1 s"));
  EXPECT_THROW(run("fit_plate.yaml", {"other_strikes=[{start: 0.1 s}]"}), InvalidInput);  // overlap
}

}  // namespace
}  // namespace modcal::several_strikes_test
