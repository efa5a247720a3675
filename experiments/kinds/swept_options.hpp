// Options of every cell of a sweep.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "libsim/base/sweep.hpp"

namespace modcal {

/// SweepSlot over copies of a type with visit().
template <typename Options>
class SweptOptions final : public SweepSlot {
 public:
  const SweepPlan& plan() const override { return plan_; }
  void set_cells(SweepPlan plan, SweepCells cells) override {
    plan_ = std::move(plan);
    cells_ = std::move(cells);
    options_.assign(cells_.values.size(), Options{});
  }
  void visit_cell(std::size_t index, OptionVisitor& visitor) override {
    options_[index].visit(visitor);
  }

  std::size_t size() const { return options_.size(); }
  /// Paths of the options that differ between cells.
  const std::vector<std::string>& paths() const { return cells_.paths; }
  /// Their values in a cell, as written; empty: the experiment's own.
  const std::vector<std::string>& values(std::size_t cell) const { return cells_.values[cell]; }
  const Options& operator[](std::size_t cell) const { return options_[cell]; }
  const std::vector<Options>& all() const { return options_; }

 private:
  SweepPlan plan_;
  SweepCells cells_;
  std::vector<Options> options_;
};

}  // namespace modcal
