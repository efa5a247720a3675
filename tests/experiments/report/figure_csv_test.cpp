#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "experiments/report/figure.hpp"
#include "tests/experiments/report/sample_report.hpp"

namespace modcal::report::figure_csv_test {
namespace {

TEST(FigureCsv, SharesAbscissaeAndStatesUnits) {
  const Axis time{.label = "t", .unit = "s"};
  const Series shared{.label = "a, b", .x = {0, 0.5}, .y = {1, 2}};
  const Series banded{.label = "",
                      .x = {0, 0.5},
                      .y = {3, std::numeric_limits<double>::quiet_NaN()},
                      .y_low = {2, 2},
                      .y_high = {4, 4}};
  const Series longer{.label = "c", .x = {1, 2, 3}, .y = {7, 8, 9}};
  const Figure figure{
      .id = "f",
      .title = "",
      .caption = "",
      .panels =
          {{.title = "y", .x = time, .y = {.label = "y", .unit = "m"}, .series = {shared, longer}},
           {.title = "v", .x = time, .y = {.label = "v", .unit = "m/s"}, .series = {banded}}},
      .command = ""};
  EXPECT_EQ(figure_csv(figure),
            "t [s],y: a; b [m],v [m/s],v low [m/s],v high [m/s],t [s],y: c [m]\n"
            "0,1,3,2,4,1,7\n"
            "0.5,2,nan,2,4,2,8\n"
            ",,,,,3,9\n");
}

TEST(FigureCsv, NamesALoneCurveByItsAxis) {
  const Figure figure{.id = "f",
                      .title = "",
                      .caption = "",
                      .panels = {{.x = {.label = "t", .unit = "s"},
                                  .y = {.label = "objective"},
                                  .series = {{.x = {0, 0.5}, .y = {1, 2}}}}},
                      .command = ""};
  EXPECT_EQ(figure_csv(figure), "t [s],objective\n0,1\n0.5,2\n");
}

TEST(FigureCsv, HoldsAllSamplesOfALongSeries) {
  const std::string text = figure_csv(long_figure());
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 51'201);
}

}  // namespace
}  // namespace modcal::report::figure_csv_test
