// The axis list of a list of tasks: which options differ between its cells, and the options of
// every cell.
#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "experiments/study/fingerprint.hpp"
#include "libsim/base/sweep.hpp"

namespace modcal {

/// SweepSlot over copies of the options of a kind of experiment, a type with visit() and the member
/// `seed` or the member function seed_slot(). Cells that differ in their seed alone share one copy,
/// so that a list of 10⁶ draws is as small as its settings are few.
template <typename Options>
class AxisList final : public SweepSlot {
 public:
  const SweepPlan& plan() const override { return plan_; }
  void set_cells(SweepPlan plan, SweepCells cells) override {
    plan_ = std::move(plan);
    paths_ = std::move(cells.paths);
    values_.clear();
    value_of_.clear();
    std::unordered_map<std::string, std::uint32_t> known;
    value_of_.reserve(cells.values.size() * paths_.size());
    for (const std::vector<std::string>& cell : cells.values) {
      for (const std::string& value : cell) {
        const auto [place, is_new] =
            known.try_emplace(value, static_cast<std::uint32_t>(values_.size()));
        if (is_new) values_.push_back(value);
        value_of_.push_back(place->second);
      }
    }
    settings_.clear();
    known_settings_.clear();
    cells_.assign(cells.values.size(), Cell{});
  }
  void visit_cell(std::size_t index, OptionVisitor& visitor) override {
    Options options;
    options.visit(visitor);
    cells_[index].seed = std::exchange(seed_of(options), 0);
    std::string key = fingerprint([&options](OptionVisitor& writer) { options.visit(writer); });
    const auto [place, is_new] =
        known_settings_.try_emplace(std::move(key), static_cast<std::uint32_t>(settings_.size()));
    if (is_new) {
      seed_of(options) = cells_[index].seed;
      settings_.push_back(std::move(options));
    }
    cells_[index].settings = place->second;
  }

  std::size_t size() const { return cells_.size(); }
  /// Paths of the options that differ between cells.
  const std::vector<std::string>& paths() const { return paths_; }
  /// Their values in a cell, as written; empty: the experiment's own.
  std::vector<std::string> values(std::size_t cell) const {
    std::vector<std::string> values;
    for (std::size_t i = 0; i < paths_.size(); ++i) {
      values.push_back(values_[value_of_[cell * paths_.size() + i]]);
    }
    return values;
  }
  Options operator[](std::size_t cell) const {
    Options options = settings_[cells_[cell].settings];
    seed_of(options) = cells_[cell].seed;
    return options;
  }
  /// The options of all cells, those that differ in their seed alone once.
  const std::vector<Options>& all() const { return settings_; }

 private:
  struct Cell {
    std::int64_t seed = 0;
    std::uint32_t settings = 0;
  };
  static std::int64_t& seed_of(Options& options) {
    if constexpr (requires { options.seed_slot(); }) {
      return options.seed_slot();
    } else {
      return options.seed;
    }
  }
  SweepPlan plan_;
  std::vector<std::string> paths_;
  std::vector<std::string> values_;      // distinct ones
  std::vector<std::uint32_t> value_of_;  // places in them, cell by cell
  std::vector<Options> settings_;
  std::unordered_map<std::string, std::uint32_t> known_settings_;
  std::vector<Cell> cells_;
};

/// Whether the value of this option tells draws of one setting apart.
inline bool is_seed_axis(const std::string& path) {
  return ("." + path).ends_with(".seed");
}

}  // namespace modcal
