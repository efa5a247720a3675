#include <cmath>

#include "experiments/kinds/schelleng/schelleng_experiment.hpp"
#include "libsim/base/error.hpp"
#include "libsim/dynamics/scene/string_regime.hpp"

namespace modcal {

void MapAxis::visit(OptionVisitor& visitor) {
  visitor.number({.key = "lowest",
                  .meaning = "lower end of the axis",
                  .unit = unit,
                  .range = Range::positive()},
                 lowest);
  visitor.number({.key = "highest",
                  .meaning = "upper end of the axis",
                  .unit = unit,
                  .range = Range::positive()},
                 highest);
  visitor.integer({.key = "count",
                   .meaning = "cells between them, in equal ratios",
                   .range = Range::closed(1, 10000)},
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
  visitor.section({.key = "scene",
                   .meaning = "string, bow, friction; position and force of the bow are the map's",
                   .required = true},
                  scene);
  visitor.plugin({.key = "simulator", .meaning = "how the cells are simulated"}, simulator);
  visitor.number({.key = "sample_rate",
                  .meaning = "rate at which the velocity of the contact is sampled",
                  .unit = "Hz",
                  .range = Range::positive()},
                 sample_rate);
  visitor.section({.key = "positions", .meaning = "bow positions x_c/L, from the end x = 0"},
                  positions);
  visitor.section({.key = "forces", .meaning = "normal forces of the bow"}, forces);
  visitor.text({.key = "start",
                .meaning = "motion at t = 0: helmholtz (which motion is kept up) or rest (which "
                           "motion is reached)",
                .choices = {"helmholtz", "rest"}},
               start);
  visitor.section({.key = "criteria", .meaning = "where the regimes part"}, criteria);
}

Scene SchellengOptions::cell_scene(std::size_t cell) const {
  Scene result = scene;
  result.bow.position = positions.center(position_of(cell)) * scene.string.length;
  result.bow.normal_force = forces.center(force_of(cell));
  if (start == "helmholtz") {
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
    outcome.failure =
        fmt::format("stopped at {:g} s: {}", *simulation.diverged_at, simulation.explanation);
    return outcome;
  }
  outcome.features = regime_features(scene, simulation, criteria);
  outcome.regime = classify(outcome.features, criteria);
  return outcome;
}

CellOutcome run_map_cell(const SchellengOptions& options, std::size_t cell, const StopToken& stop) {
  const Scene scene = options.cell_scene(cell);
  const Simulation simulation =
      options.simulator.make()->simulate(scene, options.sample_rate, options.outputs(), stop);
  return judge_cell(scene, simulation, options.criteria);
}

void CellOutcome::visit(ResultVisitor& visitor) {
  visitor({.key = "failure", .optional = true}, failure);
  if (!failure.empty()) return;
  visitor.word({.key = "regime"}, regime, StringRegime::kSilent);
  visitor({.key = "slips_per_period"}, features.slips_per_period);
  visitor({.key = "periodicity"}, features.periodicity);
  visitor({.key = "period"}, features.period);
  visitor({.key = "adherence"}, features.adherence);
  visitor({.key = "amplitude"}, features.amplitude);
}

}  // namespace modcal
