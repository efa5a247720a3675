#include "libinverse/observer/gain_search.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>

#include "libsim/base/task_loop.hpp"

namespace modcal::observer {
namespace {

struct Candidate {
  ObserverState state;
  double cost = 0.0;
};

struct Step {
  std::size_t parent = 0, gain = 0;
};

double block_cost(const ObservedRecord& record, const ObserverSignals& outputs, std::size_t first,
                  std::size_t last) {
  double sum = 0.0;
  for (std::size_t k = first; k < last; ++k) {
    const double left = outputs.left_innovation[k - first] / record.noise[0];
    const double right = outputs.right_innovation[k - first] / record.noise[1];
    sum += left * left + right * right;
  }
  return sum;
}

class Search {
 public:
  Search(const ObserverRuns& runs, const ObserverParameters& parameters,
         std::span<const std::size_t> gains, const GainSearchOptions& options)
      : record_(runs.record()),
        observer_(runs.prepare(parameters)),
        gains_(gains),
        options_(options) {}

  GainSchedule run() {
    std::vector<Candidate> alive(1);
    alive[0].state = observer_.initial_state();
    std::vector<std::vector<Step>> history;
    const std::size_t samples = record_.samples();
    for (std::size_t first = 0; first < samples; first += kBlock) {
      std::vector<Candidate> next(alive.size() * gains_.size());
      for_each_task(next.size(), [&](std::size_t i) {
        next[i] = advanced(alive[i / gains_.size()], gains_[i % gains_.size()], first,
                           std::min(samples, first + kBlock));
      });
      std::vector<std::size_t> order(next.size());
      std::iota(order.begin(), order.end(), std::size_t{0});
      std::stable_sort(order.begin(), order.end(),
                       [&](std::size_t a, std::size_t b) { return next[a].cost < next[b].cost; });
      order.resize(std::min(order.size(), options_.survivors));
      std::vector<Step> steps;
      std::vector<Candidate> kept;
      for (const std::size_t i : order) {
        steps.push_back({i / gains_.size(), gains_[i % gains_.size()]});
        kept.push_back(std::move(next[i]));
      }
      alive = std::move(kept);
      history.push_back(std::move(steps));
    }
    return path_of_best(history);
  }

 private:
  Candidate advanced(const Candidate& from, std::size_t gain, std::size_t first,
                     std::size_t last) const {
    Candidate result = from;
    std::array<double, kBlock> left, right;
    ObserverSignals outputs;
    outputs.left_innovation = left.data();
    outputs.right_innovation = right.data();
    observer_.run_block(gain, first, last, result.state, outputs);
    result.cost = options_.forgetting * from.cost + block_cost(record_, outputs, first, last);
    // A state that ran away must not survive by comparing false with everything.
    if (!(result.cost < std::numeric_limits<double>::infinity())) {
      result.cost = std::numeric_limits<double>::infinity();
    }
    return result;
  }

  static GainSchedule path_of_best(const std::vector<std::vector<Step>>& history) {
    GainSchedule schedule(history.size());
    std::size_t at = 0;
    for (std::size_t block = history.size(); block-- > 0;) {
      schedule[block] = history[block][at].gain;
      at = history[block][at].parent;
    }
    return schedule;
  }

  const ObservedRecord& record_;
  PreparedObserver observer_;
  std::span<const std::size_t> gains_;
  GainSearchOptions options_;
};

}  // namespace

GainSchedule search_gains(const ObserverRuns& runs, const ObserverParameters& parameters,
                          std::span<const std::size_t> gains, const GainSearchOptions& options) {
  return Search(runs, parameters, gains, options).run();
}

}  // namespace modcal::observer
