#pragma once

#include "experiments/kinds/axis_experiment.hpp"
#include "experiments/kinds/benchmark/benchmark_study.hpp"
#include "experiments/kinds/benchmark/benchmark_summary.hpp"
#include "experiments/kinds/calibrate/calibrate_experiment.hpp"

namespace modcal {

/// Kind "benchmark": objectives and optimizers on the same truths, noise and starts.
class BenchmarkExperiment final : public AxisExperiment<CalibrateExperiment, SuccessOptions> {
 public:
  using AxisExperiment::AxisExperiment;
  std::vector<Finding> lint() const override;
  std::vector<std::string> plan() const override;

  std::string run_task(std::size_t task, const StudyContext& context) const override;
  std::string loss_name() const override { return "median relative frequency error"; }
  std::optional<double> loss_in(const std::string& outcome) const override;
  StudyResult sum_up(const TaskOutcomes& outcomes, const StudyContext& context) const override;

 private:
  bool is_excused(const CalibrateOptions& cell, const Finding& finding) const override;
  void visit_scoring(OptionVisitor& visitor) const override;
  void draw_all(CalibrateOptions& cell) const override;
  BenchmarkLabels labels_of(std::size_t task) const;
  BenchmarkGrid grid(const TaskOutcomes& outcomes, StudyResult& result) const;
  std::shared_ptr<FrequencyBounds> bounds_ = std::make_shared<FrequencyBounds>();
};

}  // namespace modcal
