// Units of a figure as people read them.
#include <gmock/gmock.h>

#include "experiments/report/drawing.hpp"

namespace modcal::report::readable_test {
namespace {

using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

Figure figure_of(const Axis& x, const Axis& y, double largest_y) {
  Figure figure{.id = "a"};
  Series series;
  series.add(0.0, 0.0, -largest_y, 0.0);
  series.add(2e4, largest_y, 0.0, largest_y);
  figure.panels.push_back({.x = x, .y = y, .series = {series}});
  figure.panels.back().markers.push_back(
      {.direction = Marker::Direction::kHorizontal, .value = largest_y});
  return figure;
}

TEST(ReadableUnits, TakePrefixesForPowersOfTen) {
  const Figure figure =
      in_readable_units(figure_of({.label = "f", .unit = "Hz"}, {.label = "y", .unit = "m"}, 2e-4));
  const Panel& panel = figure.panels.front();
  EXPECT_EQ(panel.x.text(), "f [kHz]");
  EXPECT_EQ(panel.y.text(), "y [µm]");
  EXPECT_THAT(panel.series[0].x, ElementsAre(0.0, DoubleNear(20.0, 1e-9)));
  EXPECT_THAT(panel.series[0].y, ElementsAre(0.0, DoubleNear(200.0, 1e-9)));
  EXPECT_NEAR(panel.series[0].y_low[0], -200.0, 1e-9);
  EXPECT_NEAR(panel.markers[0].value, 200.0, 1e-9);
}

TEST(ReadableUnits, TakePrefixesOnLogarithmicAxes) {
  Figure figure{.id = "a"};
  Series series;
  series.add(1.0, 3e-8);
  series.add(2.0, 3e-6);
  figure.panels.push_back(
      {.y = {.label = "error", .unit = "m", .logarithmic = true}, .series = {series}});
  const Panel panel = in_readable_units(figure).panels.front();
  EXPECT_EQ(panel.y.text(), "error [µm]");
  EXPECT_THAT(panel.series[0].y, ElementsAre(DoubleNear(0.03, 1e-9), DoubleNear(3.0, 1e-9)));
}

TEST(ReadableUnits, HaveExponents) {
  const Axis y{.label = "a", .unit = "m/s2"};
  EXPECT_EQ(in_readable_units(figure_of({}, y, 0.5)).panels[0].y.text(), "a [m/s²]");
}

TEST(ReadableUnits, LeaveOthersAlone) {
  for (const Axis& y : {Axis{.label = "y", .unit = "kg"}, Axis{.label = "y", .unit = "1"},
                        Axis{.label = "y", .unit = "m²"}}) {
    EXPECT_EQ(in_readable_units(figure_of({}, y, 2e-4)).panels[0].y.text(), y.text());
  }
  // Short as it is.
  EXPECT_EQ(in_readable_units(figure_of({}, {.label = "F", .unit = "N"}, 0.5)).panels[0].y.unit,
            "N");
}

// The figure reaches from 0 to 20 kHz; its middle is stretched about a mode.
TEST(ReadableUnits, AreThoseOfSpectraOrOfSingleModes) {
  const auto unit_of = [](double low, double high) {
    Figure figure = figure_of({.label = "f", .unit = "Hz"}, {}, 1.0);
    figure.panels[0].x.range = {{low, high}};
    return in_readable_units(figure).panels[0].x.unit;
  };
  EXPECT_EQ(unit_of(100.0, 3000.0), "kHz");
  EXPECT_EQ(unit_of(2300.0, 2400.0), "Hz");
  EXPECT_EQ(unit_of(0.0, 800.0), "Hz");
}

TEST(ReadableUnits, AreThoseOfAllPanelsOfAQuantity) {
  const Axis y{.label = "y", .unit = "m"};
  Figure figure = figure_of({}, y, 0.02);
  figure.panels.push_back(figure_of({}, y, 2e-4).panels.front());
  EXPECT_EQ(in_readable_units(figure).panels[1].y.unit, "m");
}

TEST(Symbols, HaveSubscriptsInPrint) {
  const Figure figure =
      figure_of({.label = "water_level"}, {.label = "force f_c", .unit = "N"}, 1.0);
  const std::string script = gnuplot_script(draw_figure(figure, 100));
  EXPECT_THAT(script, HasSubstr(R"('force f_{c} [N]')"));
  EXPECT_THAT(script, HasSubstr(R"('water\_level')"));
}

}  // namespace
}  // namespace modcal::report::readable_test
