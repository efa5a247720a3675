#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "libcalib/optimizer.hpp"

namespace modcal {

/// An algorithm of NLopt that can minimize within bounds by itself (Johnson, The NLopt
/// nonlinear-optimization package): all but LD_LBFGS_NOCEDAL, which is listed but not compiled,
/// LN_NEWUOA, which leaves the bounds, GD_STOGO, which cannot be stopped from its callback,
/// GN_ORIG_DIRECT, which crashes when stopped early, and the AUGLAG and MLSL families, which need
/// another optimizer inside.
/// Its own counts and limits are not used; its random generator is seeded for every run.
class NloptOptimizer final : public Optimizer {
 public:
  struct Options {
    std::string algorithm = "LN_BOBYQA";
    double step_tolerance = 1e-8;    ///< on the scaled variables [1]
    double value_tolerance = 1e-14;  ///< relative to the value [1]
    double initial_step = 0.1;       ///< on the scaled variables [1], where an algorithm has one
    std::int64_t seed = 1;
    void visit(OptionVisitor& visitor);
  };
  /// Throws InvalidInput for an unknown or unusable algorithm.
  explicit NloptOptimizer(const Options& options);
  std::string_view name() const override { return "nlopt"; }
  Capabilities needs() const override;

  /// Names of the usable algorithms, without the prefix NLOPT_.
  static std::span<const std::string_view> algorithms();

 private:
  StopReason search(Evaluator& evaluator) const override;

  Options options_;
};

}  // namespace modcal
