#include "libcalib/optimizers/staged/continuation.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <utility>

#include "libcalib/identifiability/moving_bridge.hpp"
#include "libcalib/likelihood/mains_lines.hpp"
#include "libcalib/likelihood/records/noise_level.hpp"
#include "libcalib/optimizers/staged/continuation_attempt.hpp"
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

// The next fit in the place of one before it, whose stages stay.
void follow(ContinuationResult& found, const char* prefix, ContinuationResult next) {
  append_stages(next.stages, prefix, 0, found.stages);
  next.stages = std::move(found.stages);
  found = std::move(next);
}

// Begins with the noise that the records have. Where it is another, the fit is made again with what
// it leaves; once more for what the first round changed.
ContinuationResult attempt_with_its_noise(const AttemptInput& input, double shift,
                                          std::size_t evaluations) {
  ContinuationResult found = attempt_continuation(input, shift, evaluations);
  for (int round = 0; round < 2 && !found.repeats; ++round) {
    // Where the law holds, the noise is what it leaves already.
    if (found.law.accepted && found.chi2 > 1.0 - 3.0 * found.chi2_deviation) break;
    const ProjectedLikelihood whole(WhitenedRecord::of(input.records, 0.0, input.highest));
    if (!input.take_noise(whole, found.model, 0.05)) break;
    follow(found, "other noise: ", attempt_continuation(input, shift, found.evaluations));
  }
  return found;
}

// Of a fit, to compare it with one of another noise: over a spectrum by its mean level.
double power_left(const ContinuationResult& fit) {
  double level = 0.0;
  const std::vector<NoiseSpectrum::Knot>& knots = fit.noise_spectrum.knots;
  for (const NoiseSpectrum::Knot& knot : knots) level += std::log(knot.noise.determinant());
  if (!knots.empty()) level /= 2.0 * static_cast<double>(knots.size());
  return fit.chi2 * fit.noise[0] * fit.noise[1] * std::exp(level);
}

// A bridge that moves is taken out of the record, by as many modes of its body as the fits of what
// is left ask for: they are those of a pinned string, whose modes are then put on the bridge. The
// fit before, of the string on its bridge, is near enough to begin with, so that there are two.
ContinuationResult on_moving_bridge(const AttemptInput& input, double shift,
                                    ContinuationResult found) {
  NoisyRecords& records = input.records;
  const std::array<std::vector<double>, 2> recorded = records.reactions;
  std::vector<ScoreTest> body, taken_out;
  ModalBasis on_bridge = found.model.basis;
  for (std::size_t fit = 0; fit < 6; ++fit) {
    const ScoreTest* cause = first_cause(found.tests);
    // A mass is positive; a further mode may take from one found too light.
    const bool more = cause && cause->cause == kBridge && cause->frees() &&
                      (!body.empty() || cause->amplitude > 0.0);
    if (!more && fit != 1) break;
    if (more) add_to_body(*cause, body);
    records.reactions = recorded;
    take_out(body, found.model, input.highest, records);
    records.power_error = input.read_error;
    ContinuationResult next = attempt_with_its_noise(input, shift, found.evaluations);
    found.evaluations = next.evaluations;
    ModalBasis basis = next.model.basis;
    const bool serves = !next.repeats && power_left(next) < power_left(found);
    if (!serves || !put_on_bridge(basis, body)) break;
    follow(found, "bridge taken out: ", std::move(next));
    taken_out = body;
    on_bridge = std::move(basis);
  }
  records.reactions = recorded;
  records.deviation = found.noise;
  records.noise = found.noise_spectrum;
  records.power_error = found.noise_error;
  records.on_bridge.clear();
  records.body.clear();
  found.model.basis = std::move(on_bridge);
  for (std::size_t n = 0; n < found.modes.size(); ++n) {
    found.modes[n].frequency = found.model.basis.frequency(n);
  }
  found.freed = std::move(taken_out);
  return found;
}

// To first order the amplitudes of a cause are further numbers of the record, as long as they are
// small.
ContinuationResult with_cause_free(const AttemptInput& input, double shift, ScoreTest cause,
                                   std::vector<FitStage> stages, std::size_t evaluations) {
  input.records.signals = cause.columns;
  ContinuationResult found = attempt_continuation(input, shift, evaluations);
  append_stages(found.stages, cause.cause + " free: ", 0, stages);
  found.stages = std::move(stages);
  for (ScoreTest& test : found.tests) {
    if (test.cause == cause.cause) test.detail = "beyond what is free of it";
  }
  found.freed = {std::move(cause)};
  return found;
}

ContinuationResult attempt(const AttemptInput& input, double shift, std::size_t evaluations) {
  input.records.signals.clear();
  input.records.noise = {};
  input.records.deviation = input.read;
  input.records.power_error = input.read_error;
  ContinuationResult found = attempt_with_its_noise(input, shift, evaluations);
  const ScoreTest* first = first_cause(found.tests);
  if (!first || !first->frees()) return found;
  const ScoreTest cause = *first;
  if (cause.cause != kBridge) {
    return with_cause_free(input, shift, cause, found.stages, found.evaluations);
  }
  if (!input.alone) return found;
  const NoisyRecords before = input.records;
  found = on_moving_bridge(input, shift, std::move(found));
  // S is of first order: by what the whole fit leaves a bridge and a resonance differ.
  for (const ScoreTest& rival : cause.rivals) {
    const NoisyRecords of_bridge = std::exchange(input.records, before);
    ContinuationResult other =
        with_cause_free(input, shift, rival, found.stages, found.evaluations);
    if (power_left(other) < power_left(found)) {
      found = std::move(other);
    } else {
      input.records = of_bridge;
      found.evaluations = other.evaluations;
      found.stages = std::move(other.stages);
    }
  }
  return found;
}

// By what a fit without lines leaves, where the model as it is stated hides a hum. True: others.
bool take_lines(const AttemptInput& input, const ModelPoint& found) {
  std::vector<double> before = std::exchange(input.records.lines, {});
  const ProjectedLikelihood whole(WhitenedRecord::of(input.records, 0.0, input.highest));
  input.records.lines = mains_lines(whole, found, input.options.unknowns.mains);
  const bool same = same_lines(before, input.records);
  if (same) input.records.lines = std::move(before);
  return !same;
}

// A fit that is not right is made again with the lines that it, and no other start, has shown.
ContinuationResult attempt_with_its_lines(const AttemptInput& input, double shift,
                                          std::size_t evaluations, bool& shown) {
  ContinuationResult found = attempt(input, shift, evaluations);
  if (!shown && !found.repeats && !found.right && take_lines(input, found.model)) {
    shown = true;
    input.first_law.reset();
    follow(found, "hum as it is found: ", attempt(input, shift, found.evaluations));
  }
  found.lines = input.records.lines;
  return found;
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
    ContinuationResult found = attempt_with_its_lines(input, kShifts[i], evaluations, shown);
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
