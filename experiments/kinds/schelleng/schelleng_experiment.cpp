#include "experiments/kinds/schelleng/schelleng_experiment.hpp"

#include <fmt/format.h>

#include "experiments/kinds/lint.hpp"
#include "experiments/runs/stored_outcomes.hpp"
#include "experiments/study/fingerprint.hpp"

namespace modcal {
namespace {

void lint_axis(const std::string& path, const MapAxis& axis, std::vector<Finding>& findings) {
  if (axis.lowest < axis.highest) return;
  add_finding(findings, path,
              "the axis goes from {:g} to {:g}: the highest value must be "
              "above the lowest",
              axis.lowest, axis.highest);
}

}  // namespace

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

std::vector<std::string> SchellengExperiment::plan() const {
  return {fmt::format("tasks: {} ({} bow positions x {} forces)", options_.cells(),
                      options_.positions.count, options_.forces.count),
          plan_line(*planned_simulations())};
}

// The cell in the middle of the map stands for all.
std::optional<PlannedSimulations> SchellengExperiment::planned_simulations() const {
  const std::size_t middle =
      options_.cells() / 2 + static_cast<std::size_t>(options_.positions.count) / 2;
  return PlannedSimulations{.scene = options_.cell_scene(std::min(middle, options_.cells() - 1)),
                            .simulator = options_.simulator,
                            .sample_rate = options_.sample_rate,
                            .outputs = options_.outputs(),
                            .count = options_.cells()};
}

// The axes are left out: a cell is the same in any map that has it.
std::string SchellengExperiment::fingerprint(std::size_t task,
                                             const std::filesystem::path& /*folder*/) const {
  SchellengOptions o = options_;
  Scene scene = options_.cell_scene(task);
  return "schelleng " + modcal::fingerprint([&](OptionVisitor& visitor) {
           scene.visit(visitor);
           visitor.plugin({.key = "simulator", .meaning = ""}, o.simulator);
           visitor.number({.key = "sample_rate", .meaning = ""}, o.sample_rate);
           visitor.text({.key = "start", .meaning = ""}, o.start);
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
