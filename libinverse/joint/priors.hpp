// The force priors.
#pragma once

#include "libinverse/joint/force_prior.hpp"

namespace modcal {

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

/// Starts from a force that jumps and learns a spectrum that is smooth over a fraction of an
/// octave.
class SmoothPrior final : public ForcePrior {
 public:
  struct Options {
    double corner = 50.0;      ///< f_c of the start [Hz]
    double octaves = 1.0 / 3;  ///< width of the smoothing [octaves]
    std::int64_t passes = 8;
    void visit(OptionVisitor& visitor);
  };
  explicit SmoothPrior(const Options& options);
  std::int64_t passes() const override { return passes_; }

 private:
  void do_shape(const PriorGrid& grid, std::span<double> variance) const override;
  void do_learn(const PriorGrid& grid, std::span<double> power,
                std::span<double> scratch) const override;
  JumpPrior start_;
  double octaves_;
  std::int64_t passes_;
};

/// Starts from a force that jumps and learns the spectrum of the record at a fixed bandwidth, fine
/// enough for the lines of a played note.
class LearnedPrior final : public ForcePrior {
 public:
  struct Options {
    double corner = 50.0;     ///< f_c of the start [Hz]
    double bandwidth = 20.0;  ///< full width of the smoothing [Hz]
    std::int64_t passes = 8;
    void visit(OptionVisitor& visitor);
  };
  explicit LearnedPrior(const Options& options);
  std::int64_t passes() const override { return passes_; }

 private:
  void do_shape(const PriorGrid& grid, std::span<double> variance) const override;
  void do_learn(const PriorGrid& grid, std::span<double> power,
                std::span<double> scratch) const override;
  JumpPrior start_;
  double bandwidth_;
  std::int64_t passes_;
};

}  // namespace modcal
