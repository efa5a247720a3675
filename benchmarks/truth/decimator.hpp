// From the rate of the scheme to that of the record.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace modcal::truth {

/// Symmetric finite impulse response with 2 half + 1 taps of sum 1, a sinc of the cutoff [cycles a
/// sample] under Kaiser's window for `attenuation` [dB] (Kaiser and Schafer, 1980).
std::vector<double> kaiser_lowpass(std::size_t half, double cutoff, double attenuation);

/// Filters and keeps one sample of `factor`. What came before the first sample is taken to be equal
/// to it. taps.size() = 2 m factor + 1, so that the delay is m outputs.
class FirStage {
 public:
  FirStage(std::size_t factor, std::vector<double> taps);
  /// One sample in; every factor-th time, the first included, one out.
  std::optional<double> push(double sample);

 private:
  std::size_t factor_, waiting_ = 0;
  std::vector<double> taps_, line_;
  std::size_t end_ = 0;  ///< filled part of the delay line
};

/// Linear-phase anti-alias filter and decimation by 8 m in two stages, with the delay taken out.
///
/// With f_s the rate of the record: gain 1 within kRipple up to kPass f_s, below kRipple from (1 −
/// kPass) f_s on, so that nothing folds into the passband.
class Decimator {
 public:
  static constexpr double kPass = 0.45;
  static constexpr double kRipple = 1e-6;

  /// Factor 8, 16, …; throws std::invalid_argument for another one. `filtered` false: plain
  /// samples.
  Decimator(std::size_t factor, bool filtered);

  void push(double sample);
  /// Samples at 0, factor, 2 factor, … of the input, as far as they are finished.
  const std::vector<double>& samples() const { return samples_; }
  /// Inputs past an instant that its sample waits for.
  std::size_t latency() const;

 private:
  void keep(const std::optional<double>& sample);

  std::size_t factor_, seen_ = 0, skip_ = 0;
  bool started_ = false;
  std::vector<FirStage> stages_;
  std::vector<double> samples_;
};

}  // namespace modcal::truth
