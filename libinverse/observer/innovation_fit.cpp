#include "libinverse/observer/innovation_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "libinverse/observer/tuning.hpp"
#include "libsim/base/dense_solvers.hpp"
#include "libsim/base/task_loop.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal::observer {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kDifference = 0.1, kMuting = 6.0, kLongestStep = 12.0;

double cost_of(const Innovations& innovations, std::span<const double> weight) {
  double sum = 0.0;
  for (const auto& scaled : innovations.scaled) {
    for (std::size_t k = 0; k < scaled.size(); ++k) sum += weight[k] * huber(scaled[k]);
  }
  return sum;
}

// Innovations at x and their Jacobian in unit steps, one column a parameter.
struct Linearization {
  Innovations at;
  std::vector<Innovations> slope;
  std::vector<double> weight;  // w_k of the sample
};

void mute(Linearization& l) {
  const std::size_t samples = l.at.scaled[0].size();
  std::vector<double> size(samples, 0.0);
  for (const Innovations& slope : l.slope) {
    for (const auto& scaled : slope.scaled) {
      for (std::size_t k = 0; k < samples; ++k) size[k] += scaled[k] * scaled[k];
    }
  }
  const double limit = kMuting * std::sqrt(quantile(size, 0.5));
  l.weight.resize(samples);
  for (std::size_t k = 0; k < samples; ++k) {
    const double norm = std::sqrt(size[k]);
    const double share = norm > limit ? limit / norm : 1.0;
    l.weight[k] = share * share;
  }
}

struct NormalEquations {
  MatrixXd matrix;
  VectorXd gradient;
};

class Fit {
 public:
  Fit(const ObserverRuns& runs, const ParameterSpace& space, const GainSchedule& schedule,
      const FitLimits& limits)
      : runs_(runs),
        space_(space),
        schedule_(schedule),
        limits_(limits),
        samples_(limits.samples == 0 ? runs.record().samples()
                                     : std::min(limits.samples, runs.record().samples())) {}

  FitOutcome run() {
    outcome_.x.assign(space_.size(), 0.0);
    double damping = 1e-2;
    for (; outcome_.iterations < limits_.iterations; ++outcome_.iterations) {
      const Linearization l = linearize();
      outcome_.cost = cost_of(l.at, l.weight) + space_.penalty(outcome_.x);
      const NormalEquations equations = normal_equations(l);
      double fall = 0.0;
      for (int attempt = 0; attempt < 3 && !(fall > 0.0); ++attempt) {
        fall = try_step(l, equations, damping);
      }
      if (!(fall > std::max(1.0, limits_.smallest_gain * outcome_.cost))) break;
    }
    return outcome_;
  }

 private:
  Innovations at(std::span<const double> x) {
    limits_.stop.throw_if_requested();
    return runs_.innovations(space_.at(x), schedule_, samples_);
  }

  Linearization linearize() {
    Linearization l;
    l.slope.resize(space_.size());
    for_each_task(space_.size() + 1, [&](std::size_t i) {
      if (i == space_.size()) {
        l.at = at(outcome_.x);
        return;
      }
      std::vector<double> x = outcome_.x;
      x[i] = outcome_.x[i] - kDifference;
      const Innovations below = at(x);
      x[i] = outcome_.x[i] + kDifference;
      l.slope[i] = at(x);
      for (int r = 0; r < 2; ++r) {
        for (std::size_t k = 0; k < samples_; ++k) {
          l.slope[i].scaled[r][k] =
              (l.slope[i].scaled[r][k] - below.scaled[r][k]) / (2.0 * kDifference);
        }
      }
    });
    outcome_.runs += 2 * space_.size() + 1;
    mute(l);
    return l;
  }

  NormalEquations normal_equations(const Linearization& l) const {
    const auto size = static_cast<Eigen::Index>(space_.size());
    NormalEquations e{MatrixXd::Zero(size, size), VectorXd::Zero(size)};
    std::vector<double> weighted(samples_);
    for (int r = 0; r < 2; ++r) {
      const std::vector<double>& residual = l.at.scaled[r];
      for (Eigen::Index i = 0; i < size; ++i) {
        const std::vector<double>& column = l.slope[static_cast<std::size_t>(i)].scaled[r];
        for (std::size_t k = 0; k < samples_; ++k) {
          const double robust =
              std::min(1.0, kHuberCorner / std::max(kHuberCorner, std::abs(residual[k])));
          weighted[k] = l.weight[k] * robust * column[k];
        }
        const Eigen::Map<const VectorXd> w(weighted.data(), static_cast<Eigen::Index>(samples_));
        e.gradient(i) += w.dot(Eigen::Map<const VectorXd>(residual.data(), w.size()));
        for (Eigen::Index j = 0; j <= i; ++j) {
          const auto& other = l.slope[static_cast<std::size_t>(j)].scaled[r];
          e.matrix(i, j) += w.dot(Eigen::Map<const VectorXd>(other.data(), w.size()));
        }
      }
    }
    e.matrix = MatrixXd(e.matrix.selfadjointView<Eigen::Lower>());
    for (Eigen::Index i = 0; i < size; ++i) {
      const FreeParameter& free = space_.free()[static_cast<std::size_t>(i)];
      if (std::isinf(free.prior)) continue;
      const double precision = 1.0 / (free.prior * free.prior);
      e.matrix(i, i) += precision;
      e.gradient(i) += precision * (outcome_.x[static_cast<std::size_t>(i)] - free.center);
    }
    return e;
  }

  std::vector<double> stepped(const NormalEquations& e, double damping) const {
    MatrixXd matrix = e.matrix;
    const double floor = 1e-9 * matrix.diagonal().maxCoeff();
    matrix.diagonal() =
        matrix.diagonal() * (1.0 + damping) + VectorXd::Constant(matrix.rows(), floor);
    const VectorXd step = -SemidefiniteSolver(matrix).solve(e.gradient);
    const double longest = step.cwiseAbs().maxCoeff();
    const double scale = longest > kLongestStep ? kLongestStep / longest : 1.0;
    std::vector<double> x = outcome_.x;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += scale * step(static_cast<Eigen::Index>(i));
    return x;
  }

  // Takes the better of two dampings if it lowers the cost; returns by how much.
  double try_step(const Linearization& l, const NormalEquations& e, double& damping) {
    const double dampings[2] = {damping, 30.0 * damping};
    std::vector<double> x[2];
    double cost[2];
    for_each_task(2, [&](std::size_t i) {
      x[i] = stepped(e, dampings[i]);
      cost[i] = cost_of(at(x[i]), l.weight) + space_.penalty(x[i]);
    });
    outcome_.runs += 2;
    const int better = cost[1] < cost[0] ? 1 : 0;
    const double fall = outcome_.cost - cost[better];
    if (!(fall > 0.0)) {
      damping *= 900.0;
      return 0.0;
    }
    damping = std::max(1e-4, (better == 0 ? 0.1 : 3.0) * damping);
    outcome_.x = x[better];
    outcome_.cost = cost[better];
    return fall;
  }

  const ObserverRuns& runs_;
  const ParameterSpace& space_;
  const GainSchedule& schedule_;
  const FitLimits& limits_;
  std::size_t samples_;
  FitOutcome outcome_;
};

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
    const double left = outputs.innovation[0][k - first] / record.noise[0];
    const double right = outputs.innovation[1][k - first] / record.noise[1];
    sum += left * left + right * right;
  }
  return sum;
}

class Search {
 public:
  Search(const ObserverRuns& runs, const ObserverParameters& parameters,
         std::span<const std::size_t> gains)
      : record_(runs.record()), observer_(runs.prepare(parameters)), gains_(gains) {}

  GainSchedule run() {
    std::vector<Candidate> alive(1);
    alive[0].state = observer_.initial_state();
    std::vector<std::vector<Step>> history;
    const std::size_t samples = record_.samples();
    for (std::size_t first = 0; first < samples; first += kGainBlock) {
      std::vector<Candidate> next(alive.size() * gains_.size());
      for_each_task(next.size(), [&](std::size_t i) {
        next[i] = advanced(alive[i / gains_.size()], gains_[i % gains_.size()], first,
                           std::min(samples, first + kGainBlock));
      });
      std::vector<std::size_t> order(next.size());
      std::iota(order.begin(), order.end(), std::size_t{0});
      std::stable_sort(order.begin(), order.end(),
                       [&](std::size_t a, std::size_t b) { return next[a].cost < next[b].cost; });
      order.resize(std::min(order.size(), survivors_));
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
    std::array<double, kGainBlock> left, right;
    ObserverSignals outputs;
    outputs.innovation = {left.data(), right.data()};
    observer_.run(gain, first, last, result.state, outputs, first);
    result.cost = forgetting_ * from.cost + block_cost(record_, outputs, first, last);
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
  std::size_t survivors_ = 4;
  double forgetting_ = 0.9;  // of the cost, per block
};

}  // namespace

FitOutcome fit_innovations(const ObserverRuns& runs, const ParameterSpace& space,
                           const GainSchedule& schedule, const FitLimits& limits) {
  return Fit(runs, space, schedule, limits).run();
}

GainSchedule search_gains(const ObserverRuns& runs, const ObserverParameters& parameters,
                          std::span<const std::size_t> gains) {
  return Search(runs, parameters, gains).run();
}

}  // namespace modcal::observer
