// The two reactions as the joint likelihood sees them: damped, cut, transformed and whitened.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "libcalib/likelihood/records/line_waves.hpp"
#include "libcalib/parameters/free_parameters.hpp"
#include "libcalib/problem/calibration_data.hpp"
#include "libinverse/noise/noise_spectrum.hpp"
#include "libsim/base/aligned_vector.hpp"
#include "libsim/base/kernels/column_products.hpp"
#include "libsim/model/modal_basis.hpp"

namespace modcal {

/// Records of both reactions with the standard deviations and the spectrum of their noise.
struct NoisyRecords {
  std::array<std::vector<double>, 2> reactions;  ///< R_r [N], one length; index: End
  std::array<double, 2> deviation{};             ///< s_r > 0 [N]
  double sample_rate = 0.0;                      ///< f_s [Hz]
  NoiseSpectrum noise = {};                      ///< over s_r²
  double power_error = 0.0;  ///< relative standard deviation of the noise's power
  /// Lines of the mains, whose amplitudes at either end are unknown [Hz].
  std::vector<double> lines = {};
  /// Of unknown amplitudes, for the undamped record: whitened, of all its bins.
  std::vector<SignalColumn> signals = {};
  /// Where a bridge that moves was taken out of `reactions`: R_2 as recorded [N], and the
  /// frequencies of the body's modes [Hz]; else empty.
  std::vector<double> on_bridge = {}, body = {};

  std::size_t samples() const { return reactions[0].size(); }
  /// The records behind spectra of both ends. deviation: s_r [N]; NaN: estimated by
  /// noise_deviation() above the modes of `basis`. Throws InvalidInput where a reaction is missing,
  /// a deviation is not > 0, or no band is left to estimate one from.
  static NoisyRecords of_data(const CalibrationData& data, const ModalBasis& basis,
                              std::array<double, 2> deviation = {
                                  std::numeric_limits<double>::quiet_NaN(),
                                  std::numeric_limits<double>::quiet_NaN()});
};

/// Bins k = 1 … of exp(−σt) R_r(t), cut to 8/σ seconds, divided by the standard deviation s_r of
/// their noise: y_r with noise CN(0, C_k), C_k the identity or that of a spectrum. Arrays are
/// padded to whole blocks of kBlock bins; the padding has weight 0.
struct WhitenedRecord {
  static constexpr std::size_t kBlock = kColumnLength / 2;  ///< a column holds both parts
  /// Chebyshev nodes of a block.
  /// Fixed by: rounding, in whole vectors; they leave 1e-14 of a mode whose pole is four
  /// half-widths from the center.
  static constexpr std::size_t kNodes = 16;

  std::size_t bins = 0;      ///< K_b
  double sigma = 0.0;        ///< σ [1/s]
  double spacing = 0.0;      ///< ω_k = k·spacing [rad/s], k = first … first + K_b − 1
  std::size_t first = 1;     ///< 1, save in a slice
  double sample_rate = 0.0;  ///< [Hz]
  std::array<double, 2> deviation{};
  double energy = 0.0;                                  ///< Σ |y_1|² + |y_2|² of the record
  std::vector<double> lines;                            ///< [rad/s]
  std::shared_ptr<const std::vector<LineWaves>> waves;  ///< of the lines; null: there are none
  std::vector<SignalColumn> signals;
  PlanarVector left, right;  ///< y_1, y_2
  PlanarVector on_bridge;    ///< that of the records, at σ = 0, whole; else empty
  std::vector<double> body;  ///< [Hz]
  /// C_k of every bin: E|n_1|², E|n_2|², E n_1 conj(n_2); empty: the identity.
  AlignedVector left_noise, right_noise, mixed_noise;
  PlanarVector delay;         ///< z^−1 = exp(−s_k/f_s)
  PlanarVector offset;        ///< whitened transform of 1·exp(−σt); zero at σ = 0
  AlignedVector root_weight;  ///< √w_k: 1, in the padding 0
  AlignedVector omega;        ///< ω_k [rad/s], in the padding too
  AlignedVector node_omega;   ///< at the nodes of every block
  PlanarVector node_delay;    ///< z^−1 there

  /// Place of bin k of a block, and of node j, in [−1, 1].
  static double block_place(double k);
  static double node_place(std::size_t j);
  bool white() const { return left_noise.empty(); }
  NoiseCovariance noise_at(std::size_t k) const {
    if (white()) return {};
    return {left_noise[k], right_noise[k], mixed_noise[k]};
  }
  std::size_t blocks() const { return root_weight.size() / kBlock; }
  /// σ ≥ 0 [1/s]; bins up to `highest` [rad/s]. Throws InvalidInput where no bin is left.
  static WhitenedRecord of(const NoisyRecords& records, double sigma, double highest);
  /// `count` bins from index `begin` on, or what there is of them.
  WhitenedRecord slice(std::size_t begin, std::size_t count) const;
  /// The same bins with pure noise CN(0, C_k) in place of the data.
  WhitenedRecord noise(std::uint64_t seed) const;
  void draw_noise(std::uint64_t seed);  ///< puts it in the place of the data

 private:
  void place_bins();
  void place_lines();
  void take_noise(const NoiseSpectrum& spectrum);
};

}  // namespace modcal
