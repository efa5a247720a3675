#include "libinverse/joint/linear_limit_estimator.hpp"

#include <algorithm>
#include <cmath>

#include "libinverse/joint/contour_inversions.hpp"
#include "libinverse/joint/priors.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

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
    JointWorkspace workspace;
    JointResult result;
    inversion.invert(record.reactions, noise, how, workspace, result);
    std::vector<Estimate> estimates;
    estimates.push_back(estimate_of(std::move(result), inversion, noise, record));
    estimates[0].side = "linear_limit";
    estimates[0].label = "linear limit (true spectra known)";
    return estimates;
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
