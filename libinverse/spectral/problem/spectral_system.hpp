// What regularizers and parameter choices see of an inverse problem: singular values and
// coefficients. The diagonal problem of a Fourier transform and the SVD of any matrix look alike.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace modcal {

/// The norm of the solution that a parameter choice weighs against the residual.
enum class Measure {
  kSolution,    ///< ‖F‖
  kDerivative,  ///< ‖dF/dt‖
};

/// Components i = 0 … n−1 of a linear problem in the order of falling singular values σ_i, with
/// what the data do not change.
class SpectralOperator {
 public:
  /// `singular_values` ≥ 0 in any order; `multiplicity`: real degrees of freedom of each component
  /// (2 for a complex Fourier bin, 1 for a real one); `derivative_weight`: squared weight of each
  /// component in ‖dF/dt‖² (ω²), empty where the problem has no time; `rows`: real numbers in the
  /// data; `penalized`: the penalty of a regularizer is in the singular values already. Singular
  /// values whose square underflows (below 1.5e-154) count as 0.
  /// Throws InvalidInput for a singular value or weight that is negative or not finite.
  SpectralOperator(std::vector<double> singular_values, std::vector<double> multiplicity,
                   std::vector<double> derivative_weight, std::size_t rows, bool penalized = false);

  std::size_t size() const { return sigma_.size(); }
  std::size_t rows() const { return rows_; }
  bool penalized() const { return penalized_; }
  /// σ_i, falling.
  std::span<const double> sigma() const { return sigma_; }
  /// Degrees of freedom of component i.
  std::span<const double> multiplicity() const { return multiplicity_; }
  /// Σ multiplicity.
  double freedom() const { return freedom_; }
  /// Squared weight in the measure over σ_i², 0 where σ_i = 0: times |u_iᵀb|² it is what component
  /// i adds to the squared norm of the unregularized solution. Throws InvalidInput where the
  /// problem has no such measure.
  std::span<const double> solution_weight(Measure measure) const;
  /// ω_i of component i [rad/s]; empty where the problem has no time.
  std::span<const double> omega() const { return omega_; }
  /// Place of sorted component i in the order the constructor was given.
  std::span<const std::uint32_t> order() const { return order_; }
  /// Singular values in the order the constructor was given.
  std::span<const double> sigma_as_given() const { return sigma_as_given_; }
  /// Number of components with σ = 0: nothing of them is in the data.
  std::size_t zeros() const { return zeros_; }

 private:
  std::vector<double> sigma_as_given_;
  std::vector<std::uint32_t> order_;
  std::vector<double> sigma_;
  std::vector<double> multiplicity_;
  std::vector<double> inverse_square_;
  std::vector<double> derivative_weight_;
  std::vector<double> omega_;
  double freedom_ = 0.0;
  std::size_t rows_ = 0;
  std::size_t zeros_ = 0;
  bool penalized_ = false;
};

/// One set of data in the components of an operator.
struct SpectralData {
  const SpectralOperator* problem = nullptr;
  /// |u_iᵀb|² in the operator's sorted order, scaled so that their sum is the squared norm of the
  /// data within the range.
  std::span<const double> power;
  /// Squared norm of the data outside the range: residual at every parameter.
  double outside_power = 0.0;
  /// Standard deviation of the noise of one datum; NaN where it is not known.
  double noise_rms = std::numeric_limits<double>::quiet_NaN();
};

/// Operator and data with the solution's measure decided on; all spans in sorted order.
struct SpectralSystem {
  const SpectralOperator* problem = nullptr;
  std::span<const double> sigma;
  std::span<const double> multiplicity;
  std::span<const double> power;
  std::span<const double> solution_weight;
  double outside_power = 0.0;

  SpectralSystem(const SpectralData& data, Measure measure);
  std::size_t size() const { return sigma.size(); }
};

}  // namespace modcal
