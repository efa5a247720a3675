// The spectral-peak integral bound to data.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "libcalib/problem/calibration_data.hpp"
#include "libcalib/problem/objective_function.hpp"
#include "libcalib/objectives/two_sided_terms.hpp"
#include "libcalib/parameters/parameters.hpp"

namespace modcal {

class SpectralPeakFunction final : public ObjectiveFunction {
 public:
  SpectralPeakFunction(const CalibrationData& data, const ParameterSet& parameters,
                       double half_band);
  std::string_view name() const override { return "spectral_peak"; }
  std::size_t dimension() const override { return parameters_.size(); }
  Capabilities capabilities() const override { return {.gradient = true}; }
  std::unique_ptr<CoordinateScanner> scanner(std::span<const double> x) const override;

  const ParameterSet& parameters() const { return parameters_; }
  const FrequencyGrid& grid() const { return grid_; }
  double half_band() const { return half_band_; }
  /// Bins within ω (1 ± half_band) [rad/s].
  BinRange band_about(double omega) const;
  /// |R_r| Δω/f_s of all bins; empty where the reaction is missing. Index: End.
  const std::array<std::vector<double>, 2>& magnitudes() const { return magnitudes_; }
  /// Bins from the lowest to the highest band of the value, and how many bands hold each.
  BinRange covered() const { return covered_; }
  const std::vector<double>& band_count() const { return count_; }

 private:
  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override;
  void fill_gradient(std::span<const double> x, const ModelPoint& point,
                     const std::array<std::vector<Complex>, 2>& weights, double* gradient) const;

  ParameterSet parameters_;
  FrequencyGrid grid_;
  double half_band_;
  std::array<std::vector<double>, 2> magnitudes_;
  BinRange covered_;           // from the lowest to the highest band of the value
  std::vector<double> count_;  // per bin of covered_: how many bands hold it
};

}  // namespace modcal
