#pragma once

#include "experiments/kinds/sweep/sweep_study.hpp"
#include "experiments/kinds/sweep/swept_options.hpp"
#include "experiments/runs/task_experiment.hpp"

namespace modcal {

/// Options of kind "sweep": those of an inversion, the axes, the table.
struct SweepExperimentOptions {
  InvertOptions base;
  SweepOptions sweep;
  SweptOptions<InvertOptions> cells;

  void visit(OptionVisitor& visitor);
};

/// Kind "sweep": the same inversion over axes of settings, summed up in a table.
class SweepExperiment final : public TaskExperiment {
 public:
  using Options = SweepExperimentOptions;
  explicit SweepExperiment(Options options) : options_(std::move(options)) {}
  std::vector<Finding> lint() const override;
  std::vector<std::string> plan() const override;
  std::optional<PlannedSimulations> planned_simulations() const override;

  std::size_t task_count() const override { return options_.cells.size(); }
  std::vector<std::string> axes() const override { return options_.cells.paths(); }
  std::vector<std::string> axis_values(std::size_t task) const override {
    return options_.cells.values(task);
  }
  std::string fingerprint(std::size_t task, const std::filesystem::path& folder) const override;
  std::string run_task(std::size_t task, const StudyContext& context) const override;
  std::string failure_in(const std::string& outcome) const override;
  std::string loss_name() const override { return "mean relative rms error of the force"; }
  std::optional<double> loss_in(const std::string& outcome) const override;
  StudyResult sum_up(const TaskOutcomes& outcomes, const StudyContext& context) const override;
  StudyResult replay(std::size_t task, const StudyContext& context) const override;

 private:
  SweepCell cell(std::size_t task) const;
  Options options_;
};

}  // namespace modcal
