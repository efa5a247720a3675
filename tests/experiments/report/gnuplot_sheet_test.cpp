#include "experiments/report/gnuplot_sheet.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/experiments/report/sample_report.hpp"

namespace modcal::report::gnuplot_sheet_test {
namespace {

// Two columns of panels with titles and as many curves, so many that no line holds all labels.
Figure crowded_figure(std::size_t curves) {
  Figure figure{.id = "crowded", .columns = 2};
  for (const char* title : {"from R1 (x = 0)", "from R2 (x = L)"}) {
    Panel panel{.title = title, .x = {.label = "x"}, .y = {.label = "y"}};
    for (std::size_t i = 0; i < curves; ++i) {
      Series series{.label = title + std::string(", method number ") + std::to_string(i)};
      series.add(0.0, 0.0);
      series.add(1.0, static_cast<double>(i));
      panel.series.push_back(std::move(series));
    }
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

TEST(PrintSheet, PutsTheLegendBetweenTitleAndAxes) {
  const Figure figure = crowded_figure(5);
  const DrawnFigure drawn = draw_figure(figure, 100);
  const PrintSheet sheet(drawn);
  for (const std::size_t panel : {0u, 1u}) {
    const Frame plot = sheet.plot_of(panel);
    const auto legend = sheet.legend_of(panel);
    ASSERT_EQ(legend.size(), 5u);
    double above = sheet.title_of(panel).back().y;
    EXPECT_LT(above, sheet.height());
    for (const PlacedEntry& entry : legend) {
      EXPECT_LE(entry.y, above - 0.1) << "one below the other";
      EXPECT_GT(entry.y, plot.top);
      EXPECT_GE(entry.x - PrintSheet::kSample, sheet.plot_of(panel).left - 1.0);
      EXPECT_LE(entry.x + printed_width(entry.entry.label),
                sheet.width() / 2.0 * static_cast<double>(panel + 1));
      above = entry.y;
    }
  }
}

TEST(PrintSheet, GrowsWithItsLegend) {
  const Figure few = crowded_figure(1), many = crowded_figure(6);
  const DrawnFigure drawn_few = draw_figure(few, 100), drawn_many = draw_figure(many, 100);
  const PrintSheet small(drawn_few), large(drawn_many);
  EXPECT_GT(large.height(), small.height() + 0.5);
  EXPECT_NEAR(large.plot_of(0).height(), small.plot_of(0).height(), 1e-12);
}

TEST(PrintSheet, BreaksLongTitles) {
  Figure figure = crowded_figure(1);
  figure.panels[0].title = "a title of so many words that it has no place above its narrow panel";
  const DrawnFigure drawn = draw_figure(figure, 100);
  const PrintSheet sheet(drawn);
  ASSERT_EQ(sheet.title_of(0).size(), 2u);
  EXPECT_GT(sheet.legend_of(0).front().y, sheet.plot_of(0).top);
  EXPECT_LT(sheet.legend_of(0).front().y, sheet.title_of(0).back().y);
}

TEST(PrintSheet, IsAsHighAsItsLabels) {
  Figure figure = crowded_figure(1);
  figure.panels[0].y.label = "a label so long that its panel has to be higher than others are";
  const DrawnFigure drawn = draw_figure(figure, 100);
  const PrintSheet sheet(drawn);
  EXPECT_GT(sheet.height(), printed_width(figure.panels[0].y.text()));
}

TEST(PrintSheet, PutsLabelsOfMarkersOutsideTheAxes) {
  using Direction = Marker::Direction;
  Figure figure = crowded_figure(1);
  figure.panels[0].markers = {
      {.direction = Direction::kHorizontal, .value = 0.0, .label = "law"},
      {.direction = Direction::kHorizontal, .value = 0.001, .label = "noise"},
      {.direction = Direction::kVertical, .value = 0.5, .label = "true"},
      {.direction = Direction::kVertical, .value = 0.51, .label = "found"},
      {.direction = Direction::kVertical, .value = 7.0, .label = "out of sight"}};
  figure.panels[0].x.range = {{0.0, 1.0}};
  const DrawnFigure drawn = draw_figure(figure, 100);
  const PrintSheet sheet(drawn);
  const Frame plot = sheet.plot_of(0);
  const auto labels = sheet.marker_labels_of(0);
  ASSERT_EQ(labels.size(), 5u);
  for (const std::size_t i : {0u, 1u}) EXPECT_GT(labels[i].x, plot.right);
  EXPECT_GT(std::abs(labels[0].y - labels[1].y), 0.1);
  for (const std::size_t i : {2u, 3u}) EXPECT_GT(labels[i].y, plot.top);
  EXPECT_GT(labels[3].y, labels[2].y + 0.1);
  EXPECT_GT(sheet.legend_of(0).back().y, labels[3].y + 0.1);
  EXPECT_EQ(labels[4].text, "");
}

TEST(TicStep, LeavesRoomBetweenLabels) {
  for (const double center : {1.0, 196.0, 1960.0, 196000.0}) {
    const std::array<double, 2> window = {center * 0.97, center * 1.03};
    const double step = tic_step(window, 2.0, 5.5, false);
    EXPECT_GE((window[1] - window[0]) / step, 1.0);
    EXPECT_LE((window[1] - window[0]) / step, 5.5);
    EXPECT_GT(2.0 * step / (window[1] - window[0]), printed_width(std::to_string(int(center))));
  }
  EXPECT_EQ(tic_step({0.0, 1.05}, 1.4, 7.0, true), 0.2);
}

TEST(GnuplotScript, DrawsTheReferenceBehindTheBand) {
  Figure figure = crowded_figure(1);
  Series& found = figure.panels[0].series.front();
  found.y_low = {-1.0, -1.0};
  found.y_high = {1.0, 1.0};
  Series truth{.label = "true", .style = SeriesStyle::kDashed, .color = ColorRole::kReference};
  truth.add(0.0, 0.0);
  truth.add(1.0, 1.0);
  figure.panels[0].series.push_back(truth);
  const std::string script = gnuplot_script(draw_figure(figure, 100));
  const std::size_t reference = script.find("index 1 using 1:2 with lines");
  ASSERT_NE(reference, std::string::npos);
  EXPECT_LT(reference, script.find("filledcurves"));
}

}  // namespace
}  // namespace modcal::report::gnuplot_sheet_test
