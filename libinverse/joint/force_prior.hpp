// What is supposed about the spectrum of the force before the data are seen.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "libsim/base/registry.hpp"

namespace modcal {

/// The bins of a spectrum, at f_k = k f_s/K.
struct PriorGrid {
  std::size_t bins = 0;
  std::size_t samples = 0;   ///< K
  double sample_rate = 0.0;  ///< f_s [Hz]
  double bin_width() const { return sample_rate / static_cast<double>(samples); }
};

/// Prior variance of F_k, up to a factor that the evidence of the data finds.
class ForcePrior {
 public:
  static constexpr std::string_view kKind = "force_prior";
  static Registry<ForcePrior> registry();

  virtual ~ForcePrior() = default;
  /// Relative variances > 0 with mean 1. Throws InvalidInput for another length than grid.bins.
  void shape(const PriorGrid& grid, std::span<double> variance) const;
  /// How often the variances are learned anew from the record; 0: they keep their shape.
  virtual std::int64_t passes() const { return 0; }
  /// Turns E|F_k|² given the record into the next variances, in place: one step of expectation
  /// maximization (Dempster, Laird and Rubin, 1977) for a spectrum that varies slowly with f.
  void learn(const PriorGrid& grid, std::span<double> power, std::span<double> scratch) const;

 private:
  virtual void do_shape(const PriorGrid& grid, std::span<double> variance) const = 0;
  virtual void do_learn(const PriorGrid& grid, std::span<double> power,
                        std::span<double> scratch) const;
};

/// Means over k ± half(k), twice for a triangular window; power and scratch: n.
void smooth_power(std::span<double> power, std::span<double> scratch, double bins_at_zero,
                  double bins_per_bin);

}  // namespace modcal
