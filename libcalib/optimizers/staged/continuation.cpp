#include "libcalib/optimizers/staged/continuation.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "libcalib/optimizers/staged/continuation_attempt.hpp"
#include "libcalib/likelihood/noise_level.hpp"

namespace modcal {
namespace {

// Where nothing fits, what the law leaves is taken for noise: frequencies that fit the misfit would
// be farther from the truth than the law. χ² and verdict stay those of the noise stated.
ContinuationResult with_misfit_for_noise(const AttemptInput& input,
                                         ContinuationResult contradicted) {
  const double misfit = contradicted.law.chi2;
  if (!(misfit > 1.0)) return contradicted;
  NoisyRecords records = input.records;
  for (double& deviation : records.deviation) deviation *= std::sqrt(misfit);
  ContinuationResult found =
      attempt_continuation({input.initial, records, input.options, input.priors, input.highest,
                            input.noise_error, true, input.poll},
                           0.0);
  found.chi2 *= misfit;
  found.law.chi2 *= misfit;
  found.law.accepted = false;
  found.fits = found.right = false;
  for (FitStage& stage : found.stages) stage.chi2 *= misfit;
  found.evaluations += contradicted.evaluations;
  append_stages(found.stages, "misfit for noise: ", contradicted.evaluations, contradicted.stages);
  found.stages = std::move(contradicted.stages);
  found.restarts = contradicted.restarts;
  found.noise = contradicted.noise;
  return found;
}

}  // namespace

ContinuationResult calibrate_by_continuation(const ModelPoint& initial, const CalibrationData& data,
                                             const ContinuationOptions& options,
                                             const FitPoll& poll) {
  ModelPoint stated = initial;
  stated.sensors = options.unknowns.sensors();
  return calibrate_by_continuation(initial, data, options, StatedPriors(options.unknowns, stated),
                                   poll);
}

ContinuationResult calibrate_by_continuation(const ModelPoint& initial, const CalibrationData& data,
                                             const ContinuationOptions& options,
                                             const StatedPriors& priors, const FitPoll& poll) {
  const std::array<double, 2> noise{options.left_noise, options.right_noise};
  const NoisyRecords records = NoisyRecords::of_data(data, initial.basis, noise);
  const double noise_error = noise_power_error(noise, initial.basis, data);
  const double highest = likelihood_band(initial, options.highest_frequency, data.sample_rate);
  constexpr double kShifts[] = {0.0, 4e-3, -4e-3, 8e-3, -8e-3};
  const AttemptInput input{initial, records, options, priors, highest, noise_error, false, poll};
  ContinuationResult best;
  std::size_t evaluations = 0;
  std::vector<FitStage> stages;
  for (std::size_t i = 0; i <= static_cast<std::size_t>(options.restarts); ++i) {
    ContinuationResult found = attempt_continuation(input, kShifts[i], evaluations);
    evaluations = found.evaluations;
    append_stages(found.stages, i == 0 ? "" : fmt::format("restart {}: ", i), 0, stages);
    found.restarts = i;
    if (i == 0 || found.chi2 < best.chi2) best = std::move(found);
    if (best.fits) break;
  }
  best.evaluations = evaluations;
  best.stages = std::move(stages);
  if (best.fits || !options.frequencies) return best;
  return with_misfit_for_noise(input, std::move(best));
}

}  // namespace modcal
