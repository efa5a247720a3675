// compare: which of two runs of a list is better.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "experiments/cli/command.hpp"
#include "experiments/cli/runner.hpp"
#include "experiments/study/sample.hpp"
#include "libsim/base/words.hpp"

namespace modcal {
namespace {

struct CompareArguments {
  std::string first, second;
  std::string number;
};

using Cell = std::map<std::string, std::string>;  // path of an axis to its value

Cell cell_of(const StoredRun& run, std::size_t task) {
  const std::vector<std::string> paths = run.list().axes();
  const std::vector<std::string> values = run.list().axis_values(task);
  Cell cell;
  for (std::size_t i = 0; i < paths.size(); ++i) cell[paths[i]] = values[i];
  return cell;
}

// How a sentence ends that a list has no number of this name.
std::string numbers_to_compare(const StoredRun& run, const std::string& number) {
  constexpr std::size_t kMostNamed = 8;
  std::vector<std::string> names;
  for (std::size_t task = 0; task < run.tasks() && names.empty(); ++task) {
    if (const auto finished = run.outcomes()[task])
      names = run.list().numbers_in(finished->outcome);
  }
  if (const std::string nearest = nearest_name(number, names); !nearest.empty()) {
    return fmt::format("; did you mean \"{}\"?", nearest);
  }
  if (!run.list().loss_name().empty()) {
    return fmt::format(": without --number the {} is compared", run.list().loss_name());
  }
  const bool all = names.size() <= kMostNamed;
  names.resize(std::min(names.size(), kMostNamed));
  return fmt::format(": it has {}{}; see the columns of tasks.csv", fmt::join(names, ", "),
                     all ? "" : ", …");
}

// Losses of the finished tasks by their cells, or the number of that name; a draw without a result
// is worse than any other.
std::map<Cell, double> losses_of(const StoredRun& run, const std::string& number) {
  MODCAL_REQUIRE(!number.empty() || !run.list().loss_name().empty(),
                 "{} holds a run of kind {}, whose tasks have no score of their own to compare: "
                 "name one with --number, a column of tasks.csv",
                 run.out().string(), run.loaded().kind);
  std::map<Cell, double> losses;
  bool any = number.empty();
  for (std::size_t task = 0; task < run.tasks(); ++task) {
    const std::optional<FinishedTask> finished = run.outcomes()[task];
    if (!finished) continue;
    const auto read = [&](const std::string& outcome) {
      return number.empty() ? run.list().loss_in(outcome) : run.list().number_in(outcome, number);
    };
    const std::optional<double> loss = run.outcomes().read(task, finished->outcome, read);
    any = any || loss;
    losses[cell_of(run, task)] = loss.value_or(1e300);
  }
  MODCAL_REQUIRE(any, "no task of {} has a number {}{}", run.out().string(), number,
                 numbers_to_compare(run, number));
  return losses;
}

std::string verdict(const MedianRatio& ratio, const std::string& a, const std::string& b) {
  if (ratio.is_below_one()) return a + " is better";
  if (ratio.is_above_one()) return b + " is better";
  return "the two cannot be told apart";
}

ExitCode compare(const CompareArguments& arguments) {
  const std::string &out_a = arguments.first, &out_b = arguments.second;
  // As a heading of settings.csv has it: without the unit.
  const std::string number = arguments.number.substr(0, arguments.number.find(" ["));
  const StoredRun run_a(out_a), run_b(out_b);
  MODCAL_REQUIRE(run_a.loaded().kind == run_b.loaded().kind,
                 "{} is of kind {}, {} of kind {}: their scores are different things", out_a,
                 run_a.loaded().kind, out_b, run_b.loaded().kind);
  const std::map<Cell, double> losses_a = losses_of(run_a, number);
  const std::map<Cell, double> losses_b = losses_of(run_b, number);
  std::vector<double> a, b;
  for (const auto& [cell, loss] : losses_a) {
    const auto other = losses_b.find(cell);
    if (other == losses_b.end()) continue;
    a.push_back(loss);
    b.push_back(other->second);
  }
  MODCAL_REQUIRE(!a.empty(), "{} and {} have no finished task with the same values in common",
                 out_a, out_b);
  const MedianRatio ratio = median_ratio(a, b);
  add_to_json("tasks_in_common", a.size());
  add_to_json("number", number.empty() ? run_a.list().loss_name() : number);
  add_to_json("medians", {quantile(a, 0.5), quantile(b, 0.5)});
  add_to_json("ratio", ratio.ratio);
  add_to_json("interval", {ratio.low, ratio.high});
  add_to_json("verdict", verdict(ratio, out_a, out_b));
  say("{} of {} and {} tasks in common\n", a.size(), losses_a.size(), losses_b.size());
  say("{}: median {:.4g} in {}, {:.4g} in {}\n", number.empty() ? run_a.list().loss_name() : number,
      quantile(a, 0.5), out_a, quantile(b, 0.5), out_b);
  say("ratio {:.4g}, 95 % interval {:.4g} to {:.4g} (paired bootstrap): {}\n", ratio.ratio,
      ratio.low, ratio.high, verdict(ratio, out_a, out_b));
  return ExitCode::kOk;
}

void declare_compare(CLI::App& command, CompareArguments& arguments) {
  command.add_option("a", arguments.first, "folder of results")->required();
  command.add_option("b", arguments.second, "another one")->required();
  command.add_option("--number", arguments.number,
                     "number of the tasks to compare, smaller is better; default: their score");
}

}  // namespace

void add_compare_command(CLI::App& app, const Chosen& chosen) {
  add_command(app, chosen, "compare", "Say which of two runs is better on the tasks they share",
              declare_compare, compare);
}

}  // namespace modcal
