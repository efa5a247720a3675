// The regularizers.
#pragma once

#include <cstdint>

#include "libinverse/regularizer.hpp"
#include "libinverse/spectral/problem/spectral_system.hpp"

namespace modcal {

/// Of a regularizer that has none of its own.
struct NoRegularizerOptions {
  void visit(OptionVisitor& /*visitor*/) {}
};

/// Filter factors 0 or 1, as `kKeeps(σ, λ)` says; lost = 1 − φ.
template <bool (*kKeeps)(double sigma, double parameter)>
class StepFilter : public Regularizer {
 public:
  using Options = NoRegularizerOptions;

 private:
  void do_filter_factors(std::span<const double> sigma, double parameter, std::span<double> kept,
                         std::span<double> lost) const final {
    for (std::size_t i = 0; i < sigma.size(); ++i)
      kept[i] = kKeeps(sigma[i], parameter) ? 1.0 : 0.0;
    for (std::size_t i = 0; i < lost.size(); ++i) lost[i] = 1.0 - kept[i];
  }
};

inline bool keeps_all(double sigma, double /*parameter*/) { return sigma > 0.0; }
inline bool keeps_from(double sigma, double parameter) { return sigma > 0.0 && sigma >= parameter; }
inline bool keeps_above(double sigma, double parameter) { return sigma > parameter; }

/// Direct inversion, φ = 1 wherever σ > 0 (Debut, Delaune and Antunes, 2010, eq. 10).
class NoRegularization final : public StepFilter<keeps_all> {
 public:
  explicit NoRegularization(const Options& /*options*/) {}
  bool has_parameter() const override { return false; }
};

/// Truncated singular value decomposition: φ = 1 where σ ≥ λ, else 0 (Hansen, 1998, section 5.3).
/// The parameter is the smallest singular value kept; in a diagonal Fourier problem a water level
/// that keeps the bin at the level.
class TruncatedSvd final : public StepFilter<keeps_from> {
 public:
  explicit TruncatedSvd(const Options& /*options*/) {}
};

/// Water level that zeroes: F = R/H where |H| > ε, 0 elsewhere, that is φ = 1 where σ > ε, else 0
/// (Debut, Delaune and Antunes, 2010, eq. 15). The parameter is ε, in the unit of H [N/N].
class WaterLevel final : public StepFilter<keeps_above> {
 public:
  explicit WaterLevel(const Options& /*options*/) {}

 private:
  /// Cumulative sums over the sorted components: one pass for all parameters.
  void do_trace_squares(const SpectralSystem& system, std::span<const double> parameters,
                        std::span<CurvePoint> curve) const override;
};

/// Water level that clips: |H| is raised to ε where it lies below and keeps its phase, that is
/// φ = min(1, σ/ε) (Clayton and Wiggins, 1976, as seismology uses the term since). The parameter is
/// ε, in the unit of H [N/N]. Where H = 0 there is no phase to keep: φ = 0.
class WaterLevelClip final : public Regularizer {
 public:
  using Options = NoRegularizerOptions;
  explicit WaterLevelClip(const Options& /*options*/) {}

 private:
  void do_filter_factors(std::span<const double> sigma, double parameter, std::span<double> kept,
                         std::span<double> lost) const override;
  /// Cumulative sums over the sorted components: one pass for all parameters.
  void do_trace_squares(const SpectralSystem& system, std::span<const double> parameters,
                        std::span<CurvePoint> curve) const override;
};

/// φ = σ²/(σ² + λ²) without cancellation, σ over a penalty of the frequency; lost = 1 − φ.
class QuadraticFilter : public Regularizer {
 private:
  void do_filter_factors(std::span<const double> sigma, double parameter, std::span<double> kept,
                         std::span<double> lost) const final;
  /// One pass over a compacted problem per parameter.
  void do_trace_squares(const SpectralSystem& system, std::span<const double> parameters,
                        std::span<CurvePoint> curve) const final;
};

/// Tikhonov regularization of order p: minimum of ‖b − A x‖² + λ² ‖D^p x‖², φ = σ²/(σ² + λ²
/// (ω/ω̄)^2p) (Hansen, 1998, section 5.1), ω̄ the rms angular frequency of the problem. The parameter
/// is λ, in the unit of the singular values [N/N].
class Tikhonov final : public QuadraticFilter {
 public:
  struct Options {
    std::int64_t order = 0;  ///< p: 0, 1 or 2
    void visit(OptionVisitor& visitor);
  };
  /// Throws InvalidInput for another order.
  explicit Tikhonov(const Options& options);
  bool has_penalty() const override { return order_ > 0; }
  double penalty(double omega, double reference) const override;

 private:
  std::int64_t order_;
};

/// Wiener filter for white noise and a force that jumps, φ = |H|² P/(|H|² P + λ²) with
/// P = 1/(1 + (ω/ω_c)²) (Wiener, 1949): λ² is the variance of the noise over that of the force
/// below the corner ω_c. The parameter is λ, in the unit of the singular values [N/N].
class WienerFilter final : public QuadraticFilter {
 public:
  struct Options {
    double corner = 50.0;  ///< ω_c/2π [Hz]
    void visit(OptionVisitor& visitor);
  };
  /// Throws InvalidInput for a corner that is not > 0.
  explicit WienerFilter(const Options& options);
  bool has_penalty() const override { return true; }
  double penalty(double omega, double reference) const override;

 private:
  double corner_;  // [rad/s]
};

}  // namespace modcal
