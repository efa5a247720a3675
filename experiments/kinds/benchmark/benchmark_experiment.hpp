#pragma once

#include "experiments/kinds/benchmark/benchmark_study.hpp"
#include "experiments/kinds/benchmark/benchmark_summary.hpp"
#include "experiments/kinds/sweep/swept_options.hpp"
#include "experiments/runs/task_experiment.hpp"

namespace modcal {

/// Options of kind "benchmark": those of a calibration, when it is right, the axes.
struct BenchmarkOptions {
  CalibrateOptions base;
  SuccessOptions success;
  SweptOptions<CalibrateOptions> cells;
  void visit(OptionVisitor& visitor);
};

/// Kind "benchmark": objectives and optimizers on the same truths, noise and starts.
class BenchmarkExperiment final : public TaskExperiment {
 public:
  using Options = BenchmarkOptions;
  explicit BenchmarkExperiment(Options options) : options_(std::move(options)) {}
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
  std::string loss_name() const override { return "median relative frequency error"; }
  std::optional<double> loss_in(const std::string& outcome) const override;
  StudyResult sum_up(const TaskOutcomes& outcomes, const StudyContext& context) const override;
  StudyResult replay(std::size_t task, const StudyContext& context) const override;

 private:
  std::string method_of(std::size_t task) const;
  std::string objective_of(std::size_t task) const;
  std::string search_of(std::size_t task) const;
  std::string condition_of(std::size_t task) const;
  std::string replicate_of(std::size_t task) const;
  BenchmarkGrid grid(const TaskOutcomes& outcomes) const;
  Options options_;
  std::shared_ptr<FrequencyBounds> bounds_ = std::make_shared<FrequencyBounds>();
};

}  // namespace modcal
