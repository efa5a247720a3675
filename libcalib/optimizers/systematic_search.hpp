// Searches whose points are laid out beforehand.
#pragma once

#include <cstdint>

#include "libcalib/optimizer.hpp"
#include "libcalib/optimizers/settled_variables.hpp"

namespace modcal {

/// Systematic search of one variable after the other: evenly spaced candidates around its current
/// value, a move to the best of them, and the whole repeated (Debut, Delaune and Antunes, 2010,
/// section 6: 50 candidates within ±3 %, 10 loops). Each loop starts from the configuration the
/// last one left, so that ranges follow the current values. A best candidate at the end of the
/// range is taken like any other: the next loop looks further. What is left of the budget when it
/// does not hold all candidates of a variable goes into that many, from end to end of its range and
/// with the current value among them; then the budget ends the search.
///
/// skip_settled: a variable whose answer no longer changes (settled_variables.hpp) takes the answer
/// it is expected to give, unsearched, until something that reaches it moves by more than a step.
/// The last loop searches every variable: what the search ends with is always the best of its
/// candidates, where the budget allows all loops.
class ModeByMode final : public Optimizer {
 public:
  struct Options {
    std::int64_t candidates = 50;
    double half_range = 0.03;  ///< relative to the current value [1]
    std::int64_t loops = 10;
    bool skip_settled = false;
    void visit(OptionVisitor& visitor);
  };
  explicit ModeByMode(const Options& options);
  std::string_view name() const override { return "mode_by_mode"; }

 private:
  /// No variable may start at 0: it would have no relative range.
  void require_feasible(const Evaluator& evaluator) const override;
  /// Keeps the scans of the first and of the last completed loop. Ends early where a loop moves
  /// nothing.
  StopReason search(Evaluator& evaluator) const override;
  void place_candidates(const Variable& variable, double center, std::int64_t count,
                        std::vector<double>& candidates) const;
  CoordinateScan search_variable(Evaluator& evaluator, std::size_t i, std::int64_t loop,
                                 SettledVariables& settled) const;
  void leave_out(Evaluator& evaluator, std::size_t i, SettledVariables& settled) const;

  Options options_;
};

/// Every point of a regular grid over the box of bounds, bounds included: for few dimensions.
class Grid final : public Optimizer {
 public:
  struct Options {
    std::int64_t points = 41;  ///< per variable
    void visit(OptionVisitor& visitor);
  };
  explicit Grid(const Options& options);
  std::string_view name() const override { return "grid"; }

 private:
  /// The points and the initial point must fit into the budget.
  void require_feasible(const Evaluator& evaluator) const override;
  /// With one variable the values are kept as a scan.
  StopReason search(Evaluator& evaluator) const override;
  void search_line(Evaluator& evaluator) const;
  void search_box(Evaluator& evaluator) const;

  Options options_;
};

}  // namespace modcal
