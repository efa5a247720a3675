// What is supposed about the spectrum of the force before the data are seen: the force priors.
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

/// The same variance in every bin.
class FlatPrior final : public ForcePrior {
 public:
  struct Options {
    void visit(OptionVisitor& /*visitor*/) {}
  };
  explicit FlatPrior(const Options& /*options*/) {}

 private:
  void do_shape(const PriorGrid& grid, std::span<double> variance) const override;
};

/// A force that jumps, sampled: 1/(sin²(πf/f_s) + sin²(πf_c/f_s)), the spectrum of a first-order
/// autoregressive sequence, ∝ 1/f² above the corner f_c with the aliases of a point-sampled signal.
class JumpPrior final : public ForcePrior {
 public:
  struct Options {
    double corner = 50.0;  ///< f_c [Hz]
    void visit(OptionVisitor& visitor);
  };
  /// Throws InvalidInput for a corner that is not > 0.
  explicit JumpPrior(const Options& options);

 private:
  void do_shape(const PriorGrid& grid, std::span<double> variance) const override;
  double corner_;
};

/// Starts from a force that jumps and learns the spectrum of the record.
class LearningPrior : public ForcePrior {
 public:
  std::int64_t passes() const override { return passes_; }

 protected:
  LearningPrior(double corner, std::int64_t passes) : start_({.corner = corner}), passes_(passes) {}

 private:
  void do_shape(const PriorGrid& grid, std::span<double> variance) const override {
    start_.shape(grid, variance);
  }

  JumpPrior start_;
  std::int64_t passes_;
};

/// A spectrum that is smooth over a fraction of an octave.
class SmoothPrior final : public LearningPrior {
 public:
  struct Options {
    double corner = 50.0;      ///< f_c of the start [Hz]
    double octaves = 1.0 / 3;  ///< width of the smoothing [octaves]
    std::int64_t passes = 8;
    void visit(OptionVisitor& visitor);
  };
  explicit SmoothPrior(const Options& options);

 private:
  void do_learn(const PriorGrid& grid, std::span<double> power,
                std::span<double> scratch) const override;
  double octaves_;
};

/// The spectrum at a fixed bandwidth, fine enough for the lines of a played note.
class LearnedPrior final : public LearningPrior {
 public:
  struct Options {
    double corner = 50.0;     ///< f_c of the start [Hz]
    double bandwidth = 20.0;  ///< full width of the smoothing [Hz]
    std::int64_t passes = 8;
    void visit(OptionVisitor& visitor);
  };
  explicit LearnedPrior(const Options& options);

 private:
  void do_learn(const PriorGrid& grid, std::span<double> power,
                std::span<double> scratch) const override;
  double bandwidth_;
};

}  // namespace modcal
