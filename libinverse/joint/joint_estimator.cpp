#include "libinverse/joint/joint_estimator.hpp"

#include <utility>

#include "libinverse/joint/contour_inversions.hpp"

namespace modcal {
namespace {

class PreparedJoint final : public PreparedEstimator {
 public:
  PreparedJoint(const EstimationModel& model, const JointOptions& options,
                std::shared_ptr<const ForcePrior> prior)
      : inversions_(model, options), prior_(std::move(prior)) {}

  std::vector<Estimate> estimate(const EstimationRecord& record,
                                 const InversionMethod& method) const override {
    const SensorNoiseLevel noise = inversions_.noise_of(record);
    const JointInversion& inversion = inversions_.of(record.reactions, noise);
    JointWorkspace workspace;
    JointResult result;
    inversion.invert(record.reactions, noise, inversions_.method(*prior_, method.outputs),
                     workspace, result);
    std::vector<Estimate> estimates;
    estimates.push_back(estimate_of(std::move(result), inversion, noise, record));
    estimates[0].side = "joint";
    estimates[0].label = "from both reactions";
    return estimates;
  }

 private:
  ContourInversions inversions_;
  std::shared_ptr<const ForcePrior> prior_;
};

}  // namespace

void JointEstimator::Options::visit(OptionVisitor& visitor) {
  joint.visit(visitor);
  visitor.plugin({.key = "prior", .meaning = "what is supposed about the spectrum of the force"},
                 prior);
}

JointEstimator::JointEstimator(const Options& options)
    : joint_(options.joint), prior_(options.prior.make()) {
  joint_.require();
}

std::shared_ptr<const PreparedEstimator> JointEstimator::do_prepare(
    const EstimationModel& model) const {
  return std::make_shared<const PreparedJoint>(model, joint_, prior_);
}

}  // namespace modcal
