// What all estimators on both reactions have to be told.
#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "libinverse/estimator.hpp"
#include "libinverse/joint/joint_inversion.hpp"

namespace modcal {

/// Section "inversion" of an estimator on both reactions.
struct JointOptions {
  std::string truncation = "shifted_contour";
  double sigma = std::numeric_limits<double>::quiet_NaN();  ///< [1/s]; NaN: see contour_of
  std::string offset = "arrival";
  /// Standard deviations of the noise of one sample [N]; NaN: from the record.
  double noise_rms[2] = {std::numeric_limits<double>::quiet_NaN(),
                         std::numeric_limits<double>::quiet_NaN()};
  double band_limit = std::numeric_limits<double>::quiet_NaN();  ///< [Hz]; NaN: none
  bool limit_to_top_mode = false;
  std::int64_t points = 100;
  TransferOptions transfer = {};
  SensorOptions sensors = {};

  void visit(OptionVisitor& visitor);
  /// Throws InvalidInput for options out of range.
  void require() const;
};

/// Throws InvalidInput for an unknown name.
Truncation truncation_of(const std::string& name);

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

/// One inversion as an estimate, with its figures and warnings.
std::vector<Estimate> estimate_with(const JointInversion& inversion, const EstimationRecord& record,
                                    const SensorNoiseLevel& noise, const JointMethod& method,
                                    const char* side, const char* label);

}  // namespace modcal
