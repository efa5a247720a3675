// Noise of the two sensors, from the record alone.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "libinverse/joint/string_transfer.hpp"
#include "libsim/signal/fft.hpp"

namespace modcal {

struct SensorNoiseLevel {
  std::array<double, 2> rms = {0.0, 0.0};  ///< of one sample [N]; 0 where a side is missing
  /// Share of the band's power that the cross relation leaves as noise, in (0, 1].
  double noise_share = 1.0;
  bool measured = false;  ///< false: the rate leaves no band above the modes, 1 % is supposed
};

/// Standard deviations of white noise in the reactions. Above the top mode the power spectra of
/// the Hann-windowed record (Welch, 1967) hold noise and the tail of the string's response; the
/// cross relation R_1 H_2 − R_2 H_1 of the same bins holds noise only and tells their shares.
class SensorNoise {
 public:
  /// Transfer functions as the inversion's, on the frequency axis.
  SensorNoise(const ModalBasis& basis, double contact, std::size_t samples, double sample_rate,
              const StringSupport& support, const SensorPair& sensors);

  struct Workspace {
    std::vector<Complex> spectrum[2];
  };
  /// Both sides of `samples` samples, or one of them empty.
  SensorNoiseLevel estimate(const ReactionPair& reactions, Workspace& workspace) const;

 private:
  void transform(std::span<const double> segment, Workspace& workspace, std::size_t side) const;

  InPlaceFft fft_;
  std::size_t samples_;
  std::vector<double> window_;
  double window_power_ = 0.0;
  std::size_t first_ = 0;  // bins of the band
  std::size_t last_ = 0;
  // Of the band's bins: H_r/√(|H_1|² + |H_2|²), 0 where neither is finite and above 0.
  std::vector<Complex> direction_[2];
};

enum class RecordStart { kRest, kMoving, kUntold };

/// Whether the reactions are still before the first wave arrives [s], where one of them shows it:
/// their variance there is no more than noise of rms [N] has in that many samples and a share
/// (kStillShare) of that of a Helmholtz motion, a ramp, in that time.
RecordStart record_start(const ReactionPair& reactions, const std::array<double, 2>& rms,
                         const std::array<double, 2>& arrivals, double fundamental,
                         double sample_rate);

}  // namespace modcal
