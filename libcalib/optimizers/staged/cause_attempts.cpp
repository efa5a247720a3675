#include "libcalib/optimizers/staged/cause_attempts.hpp"

#include <cmath>
#include <utility>

#include "libcalib/identifiability/moving_bridge.hpp"
#include "libcalib/likelihood/mains_lines.hpp"

namespace modcal {
namespace {

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

}  // namespace

// A fit that is not right is made again with the lines that it, and no other start, has shown.
ContinuationResult attempt_with_causes(const AttemptInput& input, double shift,
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

}  // namespace modcal
