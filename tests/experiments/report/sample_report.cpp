#include "tests/experiments/report/sample_report.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>

namespace modcal::report {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kBeta = 1.0 / 11.0;

// Helmholtz motion at 196 Hz: share of the period t/T in [0, 1).
double phase_at(double t) {
  const double turns = 196.0 * t;
  return turns - std::floor(turns);
}

double displacement(double t) {
  const double p = phase_at(t);
  return p < 1.0 - kBeta ? -1.2e-4 + 4.7e-4 * p / (1.0 - kBeta)
                         : -1.2e-4 + 4.7e-4 * (1.0 - p) / kBeta;
}

double velocity(double t) { return phase_at(t) < 1.0 - kBeta ? 0.1 : -1.0; }

double force(double t) {
  const double p = phase_at(t);
  return (p < 1.0 - kBeta ? 0.3 : 0.205) + 0.02 * std::sin(2.0 * kPi * 11.0 * p);
}

std::vector<double> record_times() {
  std::vector<double> t(1024);
  for (std::size_t i = 0; i < t.size(); ++i) t[i] = 0.78 + static_cast<double>(i) / 51200.0;
  return t;
}

Panel waveform_panel(const Axis& y, double (*truth)(double), double ripple, const char* side) {
  const std::vector<double> t = record_times();
  Panel panel{.title = fmt::format("{} from {}", y.label, side),
              .x = {.label = "t", .unit = "s"},
              .y = y,
              .series = {}};
  Series computed{.label = "computed",
                  .x = t,
                  .y = {},
                  .style = SeriesStyle::kDashed,
                  .color = ColorRole::kReference};
  Series identified{.label = "identified", .x = t, .y = {}, .color = ColorRole::kFirst};
  for (const double time : t) {
    computed.y.push_back(truth(time));
    identified.y.push_back(truth(time) + ripple * std::sin(2.0 * kPi * 3100.0 * time));
  }
  panel.series = {identified, computed};
  return panel;
}

}  // namespace

Figure waveform_figure() {
  Figure figure{.id = "fig8",
                .title = "Figure 8. Motion and force at the bow, identified with regularization",
                .caption =
                    "Displacement, velocity and friction force at the contact point over four "
                    "periods, identified from the reaction at x = 0 (left) and x = L (right).",
                .columns = 2,
                .panels = {},
                .command = "modcal run configs/paper/fig8.yaml --out out/fig8"};
  for (const char* side : {"R1", "R2"}) {
    const double error = side[1] == '1' ? 1.0 : 2.0;
    figure.panels.push_back(
        waveform_panel({.label = "y", .unit = "m"}, displacement, error * 1e-5, side));
    figure.panels.push_back(
        waveform_panel({.label = "v", .unit = "m/s"}, velocity, error * 0.05, side));
    figure.panels.push_back(
        waveform_panel({.label = "f_c", .unit = "N"}, force, error * 0.01, side));
  }
  // Left column R1, right column R2.
  auto& panels = figure.panels;
  panels = {panels[0], panels[3], panels[1], panels[4], panels[2], panels[5]};
  return figure;
}

Figure objective_figure() {
  Figure figure{.id = "fig13",
                .title = "Figure 13. Objective functions of the first twelve modes",
                .caption = "Integral of the identified force spectra around each mode.",
                .columns = 3,
                .panels = {},
                .command = "modcal run configs/paper/fig13.yaml --out out/fig13"};
  for (int n = 1; n <= 12; ++n) {
    Panel panel{.title = fmt::format("mode {}", n),
                .x = {.label = "candidate", .unit = "Hz"},
                .y = {.label = "C", .unit = "N"},
                .series = {},
                .markers = {{.value = 196.0 * n, .label = "true"}}};
    for (const bool left : {true, false}) {
      Series series{.label = left ? "R1" : "R2",
                    .x = {},
                    .y = {},
                    .color = left ? ColorRole::kFirst : ColorRole::kSecond};
      for (int i = 0; i <= 50; ++i) {
        const double deviation = -0.03 + 0.06 * i / 50.0;
        series.x.push_back(196.0 * n * (1.0 + deviation));
        series.y.push_back((left ? 1.0 : 1.3) * std::sqrt(1e-6 + deviation * deviation) * 40.0 / n);
      }
      panel.series.push_back(series);
    }
    figure.panels.push_back(panel);
  }
  return figure;
}

Figure noise_figure() {
  const std::vector<double> noise = {0, 1, 2, 3, 4, 5, 8, 10};
  const std::array<std::vector<double>, 2> paper = {
      std::vector<double>{.81, .71, .65, .60, .62, .60, .60, .59},
      std::vector<double>{.95, .67, .63, .50, .48, .48, .48, .45}};
  Figure figure{.id = "noise",
                .title = "Correlation against noise",
                .caption = "Median and 10–90 % band over 75 draws; points: the paper's Table 1.",
                .columns = 2,
                .panels = {},
                .command = "modcal run configs/paper/table1.yaml --out out/table1"};
  for (std::size_t side = 0; side < 2; ++side) {
    Series ours{.label = "median of 75",
                .x = noise,
                .y = {},
                .style = SeriesStyle::kLineWithPoints,
                .color = side == 0 ? ColorRole::kFirst : ColorRole::kSecond};
    for (const double p : noise) {
      const double r = paper[side].back() + 0.25 * std::exp(-p / 1.5);
      ours.y.push_back(r);
      ours.y_low.push_back(r - 0.12);
      ours.y_high.push_back(r + 0.08);
    }
    Series printed{.label = "paper",
                   .x = noise,
                   .y = paper[side],
                   .style = SeriesStyle::kPoints,
                   .color = ColorRole::kFourth};
    figure.panels.push_back({.title = side == 0 ? "from R1" : "from R2",
                             .x = {.label = "noise", .unit = "%"},
                             .y = {.label = "correlation R", .unit = "1", .range = {{0.0, 1.0}}},
                             .series = {ours, printed}});
  }
  return figure;
}

Figure curve_figure() {
  Series l_curve{.label = "", .x = {}, .y = {}, .style = SeriesStyle::kLineWithPoints};
  Series product{.label = "", .x = {}, .y = {}, .color = ColorRole::kThird};
  for (int i = 0; i <= 60; ++i) {
    const double level = std::pow(10.0, -3.0 + 0.07 * i);
    const double residual = 0.02 * (1.0 + 40.0 * level);
    const double norm = 3e4 / (1.0 + 30.0 * level) + 200.0 * std::exp(-level);
    l_curve.x.push_back(residual);
    l_curve.y.push_back(norm);
    product.x.push_back(level);
    // The derivative's norm is 0 once everything is cut off: not a value for a logarithmic axis.
    product.y.push_back(i > 57 ? 0.0
                               : residual * norm * (1.0 + 0.3 * std::sin(4.0 * std::log(level))));
  }
  const Axis residual{.label = "‖R − HF‖", .unit = "N", .logarithmic = true};
  const Axis norm{.label = "‖dF/dt‖", .unit = "N/s", .logarithmic = true};
  return {.id = "fig9",
          .title = "Figure 9. L-curve and product curve",
          .caption =
              "Left: L-curve. Right: product of the two norms; the interior minimum is the "
              "chosen water level.",
          .columns = 2,
          .panels = {{.title = "L-curve", .x = residual, .y = norm, .series = {l_curve}},
                     {.title = "product",
                      .x = {.label = "ε", .unit = "N/N", .logarithmic = true},
                      .y = {.label = "‖R − HF‖ ‖dF/dt‖", .unit = "N²/s", .logarithmic = true},
                      .series = {product},
                      .markers = {{.value = 0.12, .label = "ε = 0.12"},
                                  {.direction = Marker::Direction::kHorizontal,
                                   .value = 80.0,
                                   .label = "noise floor",
                                   .color = ColorRole::kMuted}}}},
          .command = "modcal run configs/paper/fig9.yaml --out out/fig9"};
}

Figure long_figure() {
  Series record{.label = "R1", .x = {}, .y = {}};
  for (std::size_t i = 0; i < 51200; ++i) {
    const double t = static_cast<double>(i) / 51200.0;
    record.x.push_back(t);
    record.y.push_back(i >= 20000 && i < 24000 ? std::numeric_limits<double>::quiet_NaN()
                                               : (0.5 + 0.5 * t) * std::sin(2.0 * kPi * 196.0 * t));
  }
  Series loop{.label = "friction", .x = {}, .y = {}, .color = ColorRole::kThird};
  for (int i = 0; i <= 200; ++i) {
    const double turn = 2.0 * kPi * i / 200.0;
    loop.x.push_back(std::cos(turn));
    loop.y.push_back(0.3 + 0.1 * std::sin(turn) + 0.05 * std::cos(2.0 * turn));
  }
  Series damping{.label = "ζ",
                 .x = {1, 2, 3, 4, 5, 6},
                 .y = {1.1e-3, 9e-4, 1.3e-3, 1.2e-3, 8e-4, 1e-3},
                 .y_low = {9e-4, 7e-4, 1e-3, 9e-4, 6e-4, 9e-4},
                 .y_high = {1.3e-3, 1e-3, 1.6e-3, 1.5e-3, 9e-4, 1.2e-3},
                 .style = SeriesStyle::kPoints,
                 .color = ColorRole::kSecond};
  Series empty{.label = "nothing", .x = {}, .y = {}};
  return {
      .id = "long",
      .title = "Long record, closed curve, bars, no data",
      .caption = "A second of a reaction with a gap; force over velocity; damping with its spread.",
      .columns = 2,
      .panels = {{.title = "record",
                  .x = {.label = "t", .unit = "s"},
                  .y = {.label = "R1", .unit = "N"},
                  .series = {record}},
                 {.title = "loop",
                  .x = {.label = "v", .unit = "m/s"},
                  .y = {.label = "f_c", .unit = "N"},
                  .series = {loop}},
                 {.title = "damping",
                  .x = {.label = "mode", .unit = "1"},
                  .y = {.label = "ζ", .unit = "1"},
                  .series = {damping}},
                 {.title = "empty",
                  .x = {.label = "t", .unit = "s"},
                  .y = {.label = "y", .unit = "m"},
                  .series = {empty}}},
      .command = "modcal run configs/paper/fig3.yaml"};
}

Figure map_figure() {
  CategoryMap map{.x_edges = {}, .y_edges = {}, .categories = {}, .cells = {}};
  map.categories = {{"one slip", ColorRole::kFirst}, {"<several>", ColorRole::kFifth}};
  for (int i = 0; i <= 8; ++i) map.x_edges.push_back(0.02 * std::pow(2.0, 0.5 * i));
  for (int j = 0; j <= 6; ++j) map.y_edges.push_back(0.1 * std::pow(10.0, 0.5 * j));
  Series limit{.label = "limit", .x = {}, .y = {}, .color = ColorRole::kReference};
  for (int i = 0; i < 8; ++i) limit.x.push_back(0.02 * std::pow(2.0, 0.5 * i + 0.25));
  for (const double x : limit.x) limit.y.push_back(0.3 / x);
  for (int j = 0; j < 6; ++j) {
    for (int i = 0; i < 8; ++i) map.cells.push_back(i + j == 0 ? -1 : i + j < 7 ? 0 : 1);
  }
  return {.id = "map",
          .title = "Motion over two axes",
          .panels = {{.x = {.label = "position", .unit = "1", .logarithmic = true},
                      .y = {.label = "force", .unit = "N", .logarithmic = true},
                      .series = {limit},
                      .map = map}},
          .command = "modcal run configs/schelleng.yaml"};
}

Table noise_table() {
  Table table{
      .id = "table1",
      .title = "Table 1. Correlation and water level against noise",
      .caption = "Median over 75 draws and 10–90 % band; ✓: the paper's value is inside the band.",
      .columns = {{.key = "noise_percent", .name = "noise", .unit = "%", .format = "{:.0f}"},
                  {.key = "side", .name = "side"},
                  {.key = "R_median", .name = "R median", .unit = "1", .format = "{:.2f}"},
                  {.key = "paper_R", .name = "paper R", .unit = "1", .format = "{:.2f}"},
                  {.key = "comment", .name = "comment"}},
      .rows = {},
      .command = "modcal run configs/paper/table1.yaml --out out/table1"};
  table.rows = {{0.0, 1, 0.84, {0.81, Highlight::kPass}, "record truncation"},
                {1.0, 1, 0.72, {0.71, Highlight::kPass}, {}},
                {8.0, 2, 0.31, {0.48, Highlight::kFail}, "outside, \"far\""},
                {10.0, 2, std::numeric_limits<double>::quiet_NaN(), 0.45, "not identifiable"}};
  return table;
}

Report sample_report() {
  return {
      .title = "Identification of bow/string friction: the paper's figures",
      .description =
          "Every figure and table of the paper that can be computed, laid out as the "
          "paper has it.\n\nBowed violin string, 50 modes, 1 s, noise on both reactions.",
      .status = Status::kSomeFailed,
      .status_text = "39 of 40 tasks done, 1 not identifiable",
      .sections = {{.title = "Identification",
                    .blocks = {Text{.text = "The identified waveforms follow the computed ones."},
                               waveform_figure(), noise_figure(), noise_table()}},
                   {.title = "Regularization and calibration",
                    .blocks = {Text{.text = "An interior minimum exists.",
                                    .kind = Text::Kind::kNote},
                               curve_figure(), objective_figure(),
                               Text{.text = "1 task failed: seed 3.", .kind = Text::Kind::kFailure},
                               long_figure()}},
                   {.title = "Details", .blocks = {map_figure()}, .folded = true}},
      .provenance = {{"version", "0.1.0"}, {"commit", "0123456789abcdef"}, {"seeds", "1 … 5"}},
      .command = "modcal reproduce paper --out out/paper"};
}

}  // namespace modcal::report
