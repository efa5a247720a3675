// The amplitude of the prior, from the evidence of the data.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "libinverse/parameter_choice.hpp"

namespace modcal {

/// −2 log p(data | λ) and the norms of the solution over a logarithmic grid of λ, for components
/// with φ = g/(g + λ²): Σ_i m_i [log(1 + g_i/λ²) − u_i φ_i] (MacKay, 1992, section 3).
///
/// Components are split between the two nearest of 16 cells an octave of g (linear interpolation:
/// at most 9e-4 of a sum of squares), so that a curve costs as much as the cells, whatever the
/// number of components.
class EvidenceCurve {
 public:
  /// `points` ≥ 3 over 80 octaves of λ², 2^−64 … 2^16.
  explicit EvidenceCurve(std::size_t points);

  /// Sums by cell, to be kept from call to call.
  struct Cells {
    /// Two sets of cells taken in turn, so that neighbors do not wait for each other's sums.
    std::vector<std::array<double, 4>> sums;
    std::vector<double> column[3];  ///< the same by column, see EvidenceCurve::trace
    double unseen = 0.0;            ///< Σ m u of components with g = 0: residual whatever λ is
    double freedom = 0.0;
    void clear();
    /// g ≥ 0; freedom m; power m u; solution m |x_i|² of the unregularized solution.
    void add(double g, double freedom_i, double power, double solution);
    /// Components of two degrees of freedom, spans of one length.
    void add_pairs(std::span<const double> g, std::span<const double> power,
                   std::span<const double> solution);
  };

  /// Fills the curve; the norms are square roots of sums. Returns the minimum of the criterion,
  /// refined by a parabola in log λ. Overwrites the cells' columns.
  void trace(Cells& cells, ChosenParameter& choice) const;

 private:
  struct Values {
    double logarithm = 0.0, kept = 0.0, lost = 0.0;
  };
  static Values values_at(double octaves);
  static CurvePoint point_between(const Cells& cells, std::size_t first, std::size_t count,
                                  double octave);

  std::size_t points_;
  std::size_t stride_;
  std::vector<double> table_[3];
};

}  // namespace modcal
