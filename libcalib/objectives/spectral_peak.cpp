#include "libcalib/objectives/spectral_peak.hpp"

#include <cmath>
#include <numbers>

#include "libcalib/objectives/peak_bands.hpp"
#include "libinverse/spectral/one_sided/mode_scan.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

class PeakFunction final : public ObjectiveFunction {
 public:
  explicit PeakFunction(PeakBands bands) : bands_(std::move(bands)) {}
  std::string_view name() const override { return "spectral_peak"; }
  std::size_t dimension() const override { return bands_.parameters().size(); }
  Capabilities capabilities() const override { return {.gradient = true}; }
  std::unique_ptr<CoordinateScanner> scanner(std::span<const double> x) const override;
  const PeakBands& bands() const { return bands_; }

 private:
  // With F = R/H, ∂|F|/∂θ = −Re(|F|/H ∂H/∂θ): the weights are |F|/H times the number of bands.
  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    const ForceKernel::State state = bands_.force(x);
    SensorSpectra weights(2);
    double value = 0.0;
    for (std::size_t r = 0; r < 2; ++r) {
      if (!bands_.has(r)) continue;
      if (outputs.gradient) weights[r].resize(bands_.count().size());
      for (std::size_t k = 0; k < bands_.count().size(); ++k) {
        if (bands_.count()[k] == 0.0) continue;
        const double magnitude = std::sqrt(std::norm(state.force[r][k]));
        const double force = bands_.count()[k] * bands_.scale() * magnitude;
        value += force;
        if (outputs.gradient) weights[r][k] = -force * state.inverse[r][k];
      }
    }
    if (outputs.value) *outputs.value = value;
    if (!outputs.gradient) return;
    const ModelSlopes slopes = bands_.slopes(x);
    for (std::size_t i = 0; i < dimension(); ++i) outputs.gradient[i] = slopes.gather(i, weights);
  }

  PeakBands bands_;
};

// Scans of f_n change one term of H_r; other parameters are scanned by evaluations of the whole
// objective.
//
// Of the frequencies, those within twice the half band h of f_n reach it: a resonance farther away
// that shifts by a share s of its frequency changes its term by s/h at most in the bins of f_n.
class Scanner final : public EvaluatingScanner {
 public:
  Scanner(const PeakFunction& function, std::span<const double> x)
      : EvaluatingScanner(function, x), bands_(function.bands()) {
    refresh();
  }

  void scan(std::size_t i, std::span<const double> candidates, std::span<double> values) override {
    const Parameter& parameter = bands_.parameters()[i];
    if (parameter.kind != ParameterKind::kFrequency) {
      EvaluatingScanner::scan(i, candidates, values);
      return;
    }
    omegas_.assign(candidates.begin(), candidates.end());
    for (double& omega : omegas_) omega *= 2.0 * std::numbers::pi;
    scan_.integrate(model_, parameter.index, bands_.grid(),
                    bands_.band_about(model_.poles[parameter.index].omega), bands_.magnitudes(),
                    omegas_, values);
  }

  void move(std::size_t i, double value) override {
    EvaluatingScanner::move(i, value);
    const Parameter& parameter = bands_.parameters()[i];
    if (parameter.kind == ParameterKind::kFrequency) {
      model_.poles[parameter.index].omega = 2.0 * std::numbers::pi * value;
    } else {
      refresh();
    }
  }

  bool reaches(std::size_t j, std::size_t i) const override {
    const Parameter& from = bands_.parameters()[j];
    const Parameter& to = bands_.parameters()[i];
    if (from.kind != ParameterKind::kFrequency || to.kind != ParameterKind::kFrequency) return true;
    const double center = model_.poles[to.index].omega;
    return std::abs(model_.poles[from.index].omega - center) <= 2.0 * bands_.half_band() * center;
  }

  void refresh() override { model_ = end_reactions(bands_.parameters().model(point())); }

 private:
  const PeakBands& bands_;
  ModalModel model_;
  ModeScan scan_;
  std::vector<double> omegas_;
};

std::unique_ptr<CoordinateScanner> PeakFunction::scanner(std::span<const double> x) const {
  return std::make_unique<Scanner>(*this, x);
}

}  // namespace

void SpectralPeak::Options::visit(OptionVisitor& visitor) {
  visitor("half_band", "how far the band reaches to either side, relative to f_n",
          {.range = Range::open(0.0, 1.0)}, half_band);
}

SpectralPeak::SpectralPeak(const Options& options) : options_(options) {
  MODCAL_REQUIRE(options.half_band > 0.0 && options.half_band < 1.0,
                 "half band {:g} must lie in (0, 1)", options.half_band);
}

std::unique_ptr<const ObjectiveFunction> SpectralPeak::do_bind(
    const CalibrationData& data, const ParameterSet& parameters) const {
  return std::make_unique<PeakFunction>(PeakBands(data, parameters, options_.half_band));
}

}  // namespace modcal
