#pragma once

#include "experiments/kinds/schelleng/schelleng_study.hpp"
#include "experiments/runs/task_experiment.hpp"

namespace modcal {

/// Kind "schelleng": a map of the string's motion over bow positions and forces, a task a cell.
class SchellengExperiment final : public TaskExperiment {
 public:
  using Options = SchellengOptions;
  explicit SchellengExperiment(Options options) : options_(std::move(options)) {}
  std::vector<Finding> lint() const override;
  std::vector<std::string> plan() const override;
  std::optional<PlannedSimulations> planned_simulations() const override;

  std::size_t task_count() const override { return options_.cells(); }
  std::vector<std::string> axes() const override {
    return {"bow.position/length", "bow.normal_force"};
  }
  std::vector<std::string> axis_values(std::size_t task) const override;
  std::string fingerprint(std::size_t task, const std::filesystem::path& folder) const override;
  std::string run_task(std::size_t task, const StudyContext& context) const override;
  std::string failure_in(const std::string& outcome) const override;
  StudyResult sum_up(const TaskOutcomes& outcomes, const StudyContext& context) const override;
  StudyResult replay(std::size_t task, const StudyContext& context) const override {
    return show_cell(options_, task, context);
  }

 private:
  Options options_;
};

}  // namespace modcal
