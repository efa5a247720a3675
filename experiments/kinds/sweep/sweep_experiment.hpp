#pragma once

#include "experiments/kinds/axis_experiment.hpp"
#include "experiments/kinds/study_experiment.hpp"
#include "experiments/kinds/sweep/sweep_study.hpp"

namespace modcal {

/// Kind "sweep": the same inversion over axes of settings, summed up in a table.
class SweepExperiment final : public AxisExperiment<StudyExperiment<InvertOptions>, SweepOptions> {
 public:
  using AxisExperiment::AxisExperiment;
  std::vector<Finding> lint() const override;
  std::string run_task(std::size_t task, const StudyContext& context) const override;
  std::string loss_name() const override { return "mean relative rms error of the force"; }
  std::optional<double> loss_in(const std::string& outcome) const override;
  StudyResult sum_up(const TaskOutcomes& outcomes, const StudyContext& context) const override;

 private:
  // What is wrong with figures is that there are some.
  bool is_excused(const InvertOptions& /*cell*/, const Finding& finding) const override {
    return finding.path.starts_with("figures");
  }
  void draw_all(InvertOptions& cell) const override;
};

}  // namespace modcal
