#include "libcalib/objectives/smooth_spectral_peak.hpp"

#include <algorithm>
#include <cmath>

#include "libcalib/objectives/spectral_peak_function.hpp"
#include "libcalib/objectives/two_sided_arrays.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

using Pair = std::array<std::vector<Complex>, 2>;

class Function final : public ObjectiveFunction {
 public:
  Function(const CalibrationData& data, const ParameterSet& parameters, double half_band,
           double softening)
      : peak_(data, parameters, half_band) {
    const Pair transfer = sums_of(two_sided_terms(parameters.model(parameters.start())));
    double sum = 0.0, count = 0.0;
    for (std::size_t r = 0; r < 2; ++r) {
      if (peak_.magnitudes()[r].empty()) continue;
      for (std::size_t k = 0; k < bins(); ++k) {
        if (peak_.band_count()[k] == 0.0) continue;
        sum += std::sqrt(force_square(r, k, transfer[r][k]));
        count += 1.0;
      }
    }
    const double delta = softening * sum / count;
    MODCAL_REQUIRE(delta > 0.0 && std::isfinite(delta),
                   "the force identified with the initial parameters vanishes in the bands: "
                   "nothing can be integrated");
    floor_ = delta * delta;
  }
  std::string_view name() const override { return "smooth_spectral_peak"; }
  std::size_t dimension() const override { return peak_.dimension(); }
  std::size_t residual_count() const override { return 2 * bins(); }
  Capabilities capabilities() const override { return {.gradient = true, .least_squares = true}; }

 private:
  std::size_t bins() const { return peak_.covered().size(); }

  double force_square(std::size_t r, std::size_t k, Complex transfer) const {
    const double magnitude = peak_.magnitudes()[r][peak_.covered().first + k];
    return magnitude * magnitude / std::norm(transfer);
  }

  Pair sums_of(const std::vector<TwoSidedTerm>& terms) const {
    TwoSidedArrays storage;
    const TwoSidedSums sums = storage.view(peak_.covered());
    add_up_terms_in_parallel(terms, peak_.grid().spacing, sums);
    Pair result;
    for (std::size_t r = 0; r < 2; ++r) {
      result[r].resize(bins());
      for (std::size_t k = 0; k < bins(); ++k) result[r][k] = {sums.real[r][k], sums.imag[r][k]};
    }
    return result;
  }

  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    const ModelPoint point = peak_.parameters().model(x);
    const std::vector<TwoSidedTerm> terms = two_sided_terms(point);
    const Pair transfer = sums_of(terms);
    std::vector<double> residuals(residual_count(), 0.0);
    // dr/dθ = weight · dH/dθ, real part: −(r/2) |F|²/(|F|² + δ²)/H.
    Pair weights;
    double value = 0.0;
    for (std::size_t r = 0; r < 2; ++r) {
      weights[r].assign(bins(), 0.0);
      if (peak_.magnitudes()[r].empty()) continue;
      for (std::size_t k = 0; k < bins(); ++k) {
        if (peak_.band_count()[k] == 0.0) continue;
        const double square = force_square(r, k, transfer[r][k]);
        double& residual = residuals[r * bins() + k];
        residual = std::sqrt(2.0 * peak_.band_count()[k]) * std::pow(square + floor_, 0.25);
        value += 0.5 * residual * residual;
        weights[r][k] = -0.5 * residual * square / (square + floor_) / transfer[r][k];
      }
    }
    if (outputs.value) *outputs.value = value;
    if (outputs.residuals) std::copy(residuals.begin(), residuals.end(), outputs.residuals);
    if (!outputs.gradient && !outputs.jacobian) return;
    const Pair contact = sums_of(contact_slope_terms(point));
    for (std::size_t i = 0; i < dimension(); ++i) {
      write_slopes(i, transfer_slope(x, i, terms, contact), weights, residuals, outputs);
    }
  }

  Pair transfer_slope(std::span<const double> x, std::size_t i,
                      const std::vector<TwoSidedTerm>& terms, const Pair& contact) const {
    if (peak_.parameters()[i].kind == ParameterKind::kContact) return contact;
    Pair slope;
    for (auto& values : slope) values.assign(bins(), 0.0);
    for (const auto& [mode, omega_slope] : peak_.parameters().frequency_slopes(x, i)) {
      const TwoSidedTerm& term = terms[mode];
      for (std::size_t k = 0; k < bins(); ++k) {
        const double omega = peak_.grid().omega(peak_.covered().first + k);
        const Complex change = omega_slope * term.inverse_slope(omega);
        for (std::size_t r = 0; r < 2; ++r) slope[r][k] += term.residue[r] * change;
      }
    }
    return slope;
  }

  void write_slopes(std::size_t i, const Pair& slope, const Pair& weights,
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

  SpectralPeakFunction peak_;
  double floor_ = 0.0;  // δ²
};

}  // namespace

void SmoothSpectralPeak::Options::visit(OptionVisitor& visitor) {
  visitor.number({.key = "half_band",
                  .meaning = "how far the band reaches to either side, relative to f_n",
                  .unit = "1",
                  .range = Range::open(0.0, 1.0)},
                 half_band);
  visitor.number({.key = "softening",
                  .meaning = "magnitude below which the force is rounded off, relative to its mean",
                  .unit = "1",
                  .range = Range::positive()},
                 softening);
}

SmoothSpectralPeak::SmoothSpectralPeak(const Options& options) : options_(options) {
  MODCAL_REQUIRE(options.half_band > 0.0 && options.half_band < 1.0,
                 "half band {:g} must lie in (0, 1)", options.half_band);
  MODCAL_REQUIRE(options.softening > 0.0, "softening {:g} must be > 0: spectral_peak is the limit",
                 options.softening);
}

std::unique_ptr<const ObjectiveFunction> SmoothSpectralPeak::do_bind(
    const CalibrationData& data, const ParameterSet& parameters) const {
  return std::make_unique<Function>(data, parameters, options_.half_band, options_.softening);
}

}  // namespace modcal
