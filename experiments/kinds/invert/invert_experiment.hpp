#pragma once

#include "experiments/experiment.hpp"
#include "experiments/kinds/invert/invert_study.hpp"

namespace modcal {

/// Kind "invert": contact force and motion from simulated or recorded reactions.
class InvertExperiment final : public Experiment {
 public:
  using Options = InvertOptions;
  explicit InvertExperiment(Options options) : options_(std::move(options)) {}
  std::vector<Finding> lint() const override;
  std::vector<std::string> plan() const override;
  std::optional<PlannedSimulations> planned_simulations() const override;
  StudyResult run(const StudyContext& context) const override {
    return invert_study(options_, context);
  }

 private:
  Options options_;
};

/// Findings about an inversion, shared with the sweep.
std::vector<Finding> lint_inversion(const InvertOptions& options);

}  // namespace modcal
