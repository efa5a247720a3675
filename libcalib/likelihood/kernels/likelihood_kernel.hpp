// Kernels of the joint likelihood, one block of bins at a time: transfer functions and residual. No
// allocation, instruction set chosen at run time.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <span>

#include "libcalib/likelihood/kernels/mode_split.hpp"
#include "libcalib/likelihood/records/whitened_record.hpp"
#include "libcalib/parameters/free_parameters.hpp"

namespace modcal {

/// One mode as the kernels see it: P_n = residue/D_n, D_n = ω_n² + s² + 2ζ_nω_n s,
/// U_n = 1/(1 − E_n z^−1).
struct LikelihoodMode {
  bool even = false;                  ///< n even: the end x = L moves as the end x = 0 does not
  double residue = 0.0;               ///< |g_n| φ_n(x_c)/m_n
  double residue_slope = 0.0;         ///< its derivative by x_c
  double omega_squared = 0.0;         ///< ω_n²
  double two_zeta_omega = 0.0;        ///< 2ζ_nω_n
  double residue_by_stiffness = 0.0;  ///< its derivative by B
  bool decays = true;                 ///< what it leaves ringing is an unknown of its own
  Complex pole;                       ///< E_n
  Complex pole_by_frequency;          ///< ∂E_n/∂ln ω_n
  Complex pole_by_damping;            ///< ∂E_n/∂ln ζ_n
};

/// Per-bin numbers of one block that later passes need; real and imaginary parts.
struct LikelihoodBlock {
  static constexpr std::size_t kBins = WhitenedRecord::kBlock;
  struct Planar {
    alignas(64) double re[kBins];
    alignas(64) double im[kBins];
  };
  Planar left, right;              // h_1, h_2
  Planar odd, even;                // κ of odd and even modes, with √w
  Planar odd_decay, even_decay;    // Σ c_n U_n + conj(c_n) U'_n over odd and even modes
  Planar force;                    // F̂
  alignas(64) double norm[kBins];  // 1/|h|², |h|² the variance of h_2n_1 − h_1n_2
};

/// Fills transfer functions, κ and 1/|h|² of `block`. sensor: how the sensor at x = L reads for one
/// that reads 1 at x = 0, a factor of h_2 and of its decays; null: alike.
void fill_block(const WhitenedRecord& record, std::size_t block_index, const ModeSplit& split,
                const PlanarVector* sensor, LikelihoodBlock& block);
/// Fills the column `residual`, (h_2y_1 − h_1y_2)/|h| with √w.
void fill_residual(const WhitenedRecord& record, std::size_t block_index,
                   const LikelihoodBlock& block, double* residual);

/// Column of the residual for something in the record of one end whose transform is `numbers` [N].
void fill_plain_column(const WhitenedRecord& record, std::size_t block_index,
                       const LikelihoodBlock& block, bool right, const PlanarVector& numbers,
                       double* column);

/// Column of an amplitude that changes both records: √w (h_1 ∂y_2 − h_2 ∂y_1)/|h|.
void fill_signal_column(const WhitenedRecord& record, std::size_t block_index,
                        const LikelihoodBlock& block, const SignalColumn& signal, double* column);

/// Column of one number of the sensor at x = L; null: not asked for.
struct SensorColumn {
  const PlanarVector* slope = nullptr;  ///< ∂ ln S by its coordinate
  const PlanarVector* plain = nullptr;  ///< ∂plain[1] by it; null: none
  double* column = nullptr;
};

/// What is in the records beside the force, and which columns of the sensor are asked for.
struct ResidualTask {
  bool decays = false;  ///< odd_decay and even_decay of the block
  const PlanarVector* sensor = nullptr;
  std::array<const PlanarVector*, 2> plain{};  ///< what else is in the records, both ends [N]
  std::array<SensorColumn, Sensor::kCount> columns{};
  double* residual = nullptr;
};
/// Adds the transients of the block to the column `residual`, fills its force and the columns of
/// the sensors.
void finish_residual(const WhitenedRecord& record, std::size_t block_index,
                     const ResidualTask& task, LikelihoodBlock& block);

}  // namespace modcal
