// Joint inversions of one model, one for each contour that records have asked for.
#pragma once

#include <map>
#include <memory>
#include <mutex>

#include "libinverse/estimator.hpp"
#include "libinverse/joint/joint_options.hpp"

namespace modcal {

/// Prepares an inversion when a record asks for its contour; safe to use from several threads.
class ContourInversions {
 public:
  ContourInversions(const EstimationModel& model, const JointOptions& options);

  /// Noise levels of a record: as stated in the options, else measured. Throws InvalidInput where
  /// the record does not fit the model or holds what is not finite.
  SensorNoiseLevel noise_of(const EstimationRecord& record) const;
  /// The inversion on the contour that suits the record, see contour_of.
  const JointInversion& of(const ReactionPair& reactions, const SensorNoiseLevel& noise) const;
  JointMethod method(const ForcePrior& prior, const InversionOutputs& outputs) const;

  double sample_rate() const { return sample_rate_; }
  std::size_t samples() const { return samples_; }

 private:
  double sigma_for(const ReactionPair& reactions, const SensorNoiseLevel& noise) const;

  ModalBasis basis_;
  double contact_;
  std::size_t samples_;
  double sample_rate_;
  JointOptions options_;
  Truncation truncation_;
  StringSupport support_;
  SensorNoise noise_;
  mutable std::mutex mutex_;
  mutable std::map<double, std::unique_ptr<const JointInversion>> by_sigma_;
};

/// A result with its figures and warnings; `side` and `label` are left empty.
Estimate estimate_of(JointResult result, const JointInversion& inversion,
                     const SensorNoiseLevel& noise, const EstimationRecord& record);

}  // namespace modcal
