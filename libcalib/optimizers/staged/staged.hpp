#pragma once

#include <string>
#include <vector>

#include "libcalib/optimizer.hpp"
#include "libcalib/problem/nested_choice.hpp"

namespace modcal {

/// Search in stages, each from where the one before ended, within one budget and one set of bounds.
/// Without stages of one's own it follows the schedule that the objective brings along: of
/// joint_likelihood the law on damped records, then on the whole one, then every frequency with
/// outlier test and alias minima, from other starts where χ² contradicts the result.
class Staged final : public Optimizer {
 public:
  static constexpr std::string_view kName = "staged";
  static constexpr std::string_view kNested = "write its stages into this one";
  struct Stage {
    double damping = 0.0;           ///< σ: the record is multiplied by exp(−σt) [1/s]
    std::vector<std::string> free;  ///< names; "f" and "zeta": of every mode; empty: all
    NestedChoice<Optimizer, Staged> optimizer{"scoring"};  ///< with its own tolerances
    void visit(OptionVisitor& visitor);
  };
  struct Options {
    ScheduleOptions schedule;
    std::vector<Stage> stages;
    void visit(OptionVisitor& visitor);
  };
  /// Throws InvalidInput for a negative damping.
  explicit Staged(Options options);
  std::string_view name() const override { return kName; }
  /// What one of its stages needs.
  Capabilities needs() const override;

 private:
  bool starts_from_value() const override { return !options_.stages.empty(); }
  void require_feasible(const Evaluator& evaluator) const override;
  StopReason search(Evaluator& evaluator) const override;

  Options options_;
};

}  // namespace modcal
