// The modal model of any structure: transfer functions from contacts to sensors.
#pragma once

#include <initializer_list>

#include "libsim/signal/fft.hpp"

namespace modcal {

/// Bins of a record's half spectrum: s_k = σ + i 2π k f_s/K, k = 0 … K/2.
struct FrequencyGrid {
  double spacing = 0.0;  ///< angular frequency step 2π f_s/K [rad/s]
  std::size_t bins = 0;  ///< K/2 + 1
  double sigma = 0.0;    ///< real part of s [1/s]; 0 on the frequency axis

  static FrequencyGrid of_record(std::size_t samples, double sample_rate);
  double omega(std::size_t k) const { return spacing * static_cast<double>(k); }
  Complex s(std::size_t k) const { return {sigma, omega(k)}; }
};

/// Bins k of a half spectrum, first ≤ k < last.
struct BinRange {
  std::size_t first = 0;
  std::size_t last = 0;

  std::size_t size() const { return last - first; }
  bool operator==(const BinRange&) const = default;
};

/// Bins k ≥ 1 of the grid with low ≤ ω_k ≤ high [rad/s]; may be empty.
BinRange bins_between(const FrequencyGrid& grid, double low, double high);

/// A pair of poles: D(s) = s² + 2 ζ_n ω_n s + ω_n².
struct ModalPole {
  double omega = 0.0;  ///< ω_n [rad/s]
  double zeta = 0.0;   ///< ζ_n [1]

  /// D(s); ω_n² − ω² as a product, so that nothing cancels at the resonance but ω_n − ω itself.
  Complex denominator(Complex s) const {
    const double at = s.imag(), sigma = s.real(), loss = 2.0 * zeta * omega;
    return {(omega - at) * (omega + at) + sigma * (sigma + loss), loss * at + 2.0 * sigma * at};
  }
  /// d(1/D)/dω_n and d(1/D)/dζ_n at s.
  Complex slope_by_omega(Complex s) const {
    const Complex d = denominator(s);
    return -(2.0 * omega + 2.0 * zeta * s) / (d * d);
  }
  Complex slope_by_zeta(Complex s) const {
    const Complex d = denominator(s);
    return -2.0 * omega * s / (d * d);
  }
};

/// What a sensor reads.
enum class SensorKind { kDisplacement, kVelocity, kAcceleration, kForce, kStrain };

/// The power p of s that stands before the sums of ModalModel: 1 for a velocity, 2 for an
/// acceleration, else 0.
int power_of_s(SensorKind kind);

/// Response of what lies above the modes (constant, c_2) and below them (c_−2).
struct ResidualTerms {
  double below = 0.0;     ///< c_−2
  double constant = 0.0;  ///< c_0
  double above = 0.0;     ///< c_2

  Complex at(Complex s) const;
  bool operator==(const ResidualTerms&) const = default;
};

/// Real and imaginary parts of several spectra over consecutive bins, each part in one row.
class SplitSpectra {
 public:
  /// Rows are padded to whole vectors of any width; the storage is kept from call to call.
  void resize(std::size_t spectra, std::size_t bins);
  std::size_t bins() const { return bins_; }
  double* real(std::size_t i) { return values_.data() + 2 * i * stride_; }
  double* imag(std::size_t i) { return values_.data() + (2 * i + 1) * stride_; }
  const double* real(std::size_t i) const { return values_.data() + 2 * i * stride_; }
  const double* imag(std::size_t i) const { return values_.data() + (2 * i + 1) * stride_; }
  Complex at(std::size_t i, std::size_t k) const { return {real(i)[k], imag(i)[k]}; }
  std::vector<Complex> joined(std::size_t i) const;

 private:
  std::size_t bins_ = 0, stride_ = 0;
  std::vector<double> values_;
};

struct ModalModel;

/// The sums of a model, ready for any part of a grid: a row of numerators for every pair and one
/// more for Im A_n where it is there, without the modes that no contact drives (undamped, they
/// would be 0/0 on a bin). The model must outlive it.
class ModalSums {
 public:
  explicit ModalSums(const ModalModel& model);
  /// Rows that `out` of evaluate() must have.
  std::size_t rows() const { return rows_.size(); }
  /// H of all pairs at the bins of `part`, written from place `begin` on.
  void evaluate(const FrequencyGrid& grid, const BinRange& part, std::size_t begin,
                SplitSpectra& out) const;

 private:
  const ModalModel& model_;
  std::vector<ModalPole> poles_;
  std::vector<std::vector<double>> rows_;
};

/// Transfer functions from P contacts to K sensors, one pair (sensor k, contact p) after the other
/// at index k P + p:
///   H(s) = s^p [Σ_n (Re A_n + Im A_n q_n(s))/D_n(s) + c_−2 s^−2 + c_0 + c_2 s²],
/// q_n = s/ω_n for p = 0, else −ω_n/s: at the resonance s = iω_n the numerator is the modal
/// constant A_n, whose imaginary part is 0 where damping is proportional, as it is for a string.
/// Units: those of A_n [sensor's unit/(N s²)]; σ ≥ 0. Where s = 0, H is 0 for p > 0.
struct ModalModel {
  std::vector<ModalPole> poles;          ///< N
  std::vector<SensorKind> sensors;       ///< K
  std::size_t contacts = 1;              ///< P
  std::vector<double> constants;         ///< Re A_n, N of every pair in turn
  std::vector<double> quadrature;        ///< Im A_n likewise; empty: real, at no cost
  std::vector<ResidualTerms> residuals;  ///< one a pair; empty: none

  std::size_t pairs() const { return sensors.size() * contacts; }
  double constant(std::size_t pair, std::size_t n) const {
    return constants[pair * poles.size() + n];
  }

  /// The model of some of the sensors, in the order given.
  ModalModel with_sensors(const std::vector<std::size_t>& chosen) const;

  /// H of all pairs over some bins of the grid.
  void evaluate(const FrequencyGrid& grid, const BinRange& bins, SplitSpectra& out) const;
  /// The same in blocks of bins on all cores; the same bits for any number of them.
  void evaluate_in_parallel(const FrequencyGrid& grid, const BinRange& bins,
                            SplitSpectra& out) const;
  /// H of every pair at all bins.
  std::vector<std::vector<Complex>> transfer(const FrequencyGrid& grid) const;

  /// Slopes of all pairs' H at s along a change of the n-th pole; `slopes`: one a pair. H is linear
  /// in its constants: its slope along a change of them is the H of a model that has the change for
  /// constants.
  void pole_slopes(std::size_t n, Complex s, double d_omega, double d_zeta,
                   std::span<Complex> slopes) const;
};

}  // namespace modcal
