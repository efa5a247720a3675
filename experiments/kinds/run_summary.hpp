// What the runs of a list leave, by setting.
#pragma once

#include <limits>
#include <set>

#include "experiments/kinds/kind_list.hpp"
#include "experiments/study/sample.hpp"

namespace modcal {

/// Numbers of the tasks of a list: medians over the draws of a setting, which differ in seeds
/// alone, and what is drawn of them.
class RunSummary {
 public:
  /// `list` must outlive this.
  explicit RunSummary(const TaskExperiment& list);
  void add(std::size_t task, RunOutcome outcome);

  report::Table settings() const;
  std::string tasks_csv() const;
  const std::vector<TasksOfReason>& warned() const { return warned_; }
  /// Of two axes the medians of the first numbers that differ, a map each.
  std::vector<report::Table> maps() const;
  /// The first numbers that differ, a panel each, against the first axis of numbers, if any.
  report::Figure figure() const;

 private:
  struct Setting {
    std::vector<std::string> values;  ///< of the axes that are no seeds; empty: as in the file
    std::size_t n = 0, failures = 0, warned = 0;
    std::map<std::string, Sample> samples;
  };
  struct RunTask {
    std::size_t task = 0;
    RunOutcome outcome;
  };

  /// The numbers that answer, then the others.
  std::vector<std::string> shown_first() const;
  std::string unit_of(const std::string& name) const;
  /// Whether some draw that did not fail has no such number.
  bool is_missing_somewhere(const std::string& name) const;
  /// By every axis but the one at which a series has all values.
  report::Tags tags_of(const Setting& setting,
                       std::size_t except = std::numeric_limits<std::size_t>::max()) const;
  /// Rows and columns in the order of their first use, dark where the number is largest; without
  /// rows where it is one number everywhere.
  report::Table map(const std::string& name, std::size_t number) const;
  static const Sample& sample_of(const Setting& setting, const std::string& name);
  /// Values of an axis in all settings, NaN where one has none, in the unit of the first; empty
  /// unless all others are numbers.
  std::vector<double> numbers_of(std::size_t axis, std::string& unit) const;
  /// One series for all settings that agree but for the axis; none for a number that never differs.
  std::vector<report::Series> series_of(const std::string& name, std::size_t axis,
                                        const std::vector<double>& x) const;

  const TaskExperiment& list_;
  std::vector<std::string> axes_;
  std::vector<std::size_t> setting_axes_;  // places of those that are no seeds
  std::vector<std::string> names_;         // of the numbers, in the order of their first use
  std::set<std::string> known_names_;
  std::map<std::string, std::string> units_;  // by name
  std::map<std::vector<std::string>, std::size_t> setting_of_;
  std::vector<Setting> settings_;
  std::vector<RunTask> tasks_;
  std::vector<TasksOfReason> warned_;
};

}  // namespace modcal
