// What the data of a benchmark's task allow at best.
#pragma once

#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "experiments/kinds/calibrate/calibrate_study.hpp"

namespace modcal {

/// Cramér–Rao bounds of the modal frequencies, computed once for each scene, noise level and set of
/// unknowns. Safe to use from several threads.
class FrequencyBounds {
 public:
  using Bounds = std::shared_ptr<const std::vector<double>>;
  /// Relative standard deviation of f_1 … f_N that no unbiased estimate of both reactions with the
  /// force unknown goes below, damping and sensors free as far as they are calibrated: of the
  /// stiff-string law where it is free (x_c known unless it is calibrated), of every frequency
  /// under the law prior and what priors are stated where frequencies are free. Null
  /// without noise or where no frequency is free. Throws InvalidInput as expected_limit() does.
  Bounds of(const CalibrateOptions& options, TruthCache& truths);

 private:
  std::mutex mutex_;
  std::map<std::string, std::shared_future<Bounds>> known_;
};

/// √(mean of b_n²) over the modes n listed; NaN for null bounds or no mode.
double rms_bound(const FrequencyBounds::Bounds& bounds, const std::vector<std::size_t>& modes);

}  // namespace modcal
