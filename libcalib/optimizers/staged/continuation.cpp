#include "libcalib/optimizers/staged/continuation.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <utility>

#include "libcalib/identifiability/misfit_causes.hpp"
#include "libcalib/likelihood/mains_lines.hpp"
#include "libcalib/likelihood/records/noise_level.hpp"
#include "libcalib/optimizers/staged/cause_attempts.hpp"
#include "libcalib/optimizers/staged/joint_fit.hpp"
#include "libinverse/joint/sensor_noise.hpp"
#include "libinverse/joint/string_transfer.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

// Where nothing fits, what the law leaves is taken for noise: frequencies that fit the misfit would
// be farther from the truth than the law. χ² and verdict stay those of the noise stated.
ContinuationResult with_misfit_for_noise(const AttemptInput& input,
                                         ContinuationResult contradicted) {
  const double misfit = contradicted.law.chi2;
  if (!(misfit > 1.0)) return contradicted;
  // Noise and causes are those of the fit, and not of another start that was tried last.
  NoisyRecords records = input.records;
  records.deviation = contradicted.noise;
  records.noise = contradicted.noise_spectrum;
  records.power_error = contradicted.noise_error;
  records.lines = contradicted.lines;
  records.signals.clear();
  for (const ScoreTest& cause : contradicted.freed) {
    if (cause.cause == kBridge) continue;  // taken out of the reactions, which are as recorded here
    records.signals.insert(records.signals.end(), cause.columns.begin(), cause.columns.end());
  }
  for (double& deviation : records.deviation) deviation *= std::sqrt(misfit);
  ContinuationResult found = attempt_continuation({.initial = input.initial,
                                                   .records = records,
                                                   .options = input.options,
                                                   .priors = input.priors,
                                                   .highest = input.highest,
                                                   .misfit_for_noise = true,
                                                   .moving = input.moving,
                                                   .within = input.within,
                                                   .first_law = input.first_law},
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
  found.noise_spectrum = contradicted.noise_spectrum;
  found.noise_error = contradicted.noise_error;
  found.lines = std::move(contradicted.lines);
  return found;
}

bool begins_moving(const NoisyRecords& records, const ModelPoint& point) {
  const auto arrivals = first_arrivals(point.basis, point.contact, {});
  return record_start({records.reactions[0], records.reactions[1]}, records.deviation, arrivals,
                      point.basis.frequency(0), records.sample_rate) == RecordStart::kMoving;
}

// alone: there are no other records.
ContinuationResult calibrate_stroke(const ModelPoint& initial, const CalibrationData& data,
                                    const ContinuationOptions& options, const StatedPriors& priors,
                                    bool alone, Evaluator* within) {
  const std::array<double, 2> noise{options.left_noise, options.right_noise};
  NoisyRecords records = NoisyRecords::of_data(data, initial.basis, noise);
  records.lines = mains_lines(records, initial, options.unknowns.mains);
  records.power_error = noise_power_error(noise, initial.basis, data);
  const double highest = likelihood_band(initial, options.highest_frequency, data.sample_rate);
  constexpr double kShifts[] = {0.0, 4e-3, -4e-3, 8e-3, -8e-3};
  std::optional<LawEstimate> first_law;
  const AttemptInput input{.initial = initial,
                           .records = records,
                           .options = options,
                           .priors = priors,
                           .highest = highest,
                           .moving = begins_moving(records, initial),
                           .alone = alone,
                           .within = within,
                           .first_law = first_law};
  ContinuationResult best;
  std::size_t evaluations = 0;
  bool shown = false;
  std::vector<FitStage> stages;
  for (std::size_t i = 0; i <= static_cast<std::size_t>(options.restarts); ++i) {
    ContinuationResult found = attempt_with_causes(input, kShifts[i], evaluations, shown);
    evaluations = found.evaluations;
    append_stages(found.stages, i == 0 ? "" : fmt::format("restart {}: ", i), 0, stages);
    found.restarts = i;
    if (!found.repeats && (i == 0 || found.chi2 < best.chi2)) best = std::move(found);
    if (best.fits) break;
  }
  best.evaluations = evaluations;
  best.stages = std::move(stages);
  if (!best.fits && options.frequencies) best = with_misfit_for_noise(input, std::move(best));
  return best;
}

StatedPriors priors_of(const ModelPoint& initial, const ContinuationOptions& options,
                       std::size_t records) {
  ModelPoint stated = initial;
  stated.sensors = options.unknowns.sensors();
  return StatedPriors(options.unknowns, stated, records);
}

// What is the first record's, and the stages of all fits in order.
void complete_by_single(ContinuationResult& fit) {
  const ContinuationResult& one = fit.single.front();
  fit.frequencies_free = one.frequencies_free;
  fit.noise = one.noise;
  fit.noise_spectrum = one.noise_spectrum;
  fit.lines = one.lines;
  fit.local = one.local;
  for (const ContinuationResult& single : fit.single) {
    fit.tests.insert(fit.tests.end(), single.tests.begin(), single.tests.end());
    fit.freed.insert(fit.freed.end(), single.freed.begin(), single.freed.end());
  }
  fit.restarts = one.restarts;
  fit.moved_modes = one.moved_modes;
  std::vector<FitStage> stages;
  std::size_t evaluations = 0;
  for (std::size_t r = 0; r < fit.single.size(); ++r) {
    append_stages(fit.single[r].stages, fmt::format("stroke {}: ", r + 1), evaluations, stages);
    evaluations += fit.single[r].evaluations;
  }
  append_stages(fit.stages, "all records: ", evaluations, stages);
  fit.stages = std::move(stages);
  fit.evaluations += evaluations;
}

}  // namespace

void append_stages(const std::vector<FitStage>& further, const std::string& prefix,
                   std::size_t evaluations, std::vector<FitStage>& stages) {
  for (FitStage stage : further) {
    stage.name = prefix + stage.name;
    stage.evaluations += evaluations;
    stages.push_back(std::move(stage));
  }
}

ContinuationResult calibrate_by_continuation(const ModelPoint& initial, const CalibrationData& data,
                                             const ContinuationOptions& options,
                                             Evaluator* within) {
  return calibrate_stroke(initial, data, options, priors_of(initial, options, 1), true, within);
}

ContinuationResult calibrate_records(const ModelPoint& initial,
                                     std::span<const CalibrationData> strokes,
                                     const ContinuationOptions& options,
                                     std::span<const PluckRecord> plucks, Evaluator* within) {
  MODCAL_REQUIRE(!strokes.empty(), "a fit of several records needs at least {} stroke", 1);
  options.unknowns.require_contacts(strokes.size());
  const StatedPriors priors = priors_of(initial, options, strokes.size() + plucks.size());
  ContinuationResult fit;
  const bool alone = strokes.size() + plucks.size() == 1;
  for (std::size_t r = 0; r < strokes.size(); ++r) {
    fit.single.push_back(
        calibrate_stroke(initial, strokes[r], options, priors.of_record(r), alone, within));
  }
  fit_jointly(initial, options, priors, strokes, plucks, within, fit);
  complete_by_single(fit);
  return fit;
}

}  // namespace modcal
