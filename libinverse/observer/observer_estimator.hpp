#pragma once

#include "libinverse/estimator.hpp"
#include "libinverse/observer/model_based_estimator.hpp"

namespace modcal {

/// The model-based estimate (ModelBasedEstimator) beside the linear ones, side "model". It assumes
/// a friction law and needs both reactions of a record that starts at rest; its misfit J and what
/// the static level rests on stand in the estimate's figures.
class ObserverEstimator final : public Estimator {
 public:
  using Options = ModelBasedOptions;
  /// Throws InvalidInput for options that ModelBasedEstimator refuses.
  explicit ObserverEstimator(const Options& options) : estimator_(options) {}

 private:
  std::shared_ptr<const PreparedEstimator> do_prepare(const EstimationModel& model) const override;
  ModelBasedEstimator estimator_;
};

}  // namespace modcal
