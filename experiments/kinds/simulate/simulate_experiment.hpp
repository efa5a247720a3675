#pragma once

#include "experiments/experiment.hpp"
#include "experiments/kinds/simulate/simulate_study.hpp"

namespace modcal {

/// Kind "simulate": a bowed string, its signals as files and figures.
class SimulateExperiment final : public Experiment {
 public:
  using Options = SimulateOptions;
  explicit SimulateExperiment(Options options) : options_(std::move(options)) {}
  std::vector<Finding> lint() const override;
  std::vector<std::string> plan() const override;
  std::optional<PlannedSimulations> planned_simulations() const override;
  StudyResult run(const StudyContext& context) const override {
    return simulate_study(options_, context);
  }

 private:
  Options options_;
};

}  // namespace modcal
