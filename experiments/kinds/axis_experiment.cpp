#include "experiments/kinds/axis_experiment.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

namespace modcal {

std::vector<Finding> distinct_findings(std::vector<Finding> findings) {
  std::set<std::pair<std::string, std::string>> known;
  std::erase_if(findings, [&known](const Finding& finding) {
    return !known.insert({finding.path, finding.text}).second;
  });
  return findings;
}

bool is_read_with_record(const std::string& path) {
  return path.starts_with("record.") || path.starts_with("string.") || path.starts_with("bow.");
}

void place_on_axes(const std::vector<std::string>& paths, const std::vector<std::string>& values,
                   std::vector<Finding>& findings) {
  const auto holds = [](const std::string& section, const std::string& path) {
    return path == section || path.starts_with(section + ".");
  };
  for (Finding& finding : findings) {
    for (std::size_t i = 0; i < paths.size(); ++i) {
      if (finding.path.empty()) continue;
      if (!holds(paths[i], finding.path) && !holds(finding.path, paths[i])) continue;
      finding.axis = paths[i];
      finding.value = values[i];
      if (paths[i] == finding.path) break;
    }
  }
}

std::vector<Finding> findings_of_list(const std::vector<std::vector<Finding>>& of_tasks) {
  std::map<std::string, std::size_t> idle_tasks;
  for (const std::vector<Finding>& findings : of_tasks) {
    std::set<std::string> paths;
    for (const Finding& finding : findings) {
      if (finding.is_idle) paths.insert(finding.path);
    }
    for (const std::string& path : paths) ++idle_tasks[path];
  }
  std::vector<Finding> all;
  for (const std::vector<Finding>& findings : of_tasks) {
    std::ranges::copy_if(findings, std::back_inserter(all), [&](const Finding& finding) {
      return !finding.is_idle || idle_tasks[finding.path] == of_tasks.size();
    });
  }
  return distinct_findings(std::move(all));
}

SweepAxis axis_of(std::string path, std::size_t count,
                  const std::function<std::string(std::size_t)>& text_of) {
  SweepAxis axis{std::move(path), {}};
  for (std::size_t i = 0; i < count; ++i) axis.values.push_back(text_of(i));
  return axis;
}

std::size_t ProductExperiment::task_count() const {
  std::size_t count = 1;
  for (const SweepAxis& axis : axes_) count *= axis.values.size();
  return count;
}

std::vector<std::string> ProductExperiment::axes() const {
  std::vector<std::string> paths;
  for (const SweepAxis& axis : axes_) paths.push_back(axis.path);
  return paths;
}

std::vector<std::string> ProductExperiment::axis_values(std::size_t task) const {
  std::vector<std::string> values;
  for (std::size_t i = 0; i < axes_.size(); ++i) values.push_back(axes_[i].values[place(task, i)]);
  return values;
}

std::size_t ProductExperiment::place(std::size_t task, std::size_t axis) const {
  for (std::size_t i = axes_.size(); --i > axis;) task /= axes_[i].values.size();
  return task % axes_[axis].values.size();
}

std::vector<PlanLine> axis_plan(const SweepPlan& plan, std::size_t tasks,
                                const std::optional<PlannedSimulations>& planned) {
  std::vector<PlanLine> lines;
  const auto add = [&lines](std::string text, const std::vector<std::string>& paths,
                            std::size_t values) {
    lines.push_back(
        {std::move(text),
         {{"axes", nlohmann::ordered_json::array({{{"paths", paths}, {"values", values}}})}}});
  };
  for (const SweepAxis& axis : plan.product) {
    add(fmt::format("axis {}: {} values", axis.path, axis.values.size()), {axis.path},
        axis.values.size());
  }
  for (const std::vector<SweepAxis>& group : plan.zip) {
    std::vector<std::string> paths;
    for (const SweepAxis& axis : group) paths.push_back(axis.path);
    const std::size_t values = group.front().values.size();
    add(fmt::format("axes {} together: {} values", fmt::join(paths, ", "), values), paths, values);
  }
  lines.push_back({fmt::format("tasks: {}", tasks), {{"tasks", tasks}}});
  if (planned) {
    lines.push_back(plan_line(*planned));
    const std::size_t shared = tasks - std::min(tasks, planned->count);
    lines.push_back({fmt::format("skipped: {} simulations whose scene another task has", shared),
                     {{"shared_simulations", shared}}});
  }
  return lines;
}

std::optional<PlannedSimulations> planned_together(
    std::optional<PlannedSimulations> base, std::size_t cells,
    const std::function<std::optional<PlannedSimulations>(std::size_t)>& planned_of) {
  if (!base) return base;
  std::set<std::string> known;
  base->count = 0;
  for (std::size_t i = 0; i < cells; ++i) {
    const std::optional<PlannedSimulations> planned = planned_of(i);
    if (planned && known.insert(key_of(*planned)).second) base->count += planned->count;
  }
  return base;
}

}  // namespace modcal
