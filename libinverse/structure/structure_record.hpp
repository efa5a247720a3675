// Records of a structure at K sensors, and their spectra on a shifted contour.
#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "libsim/model/modal_model.hpp"

namespace modcal {

/// What the sensors read, each in the unit of its kind (m, m/s, m/s², N, 1), and the force where it
/// was measured.
struct StructureRecord {
  double sample_rate = 0.0;                    ///< [Hz]
  std::vector<double> force;                   ///< [N]; empty: not measured
  std::vector<std::vector<double>> responses;  ///< K, as long as the force

  std::size_t samples() const { return responses.empty() ? 0 : responses.front().size(); }
  double duration() const { return static_cast<double>(samples()) / sample_rate; }
};

/// Spectra of x(t) exp(−σt) in a band: X_m = Σ_j x_j exp(−s_m t_j), s_m = σ + iω_m. What a
/// structure at rest at t = 0 reads is H(s_m) F_m but for what rings on past the record's end,
/// damped by exp(−σT).
struct ContourSpectra {
  FrequencyGrid grid;
  BinRange bins;
  double sample_rate = 0.0;
  std::size_t samples = 0;
  std::vector<Complex> force;                   ///< empty: not measured
  std::vector<std::vector<Complex>> responses;  ///< K

  /// low, high: band [Hz]; σ ≥ 0 [1/s]. Throws InvalidInput for signals of different lengths, a
  /// sample that is not finite and a band that holds no bin.
  static ContourSpectra of(const StructureRecord& record, double sigma, double low, double high);

  std::size_t count() const { return bins.size(); }
  Complex s(std::size_t m) const { return grid.s(bins.first + m); }
  double duration() const { return static_cast<double>(samples) / sample_rate; }
  /// Bins of a contour tell alike: of κ neighbors one counts, κ = σT or 1.
  double correlated() const { return std::max(1.0, grid.sigma * duration()); }
  /// Σ_j exp(−2σt_j): the variance that white noise of variance 1 has in a bin.
  double noise_power() const;
};

/// How white noise correlates the bins of a contour, which tell alike: C_mm' = Σ_j exp(−2σt_j)
/// exp(−i(ω_m − ω_m')t_j) / Σ_j exp(−2σt_j).
class BinCorrelation {
 public:
  explicit BinCorrelation(const ContourSpectra& spectra);
  /// C x in the place of x, a number a bin.
  void multiply(std::span<Complex> bins) const;

 private:
  std::size_t first_;
  std::vector<double> weights_;
};

/// What stands over D(s) in the H of one mode: s^p (Re A + Im A q(s)) (ModalModel).
Complex numerator_of(SensorKind kind, const ModalPole& pole, Complex constant, Complex s);

/// Means over the bins within `reach` [Hz] of each.
std::vector<double> smoothed(std::span<const double> values, double spacing_hz, double reach);

}  // namespace modcal
