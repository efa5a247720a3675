#pragma once

#include "experiments/experiment.hpp"
#include "experiments/kinds/calibrate/calibrate_study.hpp"
#include "experiments/kinds/calibrate/limit_source.hpp"

namespace modcal {

/// Kind "calibrate": refine the modal model, then identify force and motion with it.
class CalibrateExperiment final : public Experiment, public LimitSource {
 public:
  using Options = CalibrateOptions;
  explicit CalibrateExperiment(Options options) : options_(std::move(options)) {}
  std::vector<Finding> lint() const override;
  std::vector<std::string> plan() const override;
  std::optional<PlannedSimulations> planned_simulations() const override;
  std::vector<std::string> files_read() const override;
  LimitQuestion limit_question() const override;
  StudyResult run(const StudyContext& context) const override {
    return calibrate_study(options_, context);
  }

 private:
  Options options_;
};

}  // namespace modcal
