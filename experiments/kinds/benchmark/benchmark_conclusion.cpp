// What a benchmark says in plain language.
#include <fmt/ranges.h>

#include "experiments/kinds/benchmark/benchmark.hpp"

namespace modcal {
namespace {

constexpr std::size_t kMostNames = 4;

std::string listed(std::vector<std::string> names) {
  const std::size_t all = names.size();
  if (all <= kMostNames + 1) return fmt::format("{}", fmt::join(names, "; "));
  names.resize(kMostNames);
  return fmt::format("{}; {} more", fmt::join(names, "; "), all - kMostNames);
}

// "0.0012 to 0.0031", or one number where they print alike.
class Span {
 public:
  void add(double value) {
    if (!std::isfinite(value)) return;
    low_ = std::min(low_, value);
    high_ = std::max(high_, value);
  }
  bool empty() const { return low_ > high_; }
  std::string text(std::string_view format) const {
    const std::string low = fmt::format(fmt::runtime(format), low_);
    const std::string high = fmt::format(fmt::runtime(format), high_);
    return low == high ? low : low + " to " + high;
  }

 private:
  double low_ = std::numeric_limits<double>::infinity();
  double high_ = -std::numeric_limits<double>::infinity();
};

// "noise 1 %, 2 %, 5 %": what all begin with is said once.
std::string conditions_text(const std::vector<std::string>& conditions) {
  const std::string& first = conditions.front();
  const std::string prefix = first.substr(0, first.find(' ') + 1);
  std::string text = first;
  for (std::size_t i = 1; i < conditions.size(); ++i) {
    const bool same = !prefix.empty() && conditions[i].starts_with(prefix) &&
                      first.find(',') == std::string::npos;
    text += ", " + (same ? conditions[i].substr(prefix.size()) : conditions[i]);
  }
  return text;
}

// What to use under some neighbouring conditions, or why there is nothing to be used.
struct Advice {
  std::size_t method = 0;
  bool is_right = false;
  std::string reason = {};               // where it is not
  std::vector<std::size_t> others = {};  // not to be told apart from the method
  std::vector<std::string> conditions = {};
  Span error = {}, bound_ratio = {}, evaluations = {};
  std::size_t successes = 0, reasons = 0, n = 0;

  void add(const BenchmarkGrid& grid, const BenchmarkCell& cell) {
    conditions.push_back(grid.conditions[cell.condition]);
    error.add(cell.error.median);
    bound_ratio.add(cell.bound_ratio);
    evaluations.add(cell.evaluations);
    successes += cell.successes;
    reasons += cell.reason_count;
    n += cell.n;
  }
  std::string sentence(const BenchmarkGrid& grid) const;
};

std::string Advice::sentence(const BenchmarkGrid& grid) const {
  const std::string where = conditions_text(conditions);
  if (!is_right) {
    return fmt::format("At {}: no method is right; on {} of {} draws {} {}.", where, reasons, n,
                       grid.methods[method], reason);
  }
  const std::string bound =
      bound_ratio.empty() ? ""
                          : fmt::format(", RMSE {} times the bound", bound_ratio.text("{:.3g}"));
  std::string text = fmt::format(
      "At {}: use {} (median error {}{}, {} of {} right, {} evaluations)", where,
      grid.methods[method], error.text("{:.2g}"), bound, successes, n, evaluations.text("{:.0f}"));
  std::vector<std::string> names;
  for (const std::size_t other : others) names.push_back(grid.methods[other]);
  if (!names.empty()) {
    text += fmt::format("; not to be told apart from it: {}", listed(std::move(names)));
  }
  return text + ".";
}

using Cells = std::vector<const BenchmarkCell*>;

// Neighbouring conditions under which the same methods are the best, or none is right.
struct Stretch {
  std::vector<Cells> cells = {};          // of each condition, best first
  std::vector<std::size_t> methods = {};  // best under all of them; empty: none is right
};

std::vector<std::size_t> best_methods(const Cells& order) {
  std::vector<std::size_t> best;
  for (const BenchmarkCell* cell : order) {
    if (cell->rank == 1 && cell->successes > 0) best.push_back(cell->method);
  }
  return best;
}

const BenchmarkCell* cell_of(const Cells& cells, std::size_t method) {
  const auto found =
      std::ranges::find(cells, method, [](const BenchmarkCell* cell) { return cell->method; });
  return found == cells.end() ? nullptr : *found;
}

const BenchmarkCell& clearest_failure(const Cells& order) {
  return **std::ranges::max_element(order, {},
                                    [](const BenchmarkCell* cell) { return cell->reason_count; });
}

// What holds under neighbouring conditions is said once: as many of them as one method can serve.
std::vector<Stretch> stretches_of(const BenchmarkGrid& grid,
                                  const std::vector<BenchmarkCell>& cells) {
  std::vector<Stretch> stretches;
  for (std::size_t condition = 0; condition < grid.conditions.size(); ++condition) {
    const Cells order = ranked_cells(cells, condition);
    if (order.empty()) continue;
    const std::vector<std::size_t> best = best_methods(order);
    std::vector<std::size_t> both = stretches.empty() ? best : stretches.back().methods;
    std::erase_if(both, [&best](std::size_t method) { return !std::ranges::count(best, method); });
    const auto same_failure = [&] {
      const BenchmarkCell& before = clearest_failure(stretches.back().cells.back());
      const BenchmarkCell& now = clearest_failure(order);
      return stretches.back().methods.empty() && best.empty() && before.method == now.method &&
             before.reason == now.reason;
    };
    if (stretches.empty() || (both.empty() && !same_failure())) {
      stretches.push_back({.methods = best});
    } else {
      stretches.back().methods = both;
    }
    stretches.back().cells.push_back(order);
  }
  return stretches;
}

// The cheapest of the best methods, or the failure that is seen most often.
Advice advice_on(const BenchmarkGrid& grid, const Stretch& stretch) {
  Advice advice{.is_right = !stretch.methods.empty()};
  if (advice.is_right) {
    advice.method = *std::ranges::min_element(stretch.methods, {}, [&](std::size_t method) {
      double evaluations = 0.0;
      for (const Cells& cells : stretch.cells) evaluations += cell_of(cells, method)->evaluations;
      return evaluations;
    });
  } else {
    const BenchmarkCell& failure = clearest_failure(stretch.cells.front());
    advice.method = failure.method;
    advice.reason = failure.reason;
  }
  for (const std::size_t method : stretch.methods) {
    if (method != advice.method) advice.others.push_back(method);
  }
  for (const Cells& cells : stretch.cells) advice.add(grid, *cell_of(cells, advice.method));
  return advice;
}

// Cells of some methods whose draws are mostly wrong, told together.
struct Failures {
  std::size_t n = 0, wrong = 0;
  std::vector<std::string> conditions;
  std::map<std::string, std::size_t> reasons;

  void add(const BenchmarkGrid& grid, const BenchmarkCell& cell) {
    n += cell.n;
    wrong += cell.n - cell.successes;
    reasons[cell.reason] += cell.reason_count;
    const std::string& condition = grid.conditions[cell.condition];
    if (place_in(conditions, condition) == conditions.size()) conditions.push_back(condition);
  }
  std::string sentence(const BenchmarkGrid& grid, const std::string& who) const {
    const auto [reason, count] =
        *std::max_element(reasons.begin(), reasons.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; });
    const std::string where = conditions.size() == grid.conditions.size() && conditions.size() > 1
                                  ? "all conditions"
                                  : conditions_text(conditions);
    return fmt::format("{} fails on {} of {} draws at {}; {} {}.", who, wrong, n, where,
                       count == wrong ? "it" : fmt::format("on {} it", count), reason);
  }
};

bool is_failing(const BenchmarkCell& cell) { return cell.success.high < 0.5; }

bool fails_everywhere(const std::vector<BenchmarkCell>& cells, std::size_t method) {
  return std::all_of(cells.begin(), cells.end(), [method](const BenchmarkCell& cell) {
    return cell.method != method || is_failing(cell);
  });
}

Failures failures_of(const BenchmarkGrid& grid, const std::vector<BenchmarkCell>& cells,
                     const std::vector<std::size_t>& methods) {
  Failures failures;
  for (const BenchmarkCell& cell : cells) {
    const bool ours = std::find(methods.begin(), methods.end(), cell.method) != methods.end();
    if (ours && is_failing(cell)) failures.add(grid, cell);
  }
  return failures;
}

}  // namespace

std::vector<const BenchmarkCell*> ranked_cells(const std::vector<BenchmarkCell>& cells,
                                               std::size_t condition) {
  std::vector<const BenchmarkCell*> result;
  for (const BenchmarkCell& cell : cells) {
    if (cell.condition == condition) result.push_back(&cell);
  }
  std::stable_sort(result.begin(), result.end(), [](const auto* a, const auto* b) {
    if (a->rank != b->rank) return a->rank < b->rank;
    return a->successes * b->n > b->successes * a->n;
  });
  return result;
}

std::vector<std::string> recommendations(const BenchmarkGrid& grid,
                                         const std::vector<BenchmarkCell>& cells) {
  std::vector<std::string> sentences;
  for (const Stretch& stretch : stretches_of(grid, cells)) {
    sentences.push_back(advice_on(grid, stretch).sentence(grid));
  }
  return sentences;
}

std::vector<std::string> failing_methods(const BenchmarkGrid& grid,
                                         const std::vector<BenchmarkCell>& cells) {
  std::vector<std::string> sentences;
  for (const std::string& objective : distinct(grid.objectives)) {
    std::vector<std::size_t> methods;
    for (std::size_t method = 0; method < grid.methods.size(); ++method) {
      if (grid.objectives[method] == objective) methods.push_back(method);
    }
    // An objective that no optimizer gets right is one finding, not one an optimizer.
    const bool together =
        methods.size() > 1 && std::all_of(methods.begin(), methods.end(), [&](std::size_t method) {
          return fails_everywhere(cells, method);
        });
    if (together) {
      const Failures failures = failures_of(grid, cells, methods);
      if (failures.n > 0) {
        sentences.push_back(failures.sentence(grid, objective + " with every optimizer"));
      }
      continue;
    }
    for (const std::size_t method : methods) {
      const Failures failures = failures_of(grid, cells, {method});
      if (failures.n > 0) sentences.push_back(failures.sentence(grid, grid.methods[method]));
    }
  }
  return sentences;
}

}  // namespace modcal
