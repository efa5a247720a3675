#pragma once

#include "experiments/experiment.hpp"
#include "experiments/kinds/section7/pluck_then_bow.hpp"

namespace modcal {

/// Kind "pluck_then_bow": pluck test, refinement on a stroke, law, contact, identification.
class PluckThenBowExperiment final : public Experiment {
 public:
  using Options = PluckThenBowOptions;
  explicit PluckThenBowExperiment(Options options) : options_(std::move(options)) {}
  std::vector<Finding> lint() const override;
  std::vector<std::string> plan() const override;
  std::optional<PlannedSimulations> planned_simulations() const override;
  StudyResult run(const StudyContext& context) const override {
    return pluck_then_bow_study(options_, context);
  }

 private:
  Options options_;
};

}  // namespace modcal
