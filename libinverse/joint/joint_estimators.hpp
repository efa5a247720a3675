// Estimators of one force from both reactions.
#pragma once

#include <memory>

#include "libinverse/estimator.hpp"
#include "libinverse/joint/joint_options.hpp"

namespace modcal {

/// One inversion as an estimate, with its figures and warnings; side and label as in Estimate.
std::vector<Estimate> estimate_with(const JointInversion& inversion, const EstimationRecord& record,
                                    const SensorNoiseLevel& noise, const JointMethod& method,
                                    const char* side, const char* label);

/// One force from both reactions (JointInversion); from one where the record has but one.
class JointEstimator final : public Estimator {
 public:
  struct Options {
    JointOptions joint = {};
    Choice<ForcePrior> prior{"learned"};
    void visit(OptionVisitor& visitor);
  };
  /// Throws InvalidInput for options out of range.
  explicit JointEstimator(const Options& options);
  SensorPair sensors() const override { return joint_.sensors; }
  std::optional<bool> feels_bending() const override { return joint_.transfer.bending(); }

 private:
  std::shared_ptr<const PreparedEstimator> do_prepare(const EstimationModel& model) const override;
  JointOptions joint_;
  std::shared_ptr<const ForcePrior> prior_;
};

/// The linear limit: the joint estimate with the true spectrum of the force for a prior and the
/// true noise levels, an oracle. No linear estimate that knows spectra alone does better on average
/// (Wiener, 1949). For simulated records.
class LinearLimitEstimator final : public Estimator {
 public:
  struct Options {
    JointOptions joint = {};
    double bandwidth = 20.0;  ///< over which the true spectrum is smoothed [Hz]
    void visit(OptionVisitor& visitor);
  };
  /// Throws InvalidInput for options out of range.
  explicit LinearLimitEstimator(const Options& options);
  SensorPair sensors() const override { return joint_.sensors; }
  std::optional<bool> feels_bending() const override { return joint_.transfer.bending(); }

 private:
  std::shared_ptr<const PreparedEstimator> do_prepare(const EstimationModel& model) const override;
  JointOptions joint_;
  double bandwidth_;
};

}  // namespace modcal
