#include "experiments/kinds/schelleng/schelleng.hpp"

#include "libsim/base/words.hpp"

namespace modcal {
namespace {

void lint_axis(const std::string& path, const MapAxis& axis, std::vector<Finding>& findings) {
  if (axis.lowest < axis.highest) return;
  add_finding(findings, path,
              "the axis goes from {:g} to {:g}: the highest value must be "
              "above the lowest",
              axis.lowest, axis.highest);
}

// Simulates one cell. Throws InvalidInput where it cannot be done.
CellOutcome run_map_cell(const SchellengOptions& options, std::size_t cell, const StopToken& stop) {
  const Scene scene = options.cell_scene(cell);
  const Simulation simulation =
      options.simulator.make()->simulate(scene, options.sample_rate, options.outputs(), stop);
  return judge_cell(scene, simulation, options.criteria);
}

}  // namespace

void MapAxis::visit(OptionVisitor& visitor) {
  visitor("lowest", "lower end of the axis", {.unit = unit, .range = Range::positive()}, lowest);
  visitor("highest", "upper end of the axis", {.unit = unit, .range = Range::positive()}, highest);
  visitor("count", "cells between them, in equal ratios", {.range = Range::closed(1, 10000)},
          count);
}

std::vector<double> MapAxis::edges() const {
  std::vector<double> edges;
  for (std::int64_t i = 0; i <= count; ++i) {
    edges.push_back(
        lowest * std::pow(highest / lowest, static_cast<double>(i) / static_cast<double>(count)));
  }
  return edges;
}

double MapAxis::center(std::size_t index) const {
  return lowest * std::pow(highest / lowest,
                           (static_cast<double>(index) + 0.5) / static_cast<double>(count));
}

void SchellengOptions::visit(OptionVisitor& visitor) {
  visitor("scene", "string, bow, friction; position and force of the bow are the map's",
          {.required = true}, scene);
  visitor("simulator", "how the cells are simulated", simulator);
  visitor("sample_rate", "rate at which the velocity of the contact is sampled",
          {.unit = "Hz", .range = Range::positive()}, sample_rate);
  visitor("positions", "bow positions x_c/L, from the end x = 0", positions);
  visitor("forces", "normal forces of the bow", forces);
  visitor("start",
          "motion at t = 0: helmholtz (which motion is kept up) or rest (which "
          "motion is reached)",
          {.choices = choices_of(kMapStarts)}, start);
  visitor("criteria", "where the regimes part", criteria);
}

MapStart SchellengOptions::starts_in() const {
  return enum_of<MapStart>(kMapStarts, "start of the map", start);
}

Scene SchellengOptions::cell_scene(std::size_t cell) const {
  Scene result = scene;
  result.bow.position = positions.center(position_of(cell)) * scene.string.length;
  result.bow.normal_force = forces.center(force_of(cell));
  if (starts_in() == MapStart::kHelmholtz) {
    result.initial =
        helmholtz_motion(make_modal_basis(scene.string), result.bow.position, scene.bow.velocity);
  }
  return result;
}

OutputRequest SchellengOptions::outputs() const {
  return {.velocity = true, .switches_from = judged_from(scene, criteria)};
}

CellOutcome judge_cell(const Scene& scene, const Simulation& simulation,
                       const RegimeCriteria& criteria) {
  CellOutcome outcome;
  if (simulation.diverged_at) {
    outcome.failure = fmt::format(
        "stopped at {:g} s: {}; take a shorter simulator.time_step or another simulator",
        *simulation.diverged_at, simulation.explanation);
    return outcome;
  }
  outcome.features = regime_features(scene, simulation, criteria);
  outcome.regime = classify(outcome.features, criteria);
  return outcome;
}

void CellOutcome::visit(ResultVisitor& visitor) {
  visitor({.key = "failure", .optional = true}, failure);
  if (!failure.empty()) return;
  visit_motion(visitor);
}

void CellOutcome::visit_motion(ResultVisitor& visitor) {
  visitor.word({.key = "motion"}, regime, StringRegime::kSilent);
  visitor({.key = "slips_per_period"}, features.slips_per_period);
  visitor({.key = "periodicity"}, features.periodicity);
  visitor({.key = "period"}, features.period);
  visitor({.key = "adherence"}, features.adherence);
  visitor({.key = "amplitude"}, features.amplitude);
}

SchellengExperiment::SchellengExperiment(Options options)
    : ProductExperiment(
          {axis_of(
               "bow.normal_force", static_cast<std::size_t>(options.forces.count),
               [&](std::size_t i) { return fmt::format("{:.6g} N", options.forces.center(i)); }),
           axis_of(
               "bow.position/length", static_cast<std::size_t>(options.positions.count),
               [&](std::size_t i) { return fmt::format("{:.6g}", options.positions.center(i)); })}),
      options_(std::move(options)) {}

std::vector<Finding> SchellengExperiment::lint() const {
  const SchellengOptions& o = options_;
  Scene scene = o.scene;
  scene.bow.position = o.positions.center(0) * scene.string.length;
  std::vector<Finding> findings = lint_scene(scene, o.simulator, {.sample_rate = o.sample_rate});
  lint_axis("positions", o.positions, findings);
  lint_axis("forces", o.forces, findings);
  if (o.positions.highest > 0.5) {
    add_finding(findings, "positions.highest",
                "the bow position {:g} is beyond the middle of the string: the "
                "other half holds the same map",
                o.positions.highest);
  }
  if (scene.bow.velocity == 0.0) {
    add_finding(findings, "scene.bow.velocity", "a bow that stands still keeps no motion up");
  }
  if (!bow_motion(scene.bow, scene.duration).is_steady()) {
    add_finding(findings, "scene.bow",
                "the bow's velocity or force goes with time: a map of steady "
                "strokes has neither gestures nor noise");
  }
  if (is_known(scene.string) && judged_from(scene, o.criteria) < 0.0) {
    add_finding(findings, "scene.duration",
                "{:g} s are too short to judge {:g} periods of {:.4g} s: it takes {:.4g} s",
                scene.duration, o.criteria.periods, 1.0 / scene.string.fundamental,
                scene.duration - judged_from(scene, o.criteria));
  }
  return findings;
}

std::vector<PlanLine> SchellengExperiment::plan() const {
  return {{fmt::format("tasks: {} ({} bow positions x {} forces)", options_.cells(),
                       options_.positions.count, options_.forces.count),
           {{"tasks", options_.cells()},
            {"positions", options_.positions.count},
            {"forces", options_.forces.count}}},
          plan_line(*planned_simulations())};
}

// The cell in the middle of the map stands for all.
std::optional<PlannedSimulations> SchellengExperiment::planned_simulations() const {
  const std::size_t middle =
      options_.cells() / 2 + static_cast<std::size_t>(options_.positions.count) / 2;
  return PlannedSimulations{
      .truth = {options_.cell_scene(std::min(middle, options_.cells() - 1)), options_.simulator},
      .sample_rate = options_.sample_rate,
      .outputs = options_.outputs(),
      .count = options_.cells(),
      .numbers_per_sample = 20.0,
      .are_kept = false};
}

// The axes are left out: a cell is the same in any map that has it.
std::string SchellengExperiment::fingerprint(std::size_t task,
                                             const std::filesystem::path& /*folder*/) const {
  SchellengOptions o = options_;
  Scene scene = options_.cell_scene(task);
  return "schelleng " + modcal::fingerprint([&](OptionVisitor& visitor) {
           scene.visit(visitor);
           visitor("simulator", "", o.simulator);
           visitor("sample_rate", "", o.sample_rate);
           visitor("start", "", o.start);
           o.criteria.visit(visitor);
         });
}

std::string SchellengExperiment::run_task(std::size_t task, const StudyContext& context) const {
  return report::json_line(attempted([&] { return run_map_cell(options_, task, context.stop); }));
}

StudyResult SchellengExperiment::sum_up(const TaskOutcomes& outcomes,
                                        const StudyContext& /*context*/) const {
  StudyResult result;
  CellOutcomes cells(outcomes.size());
  for_each_outcome<CellOutcome>(outcomes, result,
                                [&](std::size_t task, CellOutcome outcome, double /*seconds*/) {
                                  cells[task] = std::move(outcome);
                                });
  sum_up_map(options_, cells, result);
  return result;
}

}  // namespace modcal
