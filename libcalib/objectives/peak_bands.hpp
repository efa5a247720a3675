// The bands that spectral-peak integrals look at, with the force that a model identifies there.
#pragma once

#include <array>
#include <vector>

#include "libcalib/objectives/model_slopes.hpp"
#include "libcalib/parameters/parameters.hpp"
#include "libcalib/problem/calibration_data.hpp"

namespace modcal {

class PeakBands {
 public:
  /// Bands ω_n (1 ± half_band) about the initial frequencies of the modes whose frequency is free,
  /// of all modes where none is. Throws InvalidInput where a band holds no bin.
  PeakBands(const CalibrationData& data, const ParameterSet& parameters, double half_band);

  const ParameterSet& parameters() const { return parameters_; }
  const FrequencyGrid& grid() const { return kernel_.record().grid; }
  double half_band() const { return half_band_; }
  /// Bins within ω (1 ± half_band) [rad/s].
  BinRange band_about(double omega) const;
  /// |R_r| Δω/f_s of all bins; empty where the reaction is missing. Index: End.
  const std::array<std::vector<double>, 2>& magnitudes() const { return magnitudes_; }
  /// Of the bins from the lowest to the highest band: how many bands hold each.
  const std::vector<double>& count() const { return count_; }
  bool has(std::size_t sensor) const { return !magnitudes_[sensor].empty(); }

  /// Forces of the model at x over these bins; |F_r| scale() is the integrand.
  ForceKernel::State force(std::span<const double> x) const {
    return kernel_.at(end_reactions(parameters_.model(x)), false);
  }
  double scale() const { return scale_; }
  ModelSlopes slopes(std::span<const double> x) const {
    return ModelSlopes(parameters_, x, kernel_.record());
  }

 private:
  ParameterSet parameters_;
  double half_band_;
  double scale_;  // Δω/f_s
  std::array<std::vector<double>, 2> magnitudes_;
  std::vector<double> count_;
  ForceKernel kernel_;
};

}  // namespace modcal
