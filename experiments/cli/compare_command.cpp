#include <fmt/format.h>

#include <cstdio>
#include <map>

#include "experiments/cli/command.hpp"
#include "experiments/cli/stored_run.hpp"
#include "experiments/study/paired_bootstrap.hpp"
#include "libsim/base/error.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

using Cell = std::map<std::string, std::string>;  // path of an axis to its value

Cell cell_of(const StoredRun& run, std::size_t task) {
  const std::vector<std::string> paths = run.list().axes();
  const std::vector<std::string> values = run.list().axis_values(task);
  Cell cell;
  for (std::size_t i = 0; i < paths.size(); ++i) cell[paths[i]] = values[i];
  return cell;
}

// Losses of the finished tasks by their cells; a draw without a result is worse than any other.
std::map<Cell, double> losses_of(const StoredRun& run) {
  MODCAL_REQUIRE(!run.list().loss_name().empty(),
                 "{} holds a run of kind {}, whose tasks have no score to compare",
                 run.out().string(), run.loaded().kind);
  std::map<Cell, double> losses;
  for (std::size_t task = 0; task < run.tasks(); ++task) {
    const std::optional<FinishedTask> finished = run.outcomes()[task];
    if (!finished) continue;
    losses[cell_of(run, task)] = run.list().loss_in(finished->outcome).value_or(1e300);
  }
  return losses;
}

std::string verdict(const MedianRatio& ratio, const std::string& a, const std::string& b) {
  if (ratio.is_below_one()) return a + " is better";
  if (ratio.is_above_one()) return b + " is better";
  return "the two cannot be told apart";
}

ExitCode compare(const std::string& out_a, const std::string& out_b) {
  const StoredRun run_a(out_a), run_b(out_b);
  MODCAL_REQUIRE(run_a.loaded().kind == run_b.loaded().kind,
                 "{} is of kind {}, {} of kind {}: their scores are different things", out_a,
                 run_a.loaded().kind, out_b, run_b.loaded().kind);
  const std::map<Cell, double> losses_a = losses_of(run_a), losses_b = losses_of(run_b);
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
  fmt::print("{} of {} and {} tasks in common\n", a.size(), losses_a.size(), losses_b.size());
  fmt::print("{}: median {:.4g} in {}, {:.4g} in {}\n", run_a.list().loss_name(), quantile(a, 0.5),
             out_a, quantile(b, 0.5), out_b);
  fmt::print("ratio {:.4g}, 95 % interval {:.4g} to {:.4g} (paired bootstrap): {}\n", ratio.ratio,
             ratio.low, ratio.high, verdict(ratio, out_a, out_b));
  return ExitCode::kOk;
}

}  // namespace

void add_compare_command(CLI::App& app, const Chosen& chosen) {
  CLI::App* command =
      app.add_subcommand("compare", "Say which of two runs is better on the tasks they share");
  auto a = std::make_shared<std::string>();
  auto b = std::make_shared<std::string>();
  command->add_option("a", *a, "folder of results")->required();
  command->add_option("b", *b, "another one")->required();
  command->callback([=] { chosen([=] { return compare(*a, *b); }); });
}

}  // namespace modcal
