// Parameters and gains of the observer by prediction error.
#pragma once

#include <span>
#include <vector>

#include "libinverse/observer/observer_runs.hpp"
#include "libsim/base/task_loop.hpp"

namespace modcal::observer {

struct FitLimits {
  std::size_t iterations = 8;
  std::size_t samples = 0;      ///< from the start of the record; 0: all
  double smallest_gain = 1e-4;  ///< relative fall of the cost below which the fit ends
  StopToken stop = {};
};

struct FitOutcome {
  std::vector<double> x;  ///< in steps of the space
  double cost = 0.0;      ///< Σ w ρ(ν/s) + prior
  std::size_t iterations = 0;
  std::size_t runs = 0;  ///< of the observer
};

/// Gauss–Newton with Levenberg–Marquardt damping on Σ_k w_k ρ(ν_k/s) plus the priors' squares, ρ
/// Huber's with corner 3, from x = 0. Jacobian by central differences of ±0.1 steps. w_k =
/// min(1, (6 median ‖J_k‖/‖J_k‖)²) mutes bursts in which the observer's answer to its parameters is
/// chaotic. No coordinate moves more than 12 steps at once. Same bits for any number of threads.
FitOutcome fit_innovations(const ObserverRuns& runs, const ParameterSpace& space,
                           const GainSchedule& schedule, const FitLimits& limits);

/// Beam search: over blocks of kGainBlock samples four survivors are run on with every listed gain,
/// the cost ← 0.9 cost + Σ (ν/s)² keeps the best. `gains`: numbers in the list of `runs`. Returns
/// the path of the best survivor. Same bits for any number of threads.
GainSchedule search_gains(const ObserverRuns& runs, const ObserverParameters& parameters,
                          std::span<const std::size_t> gains);

}  // namespace modcal::observer
