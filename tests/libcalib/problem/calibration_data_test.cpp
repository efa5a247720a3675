#include "libcalib/problem/calibration_data.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "libsim/base/error.hpp"

namespace modcal::calibration_data_test {
namespace {

TEST(CalibrationData, NamesAReactionThatNeverMoves) {
  const std::vector<double> moving = {1.0, 0.5, -1.0, 0.0, 2.0, 0.0};
  const std::vector<double> zeros(6, 0.0), level(6, 0.3);
  EXPECT_NO_THROW(CalibrationData::of_records(moving, {}, 600.0).require_motion());
  const auto message = [](const CalibrationData& data) -> std::string {
    try {
      data.require_motion();
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "";
  };
  using testing::HasSubstr;
  EXPECT_THAT(message(CalibrationData::of_records(moving, zeros, 600.0)),
              AllOf(HasSubstr("the right reaction is silent"), HasSubstr("check its sensor")));
  EXPECT_THAT(message(CalibrationData::of_records(level, moving, 600.0)),
              AllOf(HasSubstr("the left reaction is silent"), HasSubstr("are 0.3 N")));
}

TEST(CalibrationData, TransformsTheRecordsThatAreThere) {
  const std::vector<double> record = {1.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  const auto data = CalibrationData::of_records({}, record, 600.0);
  EXPECT_FALSE(data.has(End::kLeft));
  EXPECT_FALSE(data.has_both());
  ASSERT_EQ(data.reaction(End::kRight).size(), 4u);
  EXPECT_NEAR(std::abs(data.reaction(End::kRight)[3] - 1.0), 0.0, 1e-15);
  EXPECT_DOUBLE_EQ(data.grid().spacing, 2.0 * std::numbers::pi * 100.0);
}

TEST(CalibrationData, RefusesWhatIsNoData) {
  const std::vector<double> six(6, 1.0), five(5, 1.0);
  std::vector<double> broken = six;
  broken[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(CalibrationData::of_records({}, {}, 600.0), InvalidInput);
  EXPECT_THROW(CalibrationData::of_records(six, five, 600.0), InvalidInput);
  EXPECT_THROW(CalibrationData::of_records(six, broken, 600.0), InvalidInput);
  EXPECT_THROW(CalibrationData::of_records(six, six, 0.0), InvalidInput);
  auto data = CalibrationData::of_records(six, six, 600.0);
  data.reactions[1].pop_back();
  EXPECT_THROW(data.require_valid(), InvalidInput);
}

TEST(BinsBetween, HoldsBothEndsAndNeverBinZero) {
  const FrequencyGrid grid{.spacing = 2.0, .bins = 10};
  EXPECT_EQ(bins_between(grid, 4.0, 8.0), (BinRange{2, 5}));
  EXPECT_EQ(bins_between(grid, 4.1, 7.9), (BinRange{3, 4}));
  EXPECT_EQ(bins_between(grid, -5.0, 2.0), (BinRange{1, 2}));
  EXPECT_EQ(bins_between(grid, 16.0, 1e9), (BinRange{8, 10}));
  EXPECT_EQ(bins_between(grid, 4.1, 4.2).size(), 0u);
  EXPECT_EQ(bins_between(grid, 1e9, 2e9).size(), 0u);
}

}  // namespace
}  // namespace modcal::calibration_data_test
