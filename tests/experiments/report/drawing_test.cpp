#include "experiments/report/drawing.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "libsim/base/error.hpp"
#include "tests/experiments/report/sample_report.hpp"

namespace modcal::report::drawing_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Figure figure_of(Series series, bool log_x = false, bool log_y = false) {
  return {.id = "f",
          .title = "t",
          .caption = "",
          .panels = {{.title = "p",
                      .x = {.label = "x", .unit = "s", .logarithmic = log_x},
                      .y = {.label = "y", .unit = "m", .logarithmic = log_y},
                      .series = {std::move(series)}}},
          .command = ""};
}

TEST(DrawFigure, ShortSeriesAreDrawnAsTheyAre) {
  const Figure figure = figure_of({.label = "a", .x = {1, 2, 3}, .y = {4, 5, 6}});
  const DrawnFigure drawn = draw_figure(figure, 100);
  EXPECT_EQ(drawn.panels[0].series[0].x, figure.panels[0].series[0].x);
  EXPECT_EQ(drawn.panels[0].series[0].y, figure.panels[0].series[0].y);
  EXPECT_THAT(drawn.panels[0].x_window, ElementsAre(1, 3));
  EXPECT_THAT(drawn.notes, ElementsAre());
}

TEST(DrawFigure, ValuesThatAreNotFiniteAreCountedGaps) {
  const Figure figure = figure_of({.label = "a", .x = {1, 2, 3, 4}, .y = {4, kNaN, kInfinity, 7}});
  const DrawnFigure drawn = draw_figure(figure, 100);
  const auto& y = drawn.panels[0].series[0].y;
  EXPECT_EQ(y.size(), 4u);
  EXPECT_TRUE(std::isnan(y[1]) && std::isnan(y[2]));
  EXPECT_THAT(drawn.notes, ElementsAre(HasSubstr("2 values are not finite")));
}

TEST(DrawFigure, LogarithmicAxesLeaveOutAndCountWhatTheyCannotShow) {
  const Figure figure =
      figure_of({.label = "a", .x = {0, 1, 10, 100}, .y = {4, -1, 0, 7}}, true, true);
  const DrawnFigure drawn = draw_figure(figure, 100);
  const auto& series = drawn.panels[0].series[0];
  EXPECT_THAT(series.x, ElementsAre(1, 10, 100));
  EXPECT_TRUE(std::isnan(series.y[0]) && std::isnan(series.y[1]));
  EXPECT_EQ(series.y[2], 7);
  EXPECT_THAT(drawn.notes, ElementsAre(HasSubstr("3 values ≤ 0 left out")));
}

TEST(DrawFigure, EndsOfBarsThatALogarithmicAxisCannotShowStopAtTheLowestValue) {
  Series series{.label = "a", .x = {1, 2}, .y = {4, 5}, .y_low = {-1, 3}, .y_high = {6, 7}};
  const Figure figure = figure_of(series, false, true);
  const DrawnFigure drawn = draw_figure(figure, 100);
  EXPECT_THAT(drawn.panels[0].series[0].low, ElementsAre(3, 3));
  EXPECT_THAT(drawn.panels[0].series[0].high, ElementsAre(6, 7));
  EXPECT_THAT(drawn.notes, ElementsAre(HasSubstr("1 end of error bars")));
}

TEST(DrawFigure, SamplesOutsideTheRangeAreClippedButForTheNeighbours) {
  Figure figure = figure_of({.label = "a", .x = {0, 1, 2, 3, 4, 5}, .y = {0, 1, 2, 3, 4, 5}});
  figure.panels[0].x.range = {{1.5, 3.5}};
  const DrawnFigure drawn = draw_figure(figure, 100);
  EXPECT_THAT(drawn.panels[0].series[0].x, ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(drawn.panels[0].x_window, ElementsAre(1.5, 3.5));
}

TEST(DrawFigure, MarkersAreInsideTheWindows) {
  Figure figure = figure_of({.label = "a", .x = {1, 2}, .y = {1, 2}});
  figure.panels[0].markers = {{.value = 5.0},
                              {.direction = Marker::Direction::kHorizontal, .value = -3.0}};
  const DrawnPanel panel = draw_figure(figure, 100).panels[0];
  EXPECT_THAT(panel.x_window, ElementsAre(1, 5));
  EXPECT_LT(panel.y_window[0], -3.0);
  EXPECT_TRUE(panel.y_fixed);
}

TEST(DrawFigure, AnEmptySeriesHasNoValuesAndAWindow) {
  const Figure figure = figure_of({.label = "a", .x = {}, .y = {}}, false, true);
  const DrawnFigure drawn = draw_figure(figure, 100);
  EXPECT_FALSE(drawn.panels[0].has_values());
  EXPECT_LT(drawn.panels[0].x_window[0], drawn.panels[0].x_window[1]);
  EXPECT_GT(drawn.panels[0].y_window[0], 0.0);
}

TEST(DrawFigure, OneValueHasAWindowAroundIt) {
  for (const bool logarithmic : {false, true}) {
    const Figure figure = figure_of({.label = "a", .x = {3}, .y = {7}}, logarithmic, logarithmic);
    const DrawnPanel panel = draw_figure(figure, 100).panels[0];
    EXPECT_LT(panel.x_window[0], 3.0);
    EXPECT_GT(panel.x_window[1], 3.0);
    EXPECT_LT(panel.y_window[0], 7.0);
    EXPECT_GT(panel.y_window[1], 7.0);
  }
}

// gnuplot refuses a range that is empty in the digits written.
TEST(DrawFigure, ValuesEqualToRoundingHaveAWindowAroundThem) {
  for (const bool logarithmic : {false, true}) {
    const Figure figure =
        figure_of({.label = "a", .x = {1, 2, 3}, .y = {0.4812, 0.4812 * (1.0 + 1e-14), 0.4812}},
                  false, logarithmic);
    const DrawnPanel panel = draw_figure(figure, 100).panels[0];
    EXPECT_LT(panel.y_window[0], 0.45);
    EXPECT_GT(panel.y_window[1], 0.51);
  }
}

TEST(DrawFigure, LongSeriesAreThinnedAndSaidToBe) {
  const Figure figure = long_figure();
  const DrawnFigure drawn = draw_figure(figure, 300);
  EXPECT_LT(drawn.panels[0].series[0].x.size(), 1000u);
  EXPECT_THAT(drawn.notes, testing::Contains(HasSubstr("of 51200 samples")));
  const Figure short_windows = waveform_figure();
  EXPECT_EQ(draw_figure(short_windows, 300).panels[0].series[0].x.size(), 1024u);
}

TEST(CheckFigure, SaysWhatIsWrong) {
  const Series good{.label = "a", .x = {1, 2}, .y = {1, 2}};
  const auto message = [](const Figure& figure) -> std::string {
    try {
      check_figure(figure);
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message(figure_of(good)), "");
  EXPECT_THAT(message(figure_of({.label = "a", .x = {1}, .y = {1, 2}})),
              HasSubstr("1 values of x and 2 of y"));
  EXPECT_THAT(message(figure_of({.label = "a", .x = {1}, .y = {1}, .y_low = {1}})),
              HasSubstr("1 lower and 0 upper"));
  Figure figure = figure_of(good);
  figure.id = "../escape";
  EXPECT_THAT(message(figure), HasSubstr("cannot name the files"));
  figure = figure_of(good);
  figure.columns = 0;
  EXPECT_THAT(message(figure), HasSubstr("0 columns"));
  figure = figure_of(good);
  figure.panels.clear();
  EXPECT_THAT(message(figure), HasSubstr("no panel"));
  figure = figure_of(good, true);
  figure.panels[0].x.range = {{0.0, 1.0}};
  EXPECT_THAT(message(figure), HasSubstr("cannot start at 0"));
  figure.panels[0].x.range = {{2.0, kNaN}};
  EXPECT_THAT(message(figure), HasSubstr("cannot show"));
  figure = figure_of(good);
  figure.panels[0].markers = {{.value = kNaN, .label = "true"}};
  EXPECT_THAT(message(figure), HasSubstr("marker \"true\""));
}

std::vector<std::string> legend_of(const std::vector<std::vector<Series>>& panels) {
  Figure figure{.id = "figure"};
  for (const auto& series : panels) figure.panels.push_back({.series = series});
  std::vector<std::string> labels;
  for (const LegendEntry& entry : draw_figure(figure, 100).legend) labels.push_back(entry.label);
  return labels;
}

TEST(CommonLegend, ServesPanelsThatShowTheSameThings) {
  EXPECT_FALSE(draw_figure(waveform_figure(), 100).legend.empty());
  EXPECT_FALSE(draw_figure(objective_figure(), 100).legend.empty());
  EXPECT_TRUE(draw_figure(noise_figure(), 100).legend.empty());
  EXPECT_TRUE(draw_figure(long_figure(), 100).legend.empty());
}

TEST(CommonLegend, ServesPanelsThatShowPartsOfItInOneLookEach) {
  const Series found{.label = "identified"};
  const Series truth{.label = "true", .color = ColorRole::kReference};
  const Series other_truth{.label = "true", .color = ColorRole::kSecond};
  const Series misfit{.label = "misfit"};
  EXPECT_THAT(legend_of({{found}, {found, truth}}), ElementsAre("identified", "true"));
  EXPECT_THAT(legend_of({{found, truth}, {truth}}), ElementsAre("identified", "true"));
  EXPECT_THAT(legend_of({{found}, {truth}}), IsEmpty()) << "nothing is repeated";
  EXPECT_THAT(legend_of({{found, truth}, {other_truth}}), IsEmpty()) << "one label in two looks";
  EXPECT_THAT(legend_of({{found, truth}, {misfit, truth}}), IsEmpty()) << "two labels in one look";
}

}  // namespace
}  // namespace modcal::report::drawing_test
