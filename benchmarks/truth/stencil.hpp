// Stencils on a uniform grid, from the symbol that they are to have.
#pragma once

#include <span>
#include <vector>

namespace modcal::truth {

/// Power series Σ_m a_m X^m with X = θ², cut off after a.size() terms. θ = βh is the phase of a
/// sine of wavenumber β [rad/m] from one grid point to the next.
using Series = std::vector<long double>;

/// a b, to the length of a. Both have this length.
Series product(const Series& a, const Series& b);
/// exp(a), by E' = a' E.
Series exponential(const Series& a);
/// cos √a, an entire function of a, by its power series; |a_0| << 1.
Series cosine_of_root(const Series& a);

/// Symmetric stencil (S y)_j = c_0 y_j + Σ_{i=1…P} c_i (y_{j+i} + y_{j−i}). Sines and cosines on
/// the grid are its eigenvectors, with the symbol c_0 + 2 Σ c_i cos iθ as eigenvalue.
class SymmetricStencil {
 public:
  explicit SymmetricStencil(std::vector<double> taps);

  std::span<const double> taps() const { return taps_; }  ///< c_0 … c_P
  std::size_t half_width() const { return taps_.size() - 1; }
  /// The symbol of the taps as they are stored, S(0) − 4 Σ c_i sin²(iθ/2): no digits lost near θ =
  /// 0.
  double symbol(double theta) const;

 private:
  std::vector<double> taps_;
  double at_zero_;
};

/// The stencil of half-width P = series.size() − 1 whose symbol agrees with the series up to
/// θ^{2P}.
///
/// θ² = 2 Σ_{m≥1} S^m/(m² C(2m, m)) with S = 4 sin²(θ/2), the symbol of −δ² (the square of the
/// arcsine's series), turns the series into one in S, whose first P + 1 terms are the stencil: the
/// classical central differences of order 2P for the series X (Fornberg, 1988).
SymmetricStencil matched_stencil(const Series& series);

/// Weights w_1 … w_M, M = series.size(), so that Σ w_j sin jθ = θ Σ_m a_m θ^{2m} up to θ^{2M − 1}:
/// one-sided weights for odd derivatives at an end about which y is odd.
std::vector<double> matched_odd_weights(const Series& series);

/// Weights of polynomial interpolation (Lagrange) at `position` in grid units between `points`
/// neighbours, an even number.
struct Interpolation {
  std::size_t first;            ///< index of the first of these neighbours
  std::vector<double> weights;  ///< Σ = 1

  double of(const double* values) const {
    // Two sums side by side: one would wait for itself.
    double even = 0.0, odd = 0.0;
    for (std::size_t i = 0; i < weights.size(); i += 2) {
      even += weights[i] * values[first + i];
      odd += weights[i + 1] * values[first + i + 1];
    }
    return even + odd;
  }
};
Interpolation interpolation_at(double position, std::size_t points);

}  // namespace modcal::truth
