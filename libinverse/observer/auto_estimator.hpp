// Joint or model-based estimate, by what the record says of the second.
#pragma once

#include <memory>

#include "libinverse/observer/model_based_estimator.hpp"

namespace modcal {

/// The joint estimate, which assumes no friction law, and the model-based one, which assumes one of
/// a list, bin by bin in the inverse proportion of their squared errors (observer::combined()): the
/// first is off by its posterior variance v, the second by e, which their difference tells
/// (observer::band_errors()); e v/(e + v) is less than either. Where the observer refuses the
/// record, or no law explains it and the joint estimate is the better one, that is all there is,
/// and a note says so. As one of the estimators it has the side "auto".
class AutoEstimator final : public Estimator {
 public:
  /// Those of the model-based estimate.
  using Options = ModelBasedOptions;
  /// Throws InvalidInput where no friction law or an unknown one is asked for.
  explicit AutoEstimator(const Options& options) : options_(options), observer_(options) {}
  double numbers_per_sample() const override { return 100.0; }
  std::optional<bool> feels_bending() const override { return std::nullopt; }

 private:
  std::shared_ptr<const PreparedEstimator> do_prepare(const EstimationModel& model) const override;

  Options options_;
  ModelBasedEstimator observer_;
};

}  // namespace modcal
