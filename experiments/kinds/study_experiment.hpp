#pragma once

#include "experiments/experiment.hpp"

namespace modcal {

/// A kind whose options do all the work: lint(), plan(), planned_simulations() and run().
template <typename OptionsOfKind>
class StudyExperiment : public Experiment {
 public:
  using Options = OptionsOfKind;
  explicit StudyExperiment(Options options) : options_(std::move(options)) {}
  std::vector<Finding> lint() const override { return options_.lint(); }
  std::vector<std::string> plan() const override { return options_.plan(); }
  std::optional<PlannedSimulations> planned_simulations() const override {
    return options_.planned_simulations();
  }
  std::vector<std::string> files_read() const override {
    if constexpr (requires { options_.files_read(); }) return options_.files_read();
    return {};
  }
  StudyResult run(const StudyContext& context) const override { return options_.run(context); }

 protected:
  const Options& options() const { return options_; }

 private:
  Options options_;
};

}  // namespace modcal
