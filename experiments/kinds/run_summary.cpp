#include "experiments/kinds/run_summary.hpp"

#include <fmt/ranges.h>

#include <algorithm>

namespace modcal {

RunSummary::RunSummary(const TaskExperiment& list) : list_(list), axes_(list.axes()) {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (!is_seed_axis(axes_[i])) setting_axes_.push_back(i);
  }
}

void RunSummary::add(std::size_t task, RunOutcome outcome) {
  const std::vector<std::string> all = list_.axis_values(task);
  std::vector<std::string> values;
  for (const std::size_t axis : setting_axes_) values.push_back(all[axis]);
  const auto [place, is_new] = setting_of_.try_emplace(values, settings_.size());
  if (is_new) settings_.push_back({.values = values});
  Setting& setting = settings_[place->second];
  ++setting.n;
  if (!outcome.failure.empty()) ++setting.failures;
  if (!outcome.warnings.empty()) ++setting.warned;
  for (const std::string& text : outcome.warnings) add_reason(task, text, warned_);
  for (const auto& [name, value] : outcome.numbers) {
    if (known_names_.insert(name).second) names_.push_back(name);
    if (std::isfinite(value)) setting.samples[name].add(value);
  }
  for (const auto& [name, unit] : outcome.units) units_.try_emplace(name, unit);
  tasks_.push_back({task, std::move(outcome)});
}

report::Table RunSummary::settings() const {
  std::set<std::string> missing;
  for (const std::string& name : names_) {
    if (is_missing_somewhere(name)) missing.insert(name);
  }
  report::Table table = report::table_of(
      {.id = "settings",
       .title = "Medians by setting",
       .caption = std::string("Draws of one setting differ in their seeds alone.") +
                  (missing.empty() ? "" : " Column .n: draws that have the number before it.")},
      settings_, [&](report::RowWriter& row, const Setting& setting) {
        for (std::size_t i = 0; i < setting.values.size(); ++i) {
          row({.key = axes_[setting_axes_[i]]}, setting.values[i]);
        }
        row({.key = "n"}, setting.n);
        row({.key = "failures"}, setting.failures);
        if (!warned_.empty()) row({.key = "warned"}, setting.warned);
        for (const std::string& name : names_) {
          const Sample& sample = sample_of(setting, name);
          row({.key = name, .unit = unit_of(name)}, known(sample.median()));
          if (missing.contains(name)) row({.key = name + ".n"}, sample.values.size());
        }
      });
  for (const Setting& setting : settings_) table.row_tags.push_back(tags_of(setting));
  return table;
}

std::string RunSummary::tasks_csv() const {
  const auto write_task = [this](report::RowWriter& row, const RunTask& task) {
    row({.key = "task"}, task.task);
    const std::vector<std::string> values = list_.axis_values(task.task);
    for (std::size_t i = 0; i < axes_.size(); ++i) row({.key = axes_[i]}, values[i]);
    const std::map<std::string, double> numbers(task.outcome.numbers.begin(),
                                                task.outcome.numbers.end());
    for (const std::string& name : names_) {
      const auto number = numbers.find(name);
      row.cell({.key = name}, number == numbers.end() ? report::Cell() : number->second);
    }
    row.cell({.key = "failure"},
             task.outcome.failure.empty() ? report::Cell() : task.outcome.failure);
    const std::vector<std::string>& warnings = task.outcome.warnings;
    row.cell({.key = "warnings"},
             warnings.empty() ? report::Cell() : fmt::format("{}", fmt::join(warnings, "; ")));
  };
  report::Table table{.id = "tasks"};
  for (const RunTask& task : tasks_) {
    report::add_row(table, [&](report::RowWriter& row) { write_task(row, task); });
  }
  return report::table_csv(table);
}

std::string RunSummary::unit_of(const std::string& name) const {
  const auto unit = units_.find(name);
  return unit == units_.end() ? std::string() : unit->second;
}

bool RunSummary::is_missing_somewhere(const std::string& name) const {
  return std::ranges::any_of(settings_, [&](const Setting& setting) {
    const std::size_t there = sample_of(setting, name).values.size();
    return there > 0 && there < setting.n - setting.failures;
  });
}

const Sample& RunSummary::sample_of(const Setting& setting, const std::string& name) {
  static const Sample kNone;
  const auto found = setting.samples.find(name);
  return found == setting.samples.end() ? kNone : found->second;
}

}  // namespace modcal
