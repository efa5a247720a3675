// Structures whose modes are known, under a force that never stops.
#pragma once

#include "libinverse/structure/blind_fit.hpp"

namespace modcal::known_structures {

inline constexpr double kRate = 3200.0, kLow = 20.0, kHigh = 400.0;  // [Hz]

/// 47 to 372 Hz, two of them 6 % apart, ζ .4 to 1 %, complex modal constants; an acceleration, a
/// velocity and a displacement, the first `sensors` of them.
ModalModel six_modes(std::size_t sensors);

/// The 27 modes below 390 Hz of a rectangular plate on simple supports, ω ∝ (p/a)² + (q/b)², the
/// nearest two 1.5 % apart, ζ .3 to .8 %, four accelerometers; modal constants by its shapes with a
/// complex part of a tenth.
ModalModel plate();

/// One second out of the middle: the structure rings at both ends. With `impact` a pulse of 8 ms
/// stands in it, too.
StructureRecord clean_record(const ModalModel& model, bool impact = false);

struct Noisy {
  StructureRecord record;
  std::vector<double> noise;  ///< standard deviation of a sample, K

  /// What the noise is in the bins of a contour.
  BinVariances variances(const ContourSpectra& spectra) const;
};

/// White noise of `level` times the rms of every response.
Noisy with_noise(StructureRecord record, double level, std::uint64_t seed);

/// Every f off by up to `frequency`, every ζ by up to `damping`, equally likely.
ModalModel started_off(ModalModel model, std::uint64_t seed, double frequency, double damping);

/// Every modal constant off by a complex normal number of this deviation a part.
ModalModel with_wrong_residues(ModalModel model, std::uint64_t seed, double deviation);

/// ln ω and ln ζ of every mode in turn.
Eigen::VectorXd logarithms(const ModalModel& model);

}  // namespace modcal::known_structures
