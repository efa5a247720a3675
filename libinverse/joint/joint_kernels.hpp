// Loops over the bins of a joint inversion and over the cells of its curve of evidence, compiled
// for every instruction set (Highway).
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "libsim/signal/fft.hpp"

namespace modcal {

/// One spectrum a reaction, by End.
using SideSpectra = std::array<std::vector<Complex>, 2>;

/// Columns of a table: of cells m, m u and m |x|², of values log(1 + ratio), kept and lost share.
using CellColumns = std::array<const double*, 3>;

/// Cells come in whole blocks, for every width of vectors.
/// Fixed by: doubles in the widest vector in use.
inline constexpr std::size_t kCellBlock = 8;

/// The loops of one instruction set. Spans of one call have one length.
struct JointKernels {
  using Values = std::span<const double>;
  using Spectrum = std::span<const Complex>;

  /// Per bin: q = Σ_r w_r |H_r|² and, in place of X_0, Σ_r w_r conj(H_r) X_r.
  void (*combine_sides)(const std::array<double, 2>& weight, const SideSpectra& transfer,
                        SideSpectra& spectrum, std::span<double> gain);
  /// Per bin |X_0 H_1 − X_1 H_0|² scale/(v_0 |H_1|² + v_1 |H_0|²), 1 where both H are 0: 1 on
  /// average where nothing but noise of variances v parts the sides. Returns the sum.
  double (*cross_misfit)(const std::array<double, 2>& noise_variance, double scale,
                         const SideSpectra& transfer, const SideSpectra& spectrum,
                         std::span<double> misfit);
  /// Per bin: power |d|² · scale.
  void (*scaled_power)(Spectrum data, double scale, std::span<double> power);
  /// What the curve of evidence needs of a bin of two degrees of freedom: g = q P scale,
  /// m u = 2 power/q and m |x|² = 2 power/q², all 0 where q is 0.
  void (*evidence_terms)(Values gain, Values prior, Values power, double scale, std::span<double> g,
                         std::span<double> reduced, std::span<double> solution);
  /// E|F|² given the data, in place of the prior variance P: power p² + p with p = P/(1 + q P).
  void (*expected_power)(Values gain, Values power, std::span<double> prior);
  /// p = P/(1 + q P) in place of P and d p in place of d. Returns Σ q p.
  double (*apply_posterior)(Values gain, std::span<double> prior, std::span<Complex> data);
  /// out = H x. Returns Σ |H|² p.
  double (*through_transfer)(Spectrum transfer, Spectrum data, Values variance,
                             std::span<Complex> out);
  /// Adds components of two degrees of freedom {2, reduced, solution, 0} to the two of `cells`
  /// cells nearest to log₂ g (2e-5 near), of which an octave has `per_octave` from `lowest` on;
  /// even and odd components to a set of their own, one behind the other. What lies beyond counts
  /// as the first or the last cell. Returns Σ reduced of those with g = 0, which go nowhere.
  double (*spread_pairs)(Values g, Values reduced, Values solution, double lowest,
                         double per_octave, std::span<std::array<double, 4>> sets);
  /// Σ log m − kept u, Σ lost² u, Σ kept² x, Σ kept m over `count` cells, a multiple of kCellBlock.
  std::array<double, 4> (*sum_cells)(const CellColumns& cells, const CellColumns& values,
                                     std::size_t count);
};

/// Those of this machine.
const JointKernels& joint_kernels();

}  // namespace modcal
