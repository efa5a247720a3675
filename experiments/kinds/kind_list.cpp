#include "experiments/kinds/kind_list.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <set>

#include "experiments/study/sample.hpp"

namespace modcal {
namespace {

// What a search started from and how its parameters hang together tell nothing of the axes.
bool is_shown_first(const std::string& name) {
  return !name.ends_with(".initial") && !name.starts_with("correlation");
}

// Draws of one setting: tasks that differ in seeds alone.
struct Setting {
  std::vector<std::string> values;  ///< of the axes that are no seeds
  std::size_t n = 0, failures = 0, warned = 0;
  std::map<std::string, Sample> samples;
};

struct RunTask {
  std::size_t task = 0;
  RunOutcome outcome;
};

class RunSummary {
 public:
  explicit RunSummary(const TaskExperiment& list) : list_(list), axes_(list.axes()) {
    for (std::size_t i = 0; i < axes_.size(); ++i) {
      if (!is_seed_axis(axes_[i])) setting_axes_.push_back(i);
    }
  }

  void add(std::size_t task, RunOutcome outcome) {
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

  report::Table settings() const {
    report::Table table = report::table_of(
        {.id = "settings",
         .title = "Medians by setting",
         .caption = "Draws of one setting differ in their seeds alone."},
        settings_, [this](report::RowWriter& row, const Setting& setting) {
          for (std::size_t i = 0; i < setting.values.size(); ++i) {
            row({.key = axes_[setting_axes_[i]]}, setting.values[i]);
          }
          row({.key = "n"}, setting.n);
          row({.key = "failures"}, setting.failures);
          if (!warned_.empty()) row({.key = "warned"}, setting.warned);
          for (const std::string& name : names_) {
            row({.key = name, .unit = unit_of(name)}, known(sample_of(setting, name).median()));
          }
        });
    for (const Setting& setting : settings_) table.row_tags.push_back(tags_of(setting));
    return table;
  }

  std::string tasks_csv() const {
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

  const std::vector<TasksOfReason>& warned() const { return warned_; }

  /// Of two axes the medians of the first numbers that differ, a map each.
  std::vector<report::Table> maps() const {
    constexpr std::size_t kMostMaps = 6;
    std::vector<report::Table> maps;
    if (setting_axes_.size() != 2) return maps;
    for (const std::string& name : shown_first()) {
      report::Table map = this->map(name, maps.size() + 1);
      if (!map.rows.empty()) maps.push_back(std::move(map));
      if (maps.size() == kMostMaps) break;
    }
    return maps;
  }

  /// The first numbers that differ, a panel each, against the first axis of numbers, if any.
  report::Figure figure() const {
    constexpr std::size_t kMostPanels = 6;
    report::Figure figure{.id = "against_axis",
                          .title = "Results over the axes",
                          .caption = tasks_.size() > settings_.size()
                                         ? "Median and band from 10 % to 90 % of the draws."
                                         : "One draw of each setting.",
                          .columns = 3};
    for (std::size_t axis = 0; axis < setting_axes_.size(); ++axis) {
      std::string unit;
      const std::vector<double> x = numbers_of(axis, unit);
      if (x.empty()) continue;
      for (const std::string& name : shown_first()) {
        report::Panel panel{.x = {.label = axes_[setting_axes_[axis]], .unit = unit},
                            .y = {.label = name, .unit = unit_of(name)},
                            .series = series_of(name, axis, x)};
        if (!panel.series.empty()) figure.panels.push_back(std::move(panel));
        if (figure.panels.size() == kMostPanels) break;
      }
      break;
    }
    return figure;
  }

 private:
  // The numbers that answer, then the others.
  std::vector<std::string> shown_first() const {
    std::vector<std::string> names = names_;
    std::stable_partition(names.begin(), names.end(), is_shown_first);
    return names;
  }

  std::string unit_of(const std::string& name) const {
    const auto unit = units_.find(name);
    return unit == units_.end() ? std::string() : unit->second;
  }

  // By every axis but the one at which a series has all values.
  report::Tags tags_of(const Setting& setting,
                       std::size_t except = std::numeric_limits<std::size_t>::max()) const {
    report::Tags tags;
    for (std::size_t i = 0; i < setting.values.size(); ++i) {
      if (i != except) tags.push_back({axes_[setting_axes_[i]], {setting.values[i]}});
    }
    return tags;
  }

  // Rows and columns in the order of their first use, dark where the number is largest; without
  // rows where it is one number everywhere.
  report::Table map(const std::string& name, std::size_t number) const {
    std::vector<std::string> rows, columns;
    std::map<std::pair<std::string, std::string>, double> medians;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    const auto note = [](std::vector<std::string>& list, const std::string& value) {
      if (std::ranges::count(list, value) == 0) list.push_back(value);
    };
    for (const Setting& setting : settings_) {
      const Sample& sample = sample_of(setting, name);
      note(rows, setting.values[0]);
      note(columns, setting.values[1]);
      if (sample.values.empty()) continue;
      const double median = medians[{setting.values[0], setting.values[1]}] = sample.median();
      low = std::min(low, median);
      high = std::max(high, median);
    }
    report::Table table{.id = fmt::format("map_{}", number),
                        .title = name,
                        .caption = fmt::format("Medians; rows: {}, columns: {}.",
                                               axes_[setting_axes_[0]], axes_[setting_axes_[1]])};
    if (!(low < high)) return table;
    // Decades would leave one cell dark.
    const bool by_decades = low > 0.0 && high > 100.0 * low;
    const auto place = [by_decades](double x) { return by_decades ? std::log(x) : x; };
    for (const std::string& row : rows) {
      report::add_row(table, [&](report::RowWriter& writer) {
        writer({.key = axes_[setting_axes_[0]]}, row);
        for (const std::string& column : columns) {
          const auto found = medians.find({row, column});
          report::Cell cell = found == medians.end() ? report::Cell() : found->second;
          if (found != medians.end()) {
            cell.heat = (place(found->second) - place(low)) / (place(high) - place(low));
          }
          writer.cell({.key = column}, std::move(cell));
        }
      });
    }
    return table;
  }

  static const Sample& sample_of(const Setting& setting, const std::string& name) {
    static const Sample kNone;
    const auto found = setting.samples.find(name);
    return found == setting.samples.end() ? kNone : found->second;
  }

  // Values of an axis in all settings; empty unless all are numbers of one unit.
  std::vector<double> numbers_of(std::size_t axis, std::string& unit) const {
    std::vector<double> numbers;
    for (const Setting& setting : settings_) {
      const std::string& text = setting.values[axis];
      double number = 0.0;
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
      std::string rest(end, text.data() + text.size());
      rest.erase(0, rest.find_first_not_of(' '));
      if (error != std::errc() || (!numbers.empty() && rest != unit)) return {};
      unit = rest;
      numbers.push_back(number);
    }
    return numbers;
  }

  // One series for all settings that agree but for the axis; none for a number that never differs.
  std::vector<report::Series> series_of(const std::string& name, std::size_t axis,
                                        const std::vector<double>& x) const {
    std::vector<report::Series> series;
    std::map<std::vector<std::string>, std::size_t> known;
    std::set<double> medians;
    for (std::size_t s = 0; s < settings_.size(); ++s) {
      const Sample& sample = sample_of(settings_[s], name);
      if (sample.values.empty()) continue;
      std::vector<std::string> others = settings_[s].values;
      for (std::size_t i = 0; i < others.size(); ++i) {
        const std::string& path = axes_[setting_axes_[i]];
        others[i].insert(0, path.substr(path.rfind('.') + 1) + " ");
      }
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(axis));
      const auto [place, is_new] = known.try_emplace(others, series.size());
      if (is_new) {
        const auto color = std::min<std::size_t>(series.size() + 1, report::kColorRoles - 1);
        series.push_back(
            {.label = others.empty() ? "median" : fmt::format("{}", fmt::join(others, ", ")),
             .style = report::SeriesStyle::kLineWithPoints,
             .color = static_cast<report::ColorRole>(color),
             .tags = tags_of(settings_[s], axis)});
      }
      add_band(series[place->second], x[s], Spread::of(sample));
      medians.insert(sample.median());
    }
    if (medians.size() < 2) series.clear();
    return series;
  }

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

}  // namespace

StudyResult sum_up_runs(const TaskExperiment& list, const TaskOutcomes& outcomes) {
  StudyResult result;
  RunSummary summary(list);
  for_each_outcome<RunOutcome>(outcomes, result,
                               [&](std::size_t task, RunOutcome outcome, double /*seconds*/) {
                                 summary.add(task, std::move(outcome));
                               });
  report::Table settings = summary.settings();
  result.answer = fmt::format("{} settings, medians over their draws", settings.rows.size());
  result.summary = fmt::format("{} of {} tasks done, {} failed; {} settings, see tasks.csv\n",
                               outcomes.size() - result.pending_tasks, outcomes.size(),
                               result.failed_tasks, settings.rows.size());
  warn_of(summary.warned(), result);
  report::Figure figure = summary.figure();
  if (!figure.panels.empty()) {
    result.blocks.emplace_back(std::move(figure));
  } else {
    result.add(summary.maps());
  }
  result.end_first_screen();
  result.blocks.emplace_back(std::move(settings));
  result.files.emplace_back("tasks.csv", summary.tasks_csv());
  return result;
}

}  // namespace modcal
