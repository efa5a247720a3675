#pragma once

#include <cstdint>

#include "libcalib/optimizer.hpp"

namespace modcal {

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
