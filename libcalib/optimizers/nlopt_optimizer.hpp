#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "libcalib/optimizer.hpp"

namespace modcal {

enum class NloptUse {
  kInTheBox,   ///< keeps to the bounds by itself
  kUnbounded,  ///< leaves the bounds: runs through UnboundedSearch
  kTwoLevels,  ///< starts a second algorithm from many points
  kRefused,
};

/// One of the algorithms that NLopt lists: how it is run here, or why it is refused.
struct NloptAlgorithm {
  std::string_view name;  ///< without the prefix NLOPT_
  NloptUse use = NloptUse::kInTheBox;
  std::string_view refusal;  ///< why it is refused and what to take instead; else empty

  bool needs_gradient() const { return name[1] == 'D'; }
};

/// An algorithm of NLopt (Johnson, The NLopt nonlinear-optimization package), by its name;
/// algorithms() says which and how. Its own counts and limits are not used; its random generator,
/// which belongs to the thread and is seeded from the clock, is seeded for every run. MLSL starts
/// local_algorithm from many points. A local search with slopes starts afresh at the best point, in
/// units in which its first step has length 1, as long as that lowers the value by a tenth.
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

  /// All algorithms of NLopt, sorted by name.
  static std::span<const NloptAlgorithm> listed();
  /// Names of the usable ones.
  static std::span<const std::string_view> algorithms();

 private:
  StopReason search(Evaluator& evaluator) const override;

  Options options_;
  const NloptAlgorithm* row_;
};

}  // namespace modcal
