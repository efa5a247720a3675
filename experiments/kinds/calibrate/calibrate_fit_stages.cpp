#include "experiments/kinds/calibrate/calibrate_fit_stages.hpp"

#include <cmath>

#include "experiments/kinds/calibrate/calibrate_study.hpp"

namespace modcal {

nlohmann::ordered_json stages_json(const std::vector<FitStage>& stages) {
  using Json = nlohmann::ordered_json;
  const auto number = [](double value) { return std::isfinite(value) ? Json(value) : Json(); };
  Json list = Json::array();
  for (const FitStage& stage : stages) {
    list.push_back({{"name", stage.name},
                    {"evaluations", stage.evaluations},
                    {"objective", number(stage.objective)},
                    {"chi2", number(stage.chi2)}});
  }
  return list;
}

report::Table stage_table(const std::vector<FitStage>& stages, const std::string& command) {
  report::Table table{
      .id = "stages",
      .title = "Stages of the continuation",
      .caption =
          "Every stage has a record of its own: damped by sigma, whole, or whole with "
          "weighted bins. Objectives of different stages do not compare.",
      .columns = {{.key = "stage"},
                  {.key = "evaluations", .name = "evaluations so far"},
                  {.key = "objective", .format = "{:.6g}"},
                  {.key = "chi2", .name = "reduced chi2", .format = "{:.4f}"}},
      .command = command};
  for (const FitStage& stage : stages) {
    const report::Cell chi2 = std::isfinite(stage.chi2) ? report::Cell(stage.chi2) : report::Cell();
    table.rows.push_back({stage.name, stage.evaluations, stage.objective, chi2});
  }
  return table;
}

void add_stages(const CalibrationOutcome& outcome, const std::string& command,
                StudyResult& result) {
  const auto& found = outcome.result.continuation;
  if (found) result.blocks.emplace_back(stage_table(found->stages, command));
}

}  // namespace modcal
