#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "libcalib/optimizer.hpp"

struct nlopt_opt_s;

namespace modcal {

/// An algorithm of NLopt (Johnson, The NLopt nonlinear-optimization package), by its name;
/// nlopt_algorithms() says which and how. Its own counts and limits are not used; its random
/// generator, which belongs to the thread and is seeded from the clock, is seeded for every run.
/// MLSL starts local_algorithm from many points.
class NloptOptimizer final : public Optimizer {
 public:
  struct Options {
    std::string algorithm = "LN_BOBYQA";
    std::string local_algorithm = "automatic";  ///< LN_BOBYQA or LD_LBFGS
    double step_tolerance = 1e-8;               ///< on the scaled variables [1]
    double value_tolerance = 1e-14;             ///< relative to the value [1]
    double initial_step = 0.1;  ///< on the scaled variables [1], where an algorithm has one
    std::int64_t seed = 1;
    void visit(OptionVisitor& visitor);
  };
  /// Throws InvalidInput for an unknown or refused algorithm, and for a local algorithm where none
  /// is used or that needs more than the other.
  explicit NloptOptimizer(const Options& options);
  std::string_view name() const override { return "nlopt"; }
  Capabilities needs() const override;

  /// Names of the usable algorithms, without the prefix NLOPT_.
  static std::span<const std::string_view> algorithms();

 private:
  void set_tolerances(nlopt_opt_s* optimizer) const;
  void set_local_algorithm(nlopt_opt_s* optimizer) const;
  StopReason search(Evaluator& evaluator) const override;

  Options options_;
};

}  // namespace modcal
