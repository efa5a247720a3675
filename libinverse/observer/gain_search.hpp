// Which gain serves which part of the record.
#pragma once

#include "libinverse/observer/observer_runs.hpp"

namespace modcal::observer {

struct GainSearchOptions {
  std::size_t survivors = 4;
  double forgetting = 0.9;  ///< of the cost, per block
};

/// Beam search: over blocks of kBlock samples every survivor is run on with every listed gain, the
/// cost ← forgetting·cost + Σ (ν/s)² keeps the best. `gains`: numbers in the list of `runs`.
/// Returns the path of the best survivor. Same bits for any number of threads.
GainSchedule search_gains(const ObserverRuns& runs, const ObserverParameters& parameters,
                          std::span<const std::size_t> gains,
                          const GainSearchOptions& options = {});

}  // namespace modcal::observer
