#include "experiments/runs/price.hpp"

#include <fmt/format.h>

#include <cmath>
#include <ctime>
#include <set>

#include "experiments/runs/task_experiment.hpp"

namespace modcal {
namespace {

double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Mean {
  double sum = 0.0;
  std::size_t count = 0;
  void add(double value) {
    sum += value;
    ++count;
  }
  double value() const { return count > 0 ? sum / static_cast<double>(count) : 0.0; }
};

// Checksum, key, number and time of a line of the journal, about.
constexpr double kJournalOverhead = 70.0;

// The k-th of the numbers that fill [0, count) evenly, however many are taken.
std::size_t spread_index(std::size_t k, std::size_t count) {
  const double share = std::fmod(0.5 + 0.6180339887498949 * static_cast<double>(k), 1.0);
  return static_cast<std::size_t>(share * static_cast<double>(count));
}

}  // namespace

Price price_of_tasks(const TaskExperiment& list, std::size_t simulations,
                     const StudyContext& context, double budget) {
  const std::size_t count = list.task_count();
  std::set<std::size_t> done;
  Mean with_simulation, without, bytes;
  const double start = processor_seconds();
  for (std::size_t k = 0; done.size() < count && processor_seconds() - start < budget; ++k) {
    const std::size_t task = k < 4 * count ? spread_index(k, count) : k - 4 * count;
    if (task >= count) break;
    if (!done.insert(task).second) continue;
    const std::size_t before = context.work.truths.simulated();
    const double begin = processor_seconds();
    const std::string outcome = list.run_task(task, context);
    const double seconds = processor_seconds() - begin;
    (context.work.truths.simulated() > before ? with_simulation : without).add(seconds);
    bytes.add(static_cast<double>(outcome.size()) + kJournalOverhead);
  }
  Price price;
  const auto tasks = static_cast<double>(count);
  if (with_simulation.count > 0 && without.count > 0) {
    price.core_seconds =
        tasks * without.value() +
        static_cast<double>(simulations) * std::max(0.0, with_simulation.value() - without.value());
  } else {
    price.core_seconds = tasks * (with_simulation.count > 0 ? with_simulation : without).value();
  }
  price.disk_bytes = tasks * bytes.value();
  price.basis = fmt::format("measured on {} of {} tasks, {:.2g} s", done.size(), count,
                            processor_seconds() - start);
  return price;
}

Price price_of_simulations(const SimulationPlan& plan, const PlannedSimulations& planned) {
  return {.core_seconds = static_cast<double>(planned.count) * plan.seconds(planned.scene.duration),
          .disk_bytes = {},
          .basis = fmt::format("the simulation alone, measured on the first {:.3g} s of {:g} s",
                               plan.piece, planned.scene.duration)};
}

std::string text_of(const Price& price, std::size_t threads) {
  std::string text = fmt::format("{:.3g} core-seconds ({:.3g} core-hours)", price.core_seconds,
                                 price.core_seconds / 3600.0);
  if (threads > 1) {
    text += fmt::format(", {:.3g} s on {} threads",
                        price.core_seconds / static_cast<double>(threads), threads);
  }
  if (price.disk_bytes) text += fmt::format(", {:.3g} MB on disk", 1e-6 * *price.disk_bytes);
  return text;
}

}  // namespace modcal
