#include "libcalib/objectives/smooth_spectral_peak.hpp"

#include <algorithm>
#include <cmath>

#include "libcalib/objectives/peak_bands.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

class SmoothPeakFunction final : public ObjectiveFunction {
 public:
  SmoothPeakFunction(PeakBands bands, double softening) : bands_(std::move(bands)) {
    const ForceKernel::State state = bands_.force(bands_.parameters().start());
    double sum = 0.0, count = 0.0;
    for_each_bin([&](std::size_t r, std::size_t k) {
      sum += std::sqrt(force_square(state, r, k));
      count += 1.0;
    });
    const double delta = softening * sum / count;
    MODCAL_REQUIRE(delta > 0.0 && std::isfinite(delta),
                   "the force identified with the initial parameters vanishes in the bands: "
                   "nothing can be integrated");
    floor_ = delta * delta;
  }
  std::string_view name() const override { return "smooth_spectral_peak"; }
  std::size_t dimension() const override { return bands_.parameters().size(); }
  std::size_t residual_count() const override { return 2 * bins(); }
  Capabilities capabilities() const override { return {.gradient = true, .least_squares = true}; }

 private:
  std::size_t bins() const { return bands_.count().size(); }

  // Bins of a band, of the reactions that are there.
  template <class Visit>
  void for_each_bin(const Visit& visit) const {
    for (std::size_t r = 0; r < 2; ++r) {
      for (std::size_t k = 0; bands_.has(r) && k < bins(); ++k) {
        if (bands_.count()[k] != 0.0) visit(r, k);
      }
    }
  }

  double force_square(const ForceKernel::State& state, std::size_t r, std::size_t k) const {
    return bands_.scale() * bands_.scale() * std::norm(state.force[r][k]);
  }

  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    const ForceKernel::State state = bands_.force(x);
    std::vector<double> residuals(residual_count(), 0.0);
    // dr/dθ = weight · dH/dθ, real part: −(r/2) |F|²/(|F|² + δ²)/H.
    SensorSpectra weights(2, std::vector<Complex>(bins(), 0.0));
    double value = 0.0;
    for_each_bin([&](std::size_t r, std::size_t k) {
      const double square = force_square(state, r, k);
      double& residual = residuals[r * bins() + k];
      residual = std::sqrt(2.0 * bands_.count()[k]) * std::pow(square + floor_, 0.25);
      value += 0.5 * residual * residual;
      weights[r][k] = -0.5 * residual * square / (square + floor_) * state.inverse[r][k];
    });
    if (outputs.value) *outputs.value = value;
    if (outputs.residuals) std::copy(residuals.begin(), residuals.end(), outputs.residuals);
    if (!outputs.gradient && !outputs.jacobian) return;
    const ModelSlopes slopes = bands_.slopes(x);
    SensorSpectra slope;
    for (std::size_t i = 0; i < dimension(); ++i) {
      slopes.write(i, slope);
      write_slopes(i, slope, weights, residuals, outputs);
    }
  }

  void write_slopes(std::size_t i, const SensorSpectra& slope, const SensorSpectra& weights,
                    const std::vector<double>& residuals, const ObjectiveOutputs& outputs) const {
    double gradient = 0.0;
    for (std::size_t r = 0; r < 2; ++r) {
      for (std::size_t k = 0; k < bins(); ++k) {
        const std::size_t j = r * bins() + k;
        const double change = (weights[r][k] * slope[r][k]).real();
        gradient += residuals[j] * change;
        if (outputs.jacobian) outputs.jacobian[j * dimension() + i] = change;
      }
    }
    if (outputs.gradient) outputs.gradient[i] = gradient;
  }

  PeakBands bands_;
  double floor_ = 0.0;  // δ²
};

}  // namespace

void SmoothSpectralPeak::Options::visit(OptionVisitor& visitor) {
  visitor("half_band", "how far the band reaches to either side, relative to f_n",
          {.range = Range::open(0.0, 1.0)}, half_band);
  visitor("softening", "magnitude below which the force is rounded off, relative to its mean",
          {.range = Range::positive()}, softening);
}

SmoothSpectralPeak::SmoothSpectralPeak(const Options& options) : options_(options) {
  MODCAL_REQUIRE(options.half_band > 0.0 && options.half_band < 1.0,
                 "half band {:g} must lie in (0, 1)", options.half_band);
  MODCAL_REQUIRE(options.softening > 0.0, "softening {:g} must be > 0: spectral_peak is the limit",
                 options.softening);
}

std::unique_ptr<const ObjectiveFunction> SmoothSpectralPeak::do_bind(
    const CalibrationData& data, const ParameterSet& parameters) const {
  return std::make_unique<SmoothPeakFunction>(PeakBands(data, parameters, options_.half_band),
                                              options_.softening);
}

}  // namespace modcal
