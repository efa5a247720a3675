#include "libinverse/joint/joint_estimators.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libinverse/joint/contour_inversions.hpp"
#include "libinverse/joint/force_prior.hpp"
#include "libsim/base/error.hpp"

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
    return estimate_with(inversion, record, noise, inversions_.method(*prior_, method.outputs),
                         "joint", "from both reactions");
  }

 private:
  ContourInversions inversions_;
  std::shared_ptr<const ForcePrior> prior_;
};

class PreparedLimit final : public PreparedEstimator {
 public:
  PreparedLimit(const EstimationModel& model, const JointOptions& options, double bandwidth)
      : inversions_(model, options), bandwidth_(bandwidth) {}

  std::vector<Estimate> estimate(const EstimationRecord& record,
                                 const InversionMethod& method) const override {
    MODCAL_REQUIRE(record.true_force.size() == inversions_.samples(),
                   "the linear limit needs the true force: it exists for simulated records only");
    SensorNoiseLevel noise;
    noise.measured = true;
    for (std::size_t r = 0; r < 2; ++r) {
      const double stated = record.stated_noise[r];
      if (std::isfinite(stated)) noise.rms[r] = stated;
    }
    const JointInversion& inversion = inversions_.of(record.reactions, noise);
    const std::vector<double> spectrum = true_spectrum(record.true_force, inversion.sigma());
    JointMethod how = inversions_.method(unused_, method.outputs);
    how.known_variance = spectrum;
    return estimate_with(inversion, record, noise, how, "linear_limit",
                         "linear limit (true spectra known)");
  }

 private:
  // |F_k|² of the weighted force over the weights' power, smoothed.
  std::vector<double> true_spectrum(std::span<const double> force, double sigma) const {
    const double rate = inversions_.sample_rate();
    std::vector<double> weighted(force.size());
    double power = 0.0;
    for (std::size_t j = 0; j < force.size(); ++j) {
      const double weight = std::exp(-sigma * static_cast<double>(j) / rate);
      weighted[j] = force[j] * weight;
      power += weight * weight;
    }
    const RealFft fft(force.size());
    const std::vector<Complex> spectrum = fft.forward(weighted);
    std::vector<double> variance(spectrum.size()), scratch(spectrum.size());
    for (std::size_t k = 0; k < variance.size(); ++k) variance[k] = std::norm(spectrum[k]) / power;
    const double bins = bandwidth_ * static_cast<double>(force.size()) / rate;
    smooth_power(variance, scratch, std::max(1.0, 0.25 * bins), 0.0);
    return variance;
  }

  ContourInversions inversions_;
  double bandwidth_;
  FlatPrior unused_{FlatPrior::Options{}};
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

void LinearLimitEstimator::Options::visit(OptionVisitor& visitor) {
  joint.visit(visitor);
  visitor.number({.key = "bandwidth",
                  .meaning = "full width over which the true spectrum is smoothed",
                  .unit = "Hz",
                  .range = Range::positive()},
                 bandwidth);
}

LinearLimitEstimator::LinearLimitEstimator(const Options& options)
    : joint_(options.joint), bandwidth_(options.bandwidth) {
  joint_.require();
  MODCAL_REQUIRE(bandwidth_ > 0.0, "bandwidth {:g} Hz must be > 0", bandwidth_);
}

std::shared_ptr<const PreparedEstimator> LinearLimitEstimator::do_prepare(
    const EstimationModel& model) const {
  return std::make_shared<const PreparedLimit>(model, joint_, bandwidth_);
}

}  // namespace modcal
