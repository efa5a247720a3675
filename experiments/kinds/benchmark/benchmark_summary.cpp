#include "experiments/kinds/benchmark/benchmark.hpp"

namespace modcal {
namespace {

// Stands for an error without bound, finite so that quantiles between two of them exist.
constexpr double kNoEstimate = 1e300;

// What draws are compared by: worse than anything where there is no estimate.
double loss_of(const BenchmarkOutcome& outcome) {
  const bool none = !outcome.failure.empty() || !std::isfinite(outcome.frequency_error);
  return none ? kNoEstimate : outcome.frequency_error;
}

using Losses = std::map<std::string, double>;  // by replicate

std::vector<double> values_of(const Losses& losses) {
  std::vector<double> values;
  for (const auto& [replicate, loss] : losses) values.push_back(loss);
  return values;
}

bool have_the_same_draws(const std::vector<const Losses*>& losses) {
  return std::all_of(losses.begin(), losses.end(), [&losses](const Losses* theirs) {
    return std::equal(theirs->begin(), theirs->end(), losses.front()->begin(),
                      losses.front()->end(),
                      [](const auto& a, const auto& b) { return a.first == b.first; });
  });
}

int sign_of(const MedianRatio& ratio) {
  return ratio.is_below_one() ? -1 : ratio.is_above_one() ? 1 : 0;
}

// Of a few draws resampling tells nothing, but none is worse than any.
int by_estimates(const BenchmarkCell& ours, const BenchmarkCell& theirs) {
  return static_cast<int>(ours.task < 0) - static_cast<int>(theirs.task < 0);
}

// −1: ours are smaller beyond doubt, 1: theirs are, 0: nobody knows.
int compared(const Losses& ours, const Losses& theirs) {
  std::vector<double> a, b;
  for (const auto& [replicate, loss] : ours) {
    const auto other = theirs.find(replicate);
    if (other == theirs.end()) continue;
    a.push_back(loss);
    b.push_back(other->second);
  }
  return a.empty() ? 0 : sign_of(median_ratio(a, b));
}

void count_reasons(const std::vector<const BenchmarkTask*>& tasks, BenchmarkCell& cell) {
  std::map<std::string, std::size_t> counts;
  for (const BenchmarkTask* task : tasks) {
    const std::string reason = reason_of(task->outcome);
    if (!reason.empty()) ++counts[reason];
  }
  for (const auto& [reason, count] : counts) {
    if (count <= cell.reason_count) continue;
    cell.reason = reason;
    cell.reason_count = count;
  }
}

std::int64_t median_task(std::vector<const BenchmarkTask*> tasks) {
  std::erase_if(tasks, [](const BenchmarkTask* task) {
    return !std::isfinite(task->outcome.frequency_error) || !task->outcome.failure.empty();
  });
  if (tasks.empty()) return -1;
  const auto middle = tasks.begin() + static_cast<std::ptrdiff_t>(tasks.size() / 2);
  std::nth_element(tasks.begin(), middle, tasks.end(), [](const auto* a, const auto* b) {
    return a->outcome.frequency_error < b->outcome.frequency_error;
  });
  return static_cast<std::int64_t>((*middle)->task);
}

BenchmarkCell sum_up(const std::vector<const BenchmarkTask*>& tasks) {
  BenchmarkCell cell{.n = tasks.size()};
  Sample errors, rms_errors, squares, bound_squares, contact_errors, correlations, evaluations;
  Sample seconds;
  for (const BenchmarkTask* task : tasks) {
    seconds.add(task->seconds);
    const BenchmarkOutcome& outcome = task->outcome;
    if (!outcome.failure.empty()) {
      ++cell.failures;
      continue;
    }
    if (outcome.success) ++cell.successes;
    errors.add(outcome.frequency_error);
    rms_errors.add(outcome.frequency_rms_error);
    squares.add(outcome.frequency_rms_error * outcome.frequency_rms_error);
    bound_squares.add(outcome.frequency_bound * outcome.frequency_bound);
    contact_errors.add(outcome.contact_error);
    correlations.add(outcome.correlation);
    evaluations.add(static_cast<double>(outcome.evaluations));
  }
  cell.success = success_share(cell.successes, cell.n);
  cell.error = Spread::of(errors);
  cell.rms = Spread::of(rms_errors);
  cell.rmse = std::sqrt(mean(squares.values));
  cell.bound = std::sqrt(mean(bound_squares.values));
  cell.bound_ratio = cell.rmse / cell.bound;
  cell.task = median_task(tasks);
  cell.contact_error = contact_errors.median();
  cell.correlation = correlations.median();
  cell.evaluations = evaluations.median();
  cell.seconds = seconds.median();
  count_reasons(tasks, cell);
  return cell;
}

void rank(const std::vector<const Losses*>& losses, std::vector<BenchmarkCell*>& cells) {
  for (BenchmarkCell* cell : cells) cell->rank = 1;
  // While a run goes on, methods may have different draws; then every pair is resampled by itself.
  std::vector<BootstrapMedians> medians;
  if (have_the_same_draws(losses)) {
    for (const Losses* own : losses) medians.emplace_back(values_of(*own));
  }
  for (std::size_t i = 0; i < cells.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      int order = by_estimates(*cells[i], *cells[j]);
      if (order == 0) {
        order = medians.empty() ? compared(*losses[i], *losses[j])
                                : sign_of(median_ratio(medians[i], medians[j]));
      }
      if (order != 0) ++cells[order < 0 ? j : i]->rank;
    }
  }
}

}  // namespace

SuccessShare success_share(std::size_t successes, std::size_t n) {
  if (n == 0) return {0.0, 0.0, 1.0};
  constexpr double kZ = 1.959963984540054;  // 97.5 % quantile of the normal distribution
  const double count = static_cast<double>(n);
  const double share = static_cast<double>(successes) / count;
  const double scale = 1.0 / (1.0 + kZ * kZ / count);
  const double center = (share + kZ * kZ / (2.0 * count)) * scale;
  const double half =
      kZ * scale * std::sqrt(share * (1.0 - share) / count + kZ * kZ / (4.0 * count * count));
  return {share, std::max(0.0, center - half), std::min(1.0, center + half)};
}

std::vector<BenchmarkCell> benchmark_cells(const BenchmarkGrid& grid) {
  std::map<std::pair<std::size_t, std::size_t>, std::vector<const BenchmarkTask*>> groups;
  for (const BenchmarkTask& task : grid.tasks) {
    groups[{task.condition, task.method}].push_back(&task);
  }
  std::vector<BenchmarkCell> cells;
  std::vector<Losses> losses;
  for (const auto& [key, tasks] : groups) {
    cells.push_back(sum_up(tasks));
    cells.back().condition = key.first;
    cells.back().method = key.second;
    losses.emplace_back();
    for (const BenchmarkTask* task : tasks) {
      losses.back()[task->replicate] = loss_of(task->outcome);
    }
  }
  // A condition a task: its cells are its own.
  for_each_task(grid.conditions.size(), [&](std::size_t condition) {
    std::vector<BenchmarkCell*> together;
    std::vector<const Losses*> their_losses;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (cells[i].condition != condition) continue;
      together.push_back(&cells[i]);
      their_losses.push_back(&losses[i]);
    }
    rank(their_losses, together);
  });
  return cells;
}

std::size_t place_in(const std::vector<std::string>& values, const std::string& value) {
  return static_cast<std::size_t>(std::find(values.begin(), values.end(), value) - values.begin());
}

std::vector<std::string> distinct(const std::vector<std::string>& values) {
  std::vector<std::string> result;
  for (const std::string& value : values) {
    if (place_in(result, value) == result.size()) result.push_back(value);
  }
  return result;
}

std::string short_label(const std::string& value) {
  std::string label;
  for (const char letter : value) {
    if (std::string_view("{}\"',").find(letter) != std::string_view::npos) continue;
    if (letter == ':') {
      // The key is dropped: what it says is in the value or in the experiment.
      const std::size_t start = label.find_last_of(' ');
      label.resize(start == std::string::npos ? 0 : start);
      continue;
    }
    label += letter;
  }
  const std::size_t first = label.find_first_not_of(' ');
  return first == std::string::npos ? std::string() : label.substr(first);
}

}  // namespace modcal
