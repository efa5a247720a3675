#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "experiments/report/drawing.hpp"

namespace modcal::report::decimation_test {
namespace {

struct Ramp {
  std::vector<double> x, y;
  explicit Ramp(std::size_t n) : x(n), y(n) {
    for (std::size_t i = 0; i < n; ++i) {
      x[i] = 0.5 + 1e-3 * static_cast<double>(i);
      y[i] = std::sin(0.37 * static_cast<double>(i));
    }
  }
};

TEST(DrawnSamples, KeepsAllOfAShortSeries) {
  const Ramp ramp(400);
  EXPECT_EQ(drawn_samples(ramp.x, ramp.y, ramp.y, 100, false).size(), 400u);
}

TEST(DrawnSamples, KeepsTheExtremesOfEveryColumn) {
  Ramp ramp(100'000);
  ramp.y[77'777] = 50.0;
  ramp.y[33'333] = -50.0;
  const auto kept = drawn_samples(ramp.x, ramp.y, ramp.y, 100, false);
  EXPECT_LE(kept.size(), 2u * 100u + 2u);
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
  EXPECT_THAT(kept, testing::IsSupersetOf({0u, 33'333u, 77'777u, 99'999u}));
  // Columns of 1000 samples: each extreme is among those kept.
  for (std::size_t column = 0; column < 100; ++column) {
    const auto begin = ramp.y.begin() + static_cast<std::ptrdiff_t>(column * 1000 + 1);
    const double highest = *std::max_element(begin, begin + 998);
    EXPECT_TRUE(std::any_of(kept.begin(), kept.end(), [&](std::size_t i) {
      return i / 1000 == column && ramp.y[i] >= highest;
    })) << column;
  }
}

TEST(DrawnSamples, KeepsGaps) {
  Ramp ramp(10'000);
  ramp.y[5'432] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(drawn_samples(ramp.x, ramp.y, ramp.y, 50, false), testing::Contains(5'432u));
}

TEST(DrawnSamples, KeepsTheEndsOfASpread) {
  Ramp ramp(10'000);
  auto low = ramp.y;
  auto high = ramp.y;
  low[1'234] = -9.0;
  high[8'765] = 9.0;
  EXPECT_THAT(drawn_samples(ramp.x, low, high, 50, false), testing::IsSupersetOf({1'234u, 8'765u}));
}

TEST(DrawnSamples, LogarithmicColumnsLeaveTheFirstDecadesTheirDetail) {
  std::vector<double> x(10'000);
  std::vector<double> y(10'000);
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = static_cast<double>(i + 1);
    y[i] = std::cos(static_cast<double>(i));
  }
  // 4 decades on 400 columns: below x = 30 neighbours are more than a column apart.
  const auto kept = drawn_samples(x, y, y, 400, true);
  EXPECT_LT(kept.size(), 900u);
  for (std::size_t i = 0; i < 30; ++i) EXPECT_EQ(kept[i], i);
}

TEST(DrawnSamples, ThinsCurvesThatTurnBackAndConstantAbscissae) {
  std::vector<double> x(10'000);
  std::vector<double> y(10'000);
  for (std::size_t i = 0; i < x.size(); ++i) {
    x[i] = std::cos(1e-3 * static_cast<double>(i));
    y[i] = std::sin(1e-3 * static_cast<double>(i));
  }
  EXPECT_LE(drawn_samples(x, y, y, 100, false).size(), 202u);
  std::fill(x.begin(), x.end(), 1.0);
  EXPECT_LE(drawn_samples(x, y, y, 100, false).size(), 202u);
}

TEST(DrawnSamples, DescendingAbscissaeAreColumnsToo) {
  Ramp ramp(100'000);
  std::reverse(ramp.x.begin(), ramp.x.end());
  ramp.y[70'000] = 10.0;
  const auto kept = drawn_samples(ramp.x, ramp.y, ramp.y, 100, false);
  EXPECT_LE(kept.size(), 202u);
  EXPECT_THAT(kept, testing::Contains(70'000u));
}

}  // namespace
}  // namespace modcal::report::decimation_test
