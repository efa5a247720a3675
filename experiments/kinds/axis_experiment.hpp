// The axis list of a list of tasks: which options differ between its cells, and the options of
// every cell.
#pragma once

#include <algorithm>
#include <map>
#include <set>
#include <typeinfo>

#include "experiments/kinds/lint.hpp"
#include "experiments/runs/task_experiment.hpp"

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
    first_cell_.clear();
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
      first_cell_.push_back(index);
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
  /// The first cell that has these options of all().
  std::size_t first_cell(std::size_t settings) const { return first_cell_[settings]; }
  /// Place of a cell's options in all().
  std::size_t settings_of(std::size_t cell) const { return cells_[cell].settings; }

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
  std::vector<std::size_t> first_cell_;  // of each
  std::unordered_map<std::string, std::uint32_t> known_settings_;
  std::vector<Cell> cells_;
};

/// Whether the value of this option tells draws of one setting apart.
inline bool is_seed_axis(const std::string& path) { return ("." + path).ends_with(".seed"); }

// Lists of tasks over the options of a kind of experiment: an axis list, whatever sums it up.

/// Whether a record is judged by the value of this option.
bool is_read_with_record(const std::string& path);

/// Findings, each once.
std::vector<Finding> distinct_findings(std::vector<Finding> findings);
/// Findings of a cell with its values on the axes that they concern.
void place_on_axes(const std::vector<std::string>& paths, const std::vector<std::string>& values,
                   std::vector<Finding>& findings);
/// Those of the tasks of a list, each once; what is idle in some tasks and read in others is none.
std::vector<Finding> findings_of_list(const std::vector<std::vector<Finding>>& of_tasks);

/// One line an axis, the number of tasks, the simulations and those that tasks share.
std::vector<PlanLine> axis_plan(const SweepPlan& plan, std::size_t tasks,
                                const std::optional<PlannedSimulations>& planned);

/// `base` with the number of distinct simulations of `cells` settings.
std::optional<PlannedSimulations> planned_together(
    std::optional<PlannedSimulations> base, std::size_t cells,
    const std::function<std::optional<PlannedSimulations>(std::size_t)>& planned_of);

/// The axis of `count` values that text_of(i) writes.
SweepAxis axis_of(std::string path, std::size_t count,
                  const std::function<std::string(std::size_t)>& text_of);

/// A list of every combination of some axes, the last varying fastest.
class ProductExperiment : public TaskExperiment {
 public:
  explicit ProductExperiment(std::vector<SweepAxis> axes) : axes_(std::move(axes)) {}
  std::size_t task_count() const final;
  std::vector<std::string> axes() const final;
  std::vector<std::string> axis_values(std::size_t task) const final;

 protected:
  /// Place of a task on an axis.
  std::size_t place(std::size_t task, std::size_t axis) const;

 private:
  std::vector<SweepAxis> axes_;
};

/// Recorded files that options name, where they can.
template <typename Options>
std::vector<FileRead> files_read_by(const Options& options) {
  if constexpr (requires { options.files_read(); }) return options.files_read();
  return {};
}

/// What recorded files say against options that name some.
template <typename Options>
std::vector<Finding> record_findings(const Options& options, const std::filesystem::path& folder) {
  if constexpr (requires { options.lint_records(folder); }) return options.lint_records(folder);
  return {};
}

/// An axis list over a kind of experiment: `Cell` are the options of the kind (StudyExperiment).
/// `Settings` are the options of the list beside those of its cells: a type with visit() and
/// kNeedsAxes, whether the axes must be stated. What one task leaves and how outcomes are summed up
/// is for the derived class to say.
template <typename Cell, typename Settings>
class AxisExperiment : public TaskExperiment {
 public:
  struct Options {
    Cell base;
    Settings list;
    AxisList<Cell> cells;
    void visit(OptionVisitor& visitor) {
      base.visit(visitor);
      list.visit(visitor);
      // Last: every cell is read with the keys above known.
      visitor.sweep({.key = "sweep",
                     .meaning = "axes: paths of the keys above, each with a list of its values",
                     .required = Settings::kNeedsAxes},
                    cells);
    }
  };
  explicit AxisExperiment(Options options) : options_(std::move(options)) {}

  std::vector<Finding> lint() const override {
    std::vector<std::vector<Finding>> findings;
    for (std::size_t i = 0; i < options_.cells.all().size(); ++i) {
      const Cell& cell = options_.cells.all()[i];
      findings.push_back(cell.lint());
      std::erase_if(findings.back(),
                    [&](const Finding& finding) { return is_excused(cell, finding); });
      const std::vector<std::string> values = options_.cells.values(options_.cells.first_cell(i));
      place_on_axes(options_.cells.paths(), values, findings.back());
    }
    return findings_of_list(findings);
  }
  /// Of every file, and of the first few parts and strings that axes make of it.
  std::vector<Finding> lint_records(const std::filesystem::path& folder) const override {
    constexpr std::size_t kMostParts = 12;
    std::vector<Finding> findings;
    std::map<std::vector<std::string>, std::set<std::vector<std::string>>> read;
    const std::vector<std::string>& paths = options_.cells.paths();
    for (std::size_t i = 0; i < options_.cells.all().size(); ++i) {
      const Cell& cell = options_.cells.all()[i];
      const std::vector<std::string> values = options_.cells.values(options_.cells.first_cell(i));
      std::vector<std::string> names, part;
      for (const FileRead& file : files_read_by(cell)) names.push_back(file.name);
      for (std::size_t axis = 0; axis < paths.size(); ++axis) {
        if (is_read_with_record(paths[axis])) part.push_back(values[axis]);
      }
      std::set<std::vector<std::string>>& parts = read[names];
      if (parts.size() >= kMostParts || !parts.insert(part).second) continue;
      std::vector<Finding> own = record_findings(cell, folder);
      place_on_axes(paths, values, own);
      append(findings, std::move(own));
    }
    return distinct_findings(std::move(findings));
  }
  /// Those of the settings without axes, with the most that any cell holds.
  std::vector<FileRead> files_read() const override {
    std::vector<FileRead> files = files_read_by(options_.base);
    if (std::ranges::none_of(files, [](const FileRead& file) { return file.numbers > 0.0; })) {
      return files;
    }
    for (const Cell& cell : options_.cells.all()) {
      for (const FileRead& file : files_read_by(cell)) {
        files.front().numbers = std::max(files.front().numbers, file.numbers);
      }
    }
    return files;
  }
  std::string_view for_structures() const override { return Cell::kForStructures; }
  std::vector<PlanLine> plan() const override {
    return axis_plan(options_.cells.plan(), task_count(), planned_simulations());
  }
  std::optional<PlannedSimulations> planned_simulations() const override {
    const std::vector<Cell>& cells = options_.cells.all();
    return planned_together(options_.base.planned_simulations(), cells.size(),
                            [&cells](std::size_t i) { return cells[i].planned_simulations(); });
  }
  std::size_t task_count() const override { return options_.cells.size(); }
  std::vector<std::string> axes() const override { return options_.cells.paths(); }
  std::vector<std::string> axis_values(std::size_t task) const override {
    return options_.cells.values(task);
  }
  std::string fingerprint(std::size_t task, const std::filesystem::path& folder) const override {
    Cell cell = options_.cells[task];
    std::string text = typeid(*this).name() + modcal::fingerprint([&](OptionVisitor& visitor) {
                         cell.visit(visitor);
                         visit_scoring(visitor);
                       });
    for (const FileRead& file : files_read_by(cell)) {
      text += fmt::format(" {}", input_digest(folder / file.name));
      if (file.named == nullptr) continue;
      for (const auto& other : file.named(folder / file.name)) {
        text += fmt::format(" {}", input_digest(other));
      }
    }
    return text;
  }
  /// The cell as an experiment of its own.
  StudyResult replay(std::size_t task, const StudyContext& context) const override {
    Cell cell = options_.cells[task];
    draw_all(cell);
    return cell.run(context);
  }

 protected:
  Options options_;

 private:
  /// What is no mistake in a cell of a list.
  virtual bool is_excused(const Cell& /*cell*/, const Finding& /*finding*/) const { return false; }
  /// Options of the list that an outcome depends on.
  virtual void visit_scoring(OptionVisitor& /*visitor*/) const {}
  /// Turns on what a replay shows.
  virtual void draw_all(Cell& /*cell*/) const {}
};

}  // namespace modcal
