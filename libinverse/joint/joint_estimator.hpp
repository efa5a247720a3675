#pragma once

#include <memory>

#include "libinverse/estimator.hpp"
#include "libinverse/joint/joint_options.hpp"

namespace modcal {

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
  SensorOptions sensors() const override { return joint_.sensors; }

 private:
  std::shared_ptr<const PreparedEstimator> do_prepare(const EstimationModel& model) const override;
  JointOptions joint_;
  std::shared_ptr<const ForcePrior> prior_;
};

}  // namespace modcal
