// Regularizers: filter factors between the data and the unregularized solution.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "libinverse/estimate.hpp"
#include "libsim/base/registry.hpp"

namespace modcal {

class SpectralOperator;
struct SpectralSystem;

/// Regularized solution x = Σ_i φ(σ_i; λ) (u_iᵀb/σ_i) v_i with filter factors φ in [0, 1] that rise
/// with σ and fall with the parameter λ > 0 (Hansen, 1998, section 4.2).
class Regularizer {
 public:
  static constexpr std::string_view kKind = "regularizer";
  static Registry<Regularizer> registry();

  virtual ~Regularizer() = default;
  /// False where there is nothing to choose: the filter factors do not depend on the parameter.
  virtual bool has_parameter() const { return true; }

  /// Relative size p(ω) > 0 of the solution's penalty at angular frequency ω [rad/s]: filter
  /// factors see σ_i/p(ω_i) in place of σ_i. Constant 1 unless has_penalty().
  virtual double penalty(double /*omega*/, double /*reference*/) const { return 1.0; }
  virtual bool has_penalty() const { return false; }

  /// kept_i = φ(σ_i; λ), 0 where σ_i = 0, and, unless that span is empty, lost_i = 1 − φ(σ_i; λ)
  /// without cancellation. sigma, kept: n. Throws InvalidInput unless λ is finite and ≥ 0.
  void filter_factors(std::span<const double> sigma, double parameter, std::span<double> kept,
                      std::span<double> lost = {}) const;

  /// Residual norm, solution norm and degrees of freedom for every parameter; the criterion is left
  /// NaN. Throws InvalidInput unless the parameters are finite, ≥ 0 and do not fall.
  void trace(const SpectralSystem& system, std::span<const double> parameters,
             std::span<CurvePoint> curve) const;

 private:
  virtual void do_filter_factors(std::span<const double> sigma, double parameter,
                                 std::span<double> kept, std::span<double> lost) const = 0;
  /// Fills the squared norms. Unless a regularizer knows a cheaper way, one pass over the
  /// components per parameter.
  virtual void do_trace_squares(const SpectralSystem& system, std::span<const double> parameters,
                                std::span<CurvePoint> curve) const;
};

/// σ_i/p(ω_i) in the operator's sorted order (falling σ_i), or in the order it was given. Throws
/// InvalidInput where a penalty needs frequencies and the problem has none.
std::vector<double> penalized_sigma(const Regularizer& regularizer,
                                    const SpectralOperator& problem);
std::vector<double> penalized_sigma_as_given(const Regularizer& regularizer,
                                             const SpectralOperator& problem);
/// The same, falling.
std::vector<double> falling_penalized_sigma(const Regularizer& regularizer,
                                            const SpectralOperator& problem);

}  // namespace modcal
