#include "experiments/kinds/sweep_experiment.hpp"

#include <algorithm>
#include <set>

#include "experiments/kinds/invert_experiment.hpp"
#include "experiments/kinds/lint.hpp"
#include "experiments/kinds/scene_plan.hpp"

namespace modcal {

void SweepExperimentOptions::visit(OptionVisitor& visitor) {
  base.visit(visitor);
  visitor.section({.key = "table", .meaning = "how the results are summed up"}, sweep.table);
  visitor.optional_group(
      {.key = "compare_with", .meaning = "published figures to hold beside ours"},
      sweep.has_comparison, [this](OptionVisitor& inner) { sweep.comparison.visit(inner); });
  // Last: every cell is read with the keys above known.
  visitor.sweep(
      {.key = "sweep", .meaning = "axes: option paths and their values", .required = true}, *this);
}

void SweepExperimentOptions::set_axes(std::vector<SweepAxis> axes) {
  sweep_axes = std::move(axes);
  std::size_t count = 1;
  for (const SweepAxis& axis : sweep_axes) {
    count *= axis.values.size();
    MODCAL_REQUIRE(count <= 1000000, "the sweep has more than a million cells");
  }
  cell_options.assign(count, InvertOptions{});
}

std::vector<SweepCell> SweepExperiment::cells() const {
  std::vector<SweepCell> cells;
  for (std::size_t index = 0; index < options_.cell_options.size(); ++index) {
    SweepCell cell;
    cell.options = options_.cell_options[index];
    cell.row_value = cell.options.observation.measurement.noise_level;
    cell.axis_values.resize(options_.sweep_axes.size());
    std::size_t rest = index;
    for (std::size_t a = options_.sweep_axes.size(); a-- > 0;) {
      const std::vector<std::string>& values = options_.sweep_axes[a].values;
      cell.axis_values[a] = values[rest % values.size()];
      rest /= values.size();
    }
    cells.push_back(std::move(cell));
  }
  return cells;
}

std::vector<Finding> SweepExperiment::lint() const {
  std::vector<Finding> findings;
  if (!report::is_file_stem(options_.sweep.table.name)) {
    findings.push_back({"table.name",
                        "the name of the table cannot be a file name: use letters, "
                        "digits, - and _"});
  }
  if (!options_.base.figures.empty()) {
    findings.push_back(
        {"figures", "a sweep draws its own figure: use kind invert for single ones"});
  }
  std::set<std::pair<std::string, std::string>> known;
  for (const InvertOptions& cell : options_.cell_options) {
    for (Finding& finding : lint_inversion(cell)) {
      if (known.insert({finding.path, finding.text}).second) findings.push_back(std::move(finding));
    }
  }
  return findings;
}

std::vector<std::string> SweepExperiment::plan() const {
  const ObservationOptions& observation = options_.base.observation;
  std::vector<std::string> lines;
  for (const SweepAxis& axis : options_.sweep_axes) {
    lines.push_back(fmt::format("axis {}: {} values", axis.path, axis.values.size()));
  }
  lines.push_back(fmt::format("tasks: {}", options_.cell_options.size()));
  std::set<std::string> scenes;
  for (const SweepCell& cell : cells()) {
    scenes.insert(truth_key(cell.options.observation.truth,
                            cell.options.observation.measurement.sample_rate, {.force = true}));
  }
  if (observation.has_scene) {
    for (std::string& line :
         plan_scene(observation.truth.scene, observation.measurement.sample_rate, scenes.size())) {
      lines.push_back(std::move(line));
    }
    lines.push_back(fmt::format("skipped: {} simulations whose scene another task has",
                                options_.cell_options.size() - scenes.size()));
  }
  lines.push_back("skipped: displacement and velocity at the contact, which no score reads");
  return lines;
}

StudyResult SweepExperiment::run(const StudyContext& context) const {
  const std::vector<SweepCell> all = cells();
  std::vector<std::string> axes;
  for (const SweepAxis& axis : options_.sweep_axes) axes.push_back(axis.path);
  return sum_up_sweep(options_.sweep, axes, all, run_cells(all, context), context);
}

}  // namespace modcal
