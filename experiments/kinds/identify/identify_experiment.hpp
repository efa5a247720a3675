#pragma once

#include "experiments/experiment.hpp"
#include "experiments/kinds/identify/identify_study.hpp"

namespace modcal {

/// Kind "identify": the modes of a plucked string from its end reactions.
class IdentifyExperiment final : public Experiment {
 public:
  using Options = IdentifyOptions;
  explicit IdentifyExperiment(Options options) : options_(std::move(options)) {}
  std::vector<Finding> lint() const override;
  std::vector<std::string> plan() const override;
  std::optional<PlannedSimulations> planned_simulations() const override;
  StudyResult run(const StudyContext& context) const override {
    return identify_study(options_, context);
  }

 private:
  Options options_;
};

}  // namespace modcal
