// Levels and coherence of the noise as unknowns of what a fit leaves.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "libinverse/noise/noise_spectrum.hpp"

namespace modcal {

/// What one bin says: the variance v of its whitened residual is the sum of `by` times C₁₁, C₂₂ and
/// C₁₂, each between its values at two knots. The last of `by` is what v is tested for, ln(1 + S)
/// of the signal's power.
struct NoiseRow {
  static constexpr std::size_t kNoise = 3, kTerms = 4;
  double octaves = 0.0;  ///< below the top knot
  std::size_t knot = 0;  ///< the lower one
  double next = 0.0;     ///< share of the upper one, in [0, 1]
  double power = 0.0;    ///< |e|²
  std::array<double, kTerms> by{};
};

/// Knots of a spectrum, evenly spaced in ln f, the last at its top.
struct NoiseKnots {
  std::size_t count = 2;  ///< two or more
  std::size_t per_octave = 1;
};

/// How many values over frequency levels and coherence have: one or one for each knot; of
/// coherence, none.
struct NoiseForm {
  std::size_t levels = 1, coherence = 0;
  double parameters() const { return static_cast<double>(2 * levels + coherence); }
};

/// C at every knot by what makes any numbers a covariance, knots side by side: ln a, ln d and β,
/// C = L Lᵀ with L = (a 0; βd d).
class NoiseModel {
 public:
  /// Of rows by their octaves; those below the lowest knot are left out.
  NoiseModel(std::vector<NoiseRow> rows, const NoiseKnots& knots);
  std::size_t knots() const { return knots_; }

  /// Factors of unit levels with nothing in common.
  Eigen::VectorXd white() const;
  /// Least −2 ln L from these factors on, by scoring with damping. Where the modes hardly tell C₁₁
  /// from C₂₂, neighboring knots hold each other.
  double fit(const NoiseForm& form, Eigen::VectorXd& factors) const;
  /// Score test of a share of the last term at every knot (Rao, 1948): χ² of so many degrees where
  /// noise of this form is all there is; above: the sum of its roots, > 0 where there is more.
  struct Excess {
    double statistic = 0.0, degrees = 0.0, above = 0.0;
  };
  Excess excess(const NoiseForm& form, const Eigen::VectorXd& factors) const;
  /// Largest Σ |e|²/v over `length` bins behind each other.
  double largest_run(const Eigen::VectorXd& factors, std::size_t length) const;
  /// The last knot at `top` [Hz]; of one level that alone.
  NoiseSpectrum spectrum(const NoiseForm& form, const Eigen::VectorXd& factors, double top) const;

 private:
  // Knots side by side: θ = (C₁₁, C₂₂, C₁₂, 0).
  struct Sums {
    Eigen::VectorXd excess;       // Σ (|e|² − v)/v² by θ
    Eigen::MatrixXd information;  // Σ 1/v² by θ and θ
  };
  double variance(const NoiseRow& row, const Eigen::VectorXd& theta) const;
  double deviance(const Eigen::VectorXd& theta) const;
  Sums sums(const Eigen::VectorXd& theta) const;
  Eigen::MatrixXd ties(const NoiseForm& form) const;
  Eigen::VectorXd covariances(const Eigen::VectorXd& factors) const;
  Eigen::MatrixXd slopes(const Eigen::VectorXd& factors) const;
  Eigen::MatrixXd bonds() const;

  std::vector<NoiseRow> rows_;
  std::size_t knots_, per_octave_;
};

}  // namespace modcal
