#include "experiments/kinds/schelleng/schelleng_study.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

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
  try {
    const Scene scene = options.cell_scene(cell);
    const Simulation simulation =
        options.simulator.make()->simulate(scene, options.sample_rate, options.outputs(), stop);
    return judge_cell(scene, simulation, options.criteria);
  } catch (const InvalidInput& error) {
    return {.failure = error.what()};
  }
}

std::string cell_outcome_text(const CellOutcome& outcome) {
  if (!outcome.failure.empty()) return nlohmann::json{{"failure", outcome.failure}}.dump();
  const RegimeFeatures& features = outcome.features;
  return nlohmann::json{
      {"regime", name_of(outcome.regime)},   {"slips_per_period", features.slips_per_period},
      {"periodicity", features.periodicity}, {"period", features.period},
      {"adherence", features.adherence},     {"amplitude", features.amplitude}}
      .dump();
}

namespace {

StringRegime read_regime(const std::string& name) {
  for (std::size_t i = 0; i < kStringRegimes; ++i) {
    if (name_of(static_cast<StringRegime>(i)) == name) return static_cast<StringRegime>(i);
  }
  throw InvalidInput("unknown regime of a bowed string: " + name);
}

}  // namespace

CellOutcome read_cell_outcome(const std::string& text) {
  try {
    const auto value = nlohmann::json::parse(text);
    CellOutcome outcome{.failure = value.value("failure", std::string())};
    if (!outcome.failure.empty()) return outcome;
    outcome.regime = read_regime(value.at("regime").get<std::string>());
    outcome.features = {.slips_per_period = value.at("slips_per_period").get<double>(),
                        .periodicity = value.at("periodicity").get<double>(),
                        .period = value.at("period").get<double>(),
                        .adherence = value.at("adherence").get<double>(),
                        .amplitude = value.at("amplitude").get<double>()};
    return outcome;
  } catch (const nlohmann::json::exception& error) {
    throw InvalidInput(std::string("the stored outcome of a cell cannot be read: ") + error.what());
  }
}

}  // namespace modcal
