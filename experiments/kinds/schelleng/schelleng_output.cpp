// Borders, tables, figures and files of a Schelleng diagram.

#include "experiments/kinds/schelleng/schelleng.hpp"
#include "experiments/study/sample.hpp"

namespace modcal {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

bool is_helmholtz(const std::optional<CellOutcome>& outcome) {
  return outcome && outcome->failure.empty() && outcome->regime == StringRegime::kHelmholtz;
}

// First and one past the last row of the longest run of Helmholtz cells of a column.
std::pair<std::size_t, std::size_t> longest_run(const SchellengOptions& options,
                                                const CellOutcomes& outcomes, std::size_t column) {
  const auto columns = static_cast<std::size_t>(options.positions.count);
  const auto rows = static_cast<std::size_t>(options.forces.count);
  std::pair<std::size_t, std::size_t> best{0, 0};
  std::size_t begin = 0;
  for (std::size_t row = 0; row <= rows; ++row) {
    if (row < rows && is_helmholtz(outcomes[row * columns + column])) continue;
    if (row - begin > best.second - best.first) best = {begin, row};
    begin = row + 1;
  }
  return best;
}

struct RegimeLook {
  const char* label;
  report::ColorRole color;
};

const RegimeLook& look_of(StringRegime regime) {
  static constexpr std::array<RegimeLook, kStringRegimes> kLooks = {
      {{"Helmholtz motion", report::ColorRole::kFirst},
       {"multiple slip", report::ColorRole::kFifth},
       {"raucous", report::ColorRole::kSecond},
       {"not sounding", report::ColorRole::kMuted}}};
  return kLooks.at(static_cast<std::size_t>(regime));
}

bool has_regime(const std::optional<CellOutcome>& outcome) {
  return outcome && outcome->failure.empty();
}

BowForceLimits limits_at(const SchellengOptions& options, std::size_t position) {
  return schelleng_limits(options.cell_scene(position));  // of the first row
}

report::Series limit_series(const SchellengOptions& options, bool highest) {
  report::Series series{
      .label = highest ? "Schelleng's maximum" : "Schelleng's minimum",
      .style = highest ? report::SeriesStyle::kLine : report::SeriesStyle::kDashed,
      .color = report::ColorRole::kReference};
  for (std::size_t i = 0; i < static_cast<std::size_t>(options.positions.count); ++i) {
    const BowForceLimits limits = limits_at(options, i);
    series.x.push_back(options.positions.center(i));
    series.y.push_back(highest ? limits.highest : limits.lowest);
  }
  return series;
}

report::CategoryMap regime_map(const SchellengOptions& options, const CellOutcomes& outcomes) {
  report::CategoryMap map{.x_edges = options.positions.edges(), .y_edges = options.forces.edges()};
  for (std::size_t i = 0; i < kStringRegimes; ++i) {
    const RegimeLook& look = look_of(static_cast<StringRegime>(i));
    map.categories.push_back({look.label, look.color});
  }
  for (const auto& outcome : outcomes) {
    map.cells.push_back(has_regime(outcome) ? static_cast<int>(outcome->regime) : -1);
  }
  return map;
}

report::Figure map_figure(const SchellengOptions& options, const CellOutcomes& outcomes) {
  report::Panel panel{.x = {.label = "bow position x_c/L", .unit = "1", .logarithmic = true},
                      .y = {.label = "bow force", .unit = "N", .logarithmic = true}};
  panel.x.range = {options.positions.lowest, options.positions.highest};
  panel.y.range = {options.forces.lowest, options.forces.highest};
  panel.map = regime_map(options, outcomes);
  panel.series = {limit_series(options, true), limit_series(options, false)};
  return {
      .id = "schelleng",
      .title = fmt::format("Motion of the string, v_bow = {:g} m/s", options.scene.bow.velocity),
      .caption = fmt::format(
          "Motion in the last {:g} periods of {:g} s, started {}. Lines: the bow-force limits "
          "of Schelleng (1973) with the losses of the modes.",
          options.criteria.periods, options.scene.duration,
          options.starts_in() == MapStart::kHelmholtz ? "in ideal Helmholtz motion" : "from rest"),
      .panels = {panel}};
}

report::Table count_table(const CellOutcomes& outcomes) {
  std::vector<std::pair<const char*, std::size_t>> counts;
  for (std::size_t i = 0; i < kStringRegimes; ++i) {
    counts.emplace_back(look_of(static_cast<StringRegime>(i)).label, 0);
  }
  std::size_t failed = 0, pending = 0;
  for (const auto& outcome : outcomes) {
    ++(!outcome               ? pending
       : !has_regime(outcome) ? failed
                              : counts[static_cast<std::size_t>(outcome->regime)].second);
  }
  if (failed > 0) counts.emplace_back("failed", failed);
  if (pending > 0) counts.emplace_back("not run yet", pending);
  return report::table_of(
      {.id = "regimes", .title = "Cells of each motion"}, counts,
      [&outcomes](report::RowWriter& row, const auto& count) {
        row({.key = "motion"}, std::string(count.first));
        row({.key = "cells"}, count.second);
        row({.key = "share_percent", .name = "share", .unit = "%", .format = "{:.1f}"},
            100.0 * static_cast<double>(count.second) / static_cast<double>(outcomes.size()));
      });
}

Sample finite_sample(const std::vector<BorderRatios>& ratios, double BorderRatios::*border) {
  Sample sample;
  for (const BorderRatios& one : ratios) {
    if (std::isfinite(one.*border)) sample.add(one.*border);
  }
  return sample;
}

// A border of Helmholtz motion over Schelleng's limit, at the positions where it is on the map.
using Borders = std::vector<std::pair<const char*, Sample>>;

report::Table border_table(const Borders& borders) {
  return report::table_of(
      {.id = "borders",
       .title = "Borders of Helmholtz motion over Schelleng's limits",
       .caption = "Over the bow positions at which the border lies on the map."},
      borders, [](report::RowWriter& row, const auto& border) {
        const auto& [name, ratios] = border;
        row({.key = "border"}, fmt::format("{} force", name));
        row({.key = "positions"}, ratios.values.size());
        row({.key = "median", .name = "simulated / limit, median", .format = "{:.2f}"},
            ratios.median());
        row({.key = "q10", .name = "10 %", .format = "{:.2f}"}, ratios.q10());
        row({.key = "q90", .name = "90 %", .format = "{:.2f}"}, ratios.q90());
      });
}

// One row a cell, with everything that was measured.
report::Table cell_table(const SchellengOptions& options, const CellOutcomes& outcomes) {
  report::Table table{.id = "map"};
  for (std::size_t cell = 0; cell < outcomes.size(); ++cell) {
    const std::optional<CellOutcome>& outcome = outcomes[cell];
    report::add_row(table, [&](report::RowWriter& row) {
      row({.key = "task"}, cell);
      row({.key = "position"}, options.positions.center(options.position_of(cell)));
      row({.key = "normal_force", .unit = "N"}, options.forces.center(options.force_of(cell)));
      // Nothing of a cell that has failed or is not run yet but its reason is known.
      report::RowWriter measured;
      outcome.value_or(CellOutcome{}).visit_motion(measured);
      row.columns.insert(row.columns.end(), measured.columns.begin(), measured.columns.end());
      if (!has_regime(outcome)) measured.cells.assign(measured.cells.size(), report::Cell());
      row.cells.insert(row.cells.end(), measured.cells.begin(), measured.cells.end());
      row.cell({.key = "failure"},
               outcome && !has_regime(outcome) ? report::Cell(outcome->failure) : report::Cell());
    });
  }
  return table;
}

void add_failures(const CellOutcomes& outcomes, StudyResult& result) {
  const auto first = std::find_if(outcomes.begin(), outcomes.end(), [](const auto& outcome) {
    return outcome && !outcome->failure.empty();
  });
  if (first == outcomes.end()) return;
  result.blocks.emplace_back(report::Text{
      .text = fmt::format("{} cells failed; the first: {}", result.failed_tasks, (*first)->failure),
      .kind = report::Text::Kind::kFailure});
}

std::vector<std::string> border_lines(const Borders& borders) {
  std::vector<std::string> lines;
  for (const auto& [name, ratios] : borders) {
    lines.push_back(
        ratios.values.empty()
            ? fmt::format("{} force of Helmholtz motion: not on the map", name)
            : fmt::format("{} force of Helmholtz motion / Schelleng's limit: {:.2f} [{:.2f}, "
                          "{:.2f}] over {} bow positions",
                          name, ratios.median(), ratios.q10(), ratios.q90(), ratios.values.size()));
  }
  return lines;
}

std::string summary_of(const report::Table& counts, const Borders& borders) {
  std::string text;
  for (const auto& row : counts.rows) {
    text += fmt::format("{:<18}{:>6} cells  {:>5} %\n", cell_text(row[0], counts.columns[0]),
                        cell_text(row[1], counts.columns[1]), cell_text(row[2], counts.columns[2]));
  }
  for (const std::string& line : border_lines(borders)) text += line + "\n";
  return text;
}

}  // namespace

std::vector<BorderRatios> border_ratios(const SchellengOptions& options,
                                        const CellOutcomes& outcomes) {
  const std::vector<double> edges = options.forces.edges();
  std::vector<BorderRatios> ratios;
  for (std::size_t column = 0; column < static_cast<std::size_t>(options.positions.count);
       ++column) {
    const auto [begin, end] = longest_run(options, outcomes, column);
    const BowForceLimits limits = schelleng_limits(options.cell_scene(column));
    const bool is_there = begin < end;
    ratios.push_back({is_there && begin > 0 ? edges[begin] / limits.lowest : kNaN,
                      is_there && end + 1 < edges.size() ? edges[end] / limits.highest : kNaN});
  }
  return ratios;
}

void sum_up_map(const SchellengOptions& options, const CellOutcomes& outcomes,
                StudyResult& result) {
  add_failures(outcomes, result);
  const std::vector<BorderRatios> ratios = border_ratios(options, outcomes);
  const Borders borders = {{"lowest", finite_sample(ratios, &BorderRatios::lowest)},
                           {"highest", finite_sample(ratios, &BorderRatios::highest)}};
  report::Table counts = count_table(outcomes);
  result.summary = summary_of(counts, borders);
  for (const std::string& line : border_lines(borders)) {
    result.answer += (result.answer.empty() ? "" : "; ") + line;
  }
  result.answer[0] = 'L';  // lowest
  result.blocks.emplace_back(map_figure(options, outcomes));
  result.blocks.emplace_back(std::move(counts));
  result.blocks.emplace_back(border_table(borders));
  const report::Table cells = cell_table(options, outcomes);
  result.files.emplace_back("map.csv", report::table_csv(cells));
  result.files.emplace_back("map.json", report::table_json(cells));
}

StudyResult show_cell(const SchellengOptions& options, std::size_t cell,
                      const StudyContext& context) {
  const Scene scene = options.cell_scene(cell);
  OutputRequest outputs = OutputRequest::all();
  outputs.switches_from = judged_from(scene, options.criteria);
  const Simulation simulation =
      options.simulator.make()->simulate(scene, options.sample_rate, outputs, context.stop);
  const CellOutcome outcome = judge_cell(scene, simulation, options.criteria);
  StudyResult result;
  if (!outcome.failure.empty()) {
    result.status = report::Status::kFailed;
    result.failed_tasks = 1;
    result.summary = outcome.failure + "\n";
    result.answer = outcome.failure;
    result.blocks.emplace_back(
        report::Text{.text = outcome.failure, .kind = report::Text::Kind::kFailure});
    return result;
  }
  const double shown = 6.0 / scene.string.fundamental;
  FigureOptions figure{.id = "waveforms", .title = "The last periods"};
  figure.windows = {{.start = scene.duration - shown, .stop = scene.duration}};
  report::Figure drawn = simulation_figure(figure, simulation);
  result.blocks.emplace_back(std::move(drawn));
  const RegimeFeatures& f = outcome.features;
  const BowForceLimits limits = schelleng_limits(scene);
  result.summary = fmt::format(
      "{}: {:.3g} slips a period, periodicity {:.4f} at {:.4f} periods, sticking for {:.1f} % of "
      "the time, {:.3g} times as strong as Helmholtz motion\nbow force {:.4g} N; Schelleng's "
      "limits "
      "{:.4g} N and {:.4g} N\n",
      look_of(outcome.regime).label, f.slips_per_period, f.periodicity, f.period,
      100.0 * f.adherence, f.amplitude, scene.bow.normal_force, limits.lowest, limits.highest);
  result.answer_by_summary();
  result.blocks.emplace_back(report::Text{.text = result.summary});
  result.signal_files.push_back({"signals.csv",
                                 {simulation.displacement, simulation.velocity, simulation.force,
                                  simulation.left_reaction, simulation.right_reaction}});
  return result;
}

}  // namespace modcal
