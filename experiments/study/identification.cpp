#include "experiments/study/identification.hpp"

#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

constexpr std::size_t kPreparedKept = 8;

std::string key_of(const AssumedModel& model, const Observation& observation,
                   InversionOptions options) {
  const ModalBasis& basis = model.basis;
  std::string key =
      fingerprint([&](OptionVisitor& visitor) { visitor("estimator", "", options.estimator); });
  const auto add = [&key](double value) { key += fmt::format(" {:a}", value); };
  for (const double value :
       {model.contact, observation.sample_rate, static_cast<double>(observation.samples()),
        observation.truth ? 0.0 : 1.0, basis.length, basis.tension,
        model.bending ? static_cast<double>(*model.bending) : -1.0}) {
    add(value);
  }
  for (const auto* part : {&basis.omega, &basis.zeta, &basis.mass}) {
    std::for_each(part->begin(), part->end(), add);
  }
  return key;
}

// As stated by a simulated measurement; unknown for a record.
double noise_rms_of(const Observation& observation, End end) {
  if (!observation.truth) return std::numeric_limits<double>::quiet_NaN();
  const Simulation& simulation = observation.truth->simulation;
  const Signal& clean = end == End::kLeft ? simulation.left_reaction : simulation.right_reaction;
  return observation.noise_level * standard_deviation(clean.samples);
}

EstimationRecord record_of(const Observation& observation) {
  EstimationRecord record;
  for (const End end : kEnds) {
    const auto side = static_cast<std::size_t>(end);
    if (observation.reaction(end)) record.reactions[side] = observation.reaction(end)->samples;
    record.stated_noise[side] = noise_rms_of(observation, end);
  }
  if (observation.truth && observation.reference) {
    record.true_force = observation.reference->samples;
  }
  return record;
}

// The estimator of `recipe` with its transfer functions.
InversionCache::Prepared prepare_estimator(const AssumedModel& model,
                                           const Observation& observation,
                                           const InversionRecipe& recipe) {
  return recipe.estimator().prepare({.basis = model.basis,
                                     .contact = model.contact,
                                     .samples = observation.samples(),
                                     .sample_rate = observation.sample_rate,
                                     .recorded = observation.truth == nullptr,
                                     .bending = model.bending});
}

}  // namespace

void ScoreOptions::visit(OptionVisitor& visitor) {
  visitor(
      "windows",
      "starts of the windows in which forces are compared; none: the record but for two periods "
      "at either end",
      {.unit = "s", .range = Range::non_negative()}, windows);
  visitor("periods", "length of a window in periods of the fundamental",
          {.range = Range::positive()}, periods);
  visitor("whole",
          "start and stop of a long window scored beside the others; none: no "
          "such score",
          {.unit = "s", .range = Range::non_negative()}, whole);
  visitor("oversampling",
          "rate of the simulated force behind the anti-aliased correlation, in "
          "sample rates; 1: no such score",
          {.range = Range::closed(1, 64)}, oversampling);
}

void WindowScore::visit(ResultVisitor& visitor) const {
  visitor({.key = "window_start", .name = "window from", .unit = "s"}, known(start));
  visitor({.key = "window_stop", .name = "to", .unit = "s"}, known(stop));
  visitor({.key = "correlation", .name = "correlation R"}, known(correlation));
  visitor({.key = "relative_rms_error", .name = "relative rms error"}, known(relative_rms_error));
  visitor({.key = "anti_aliased", .name = "R, anti-aliased"}, known(anti_aliased));
  visitor({.key = "coverage", .name = "within the 95 % band", .format = "{:.3f}"}, known(coverage));
}

std::string WindowScore::text() const {
  return fmt::format(
      "{:.4g} s to {:.4g} s: R = {:.4f}, relative rms error {:.4f}{}", start, stop, correlation,
      relative_rms_error,
      std::isnan(coverage) ? "" : fmt::format(", {:.1f} % within the 95 % band", 100.0 * coverage));
}

ScoredForce::ScoredForce(const Estimate& estimate)
    : samples(estimate.result.force),
      unaliased(estimate.unaliased_force),
      deviation(estimate.force_deviation),
      deviations(estimate.force_deviations),
      band_limit(estimate.band_limit) {}

namespace {

// Of two windows with equal means, the share that differs by less than 1.96 deviations.
double coverage_of(std::span<const double> identified, std::span<const double> truth,
                   double deviation, std::span<const double> deviations) {
  if (deviations.empty() && std::isnan(deviation)) return deviation;
  constexpr double kBand = 1.96;
  double apart = 0.0;
  for (std::size_t j = 0; j < truth.size(); ++j) apart += identified[j] - truth[j];
  apart /= static_cast<double>(truth.size());
  std::size_t held = 0;
  for (std::size_t j = 0; j < truth.size(); ++j) {
    const double width = kBand * (deviations.empty() ? deviation : deviations[j]);
    if (std::abs(identified[j] - truth[j] - apart) <= width) ++held;
  }
  return static_cast<double>(held) / static_cast<double>(truth.size());
}

}  // namespace

ForceScores score_force(const ScoredForce& identified, const ScoreReference& reference,
                        const ScoreOptions& options) {
  const Signal& truth = reference.truth;
  const double rate = truth.sample_rate;
  std::vector<double> smooth;
  if (reference.anti_aliased) {
    smooth = low_passed(identified.unaliased.empty() ? identified.samples : identified.unaliased,
                        rate, reference.anti_alias_cut);
  }
  const std::vector<double> in_band = std::isnan(identified.band_limit)
                                          ? truth.samples
                                          : low_passed(truth.samples, rate, identified.band_limit);
  const auto place = [rate](double time) {
    constexpr double kFarBehind = 1e15;  // any record
    return static_cast<std::size_t>(std::min(std::round(time * rate), kFarBehind));
  };
  const auto score = [&](double start, std::size_t length) {
    const auto part = [first = place(start), length](std::span<const double> samples) {
      return samples.subspan(first, length);
    };
    const std::span<const double> exact = part(truth.samples);
    const std::span<const double> found = part(identified.samples);
    WindowScore result{.start = start,
                       .stop = start + static_cast<double>(length) / rate,
                       .correlation = correlation(found, exact),
                       .relative_rms_error = relative_rms_error(found, exact)};
    result.coverage = coverage_of(
        found, part(in_band), identified.deviation,
        identified.deviations.empty() ? identified.deviations : part(identified.deviations));
    if (!smooth.empty()) {
      result.anti_aliased = correlation(part(smooth), part(reference.anti_aliased->samples));
    }
    return result;
  };

  ForceScores found;
  const std::size_t length = place(options.periods / reference.fundamental);
  if (options.windows.empty()) {
    const double end = kUnscoredPeriods / reference.fundamental;
    const std::size_t cut = 6 * place(end) < 2 * truth.size() ? place(end) : 0;
    found.scores.push_back(score(cut > 0 ? end : 0.0, truth.size() - 2 * cut));
  }
  for (const double start : options.windows) {
    MODCAL_REQUIRE(length >= 2 && place(start) + length <= truth.size(),
                   "the score window from {:g} s over {:g} periods ({} samples) is not inside the "
                   "record of {:g} s",
                   start, options.periods, length, truth.duration());
    found.scores.push_back(score(start, length));
  }
  if (options.whole.empty()) return found;
  MODCAL_REQUIRE(options.whole.size() == 2,
                 "the long window has {} ends: start and stop are two, whole: [start, stop]",
                 options.whole.size());
  const std::size_t first = place(options.whole[0]), last = place(options.whole[1]);
  MODCAL_REQUIRE(first + 2 <= last && last <= truth.size(),
                 "the long window from {:g} s to {:g} s is not inside the record of {:g} s",
                 options.whole[0], options.whole[1], truth.duration());
  found.whole = score(options.whole[0], last - first);
  return found;
}

std::vector<double> low_passed(std::span<const double> samples, double sample_rate, double cut,
                               std::size_t step) {
  const RealFft fft(samples.size());
  std::vector<Complex> spectrum = fft.forward(samples);
  const double spacing = sample_rate / static_cast<double>(samples.size());
  for (std::size_t k = 0; k < spectrum.size(); ++k) {
    if (static_cast<double>(k) * spacing > cut) spectrum[k] = 0.0;
  }
  const std::vector<double> all = fft.inverse(std::move(spectrum));
  std::vector<double> kept;
  kept.reserve(all.size() / step + 1);
  for (std::size_t j = 0; j < all.size(); j += step) kept.push_back(all[j]);
  return kept;
}

std::string band_note(const Estimate& estimate) {
  if (!std::isfinite(estimate.band_limit)) return {};
  return fmt::format(
      "side {}: signals and deviations are those of what lies below {:.6g} Hz; low-pass there what "
      "they are held against",
      estimate.side, estimate.band_limit);
}

ForceScores scores_of(const Observation& observation, const ScoredForce& force,
                      const ScoreOptions* score) {
  if (score == nullptr || !observation.reference) return {};
  return score_force(force,
                     {.truth = *observation.reference,
                      .anti_aliased = observation.anti_aliased,
                      .anti_alias_cut = observation.anti_alias_cut,
                      .fundamental = observation.fundamental},
                     *score);
}

std::vector<MotionScore> motion_scores(const Observation& observation, const Estimate& estimate,
                                       const ScoreOptions& score) {
  std::vector<MotionScore> found;
  for (const Quantity& quantity : kQuantities) {
    const bool is_motion =
        quantity.reference != nullptr && quantity.reference != &Observation::reference;
    if (!is_motion || !(observation.*quantity.reference)) continue;
    ScoredForce signal(estimate.result.*quantity.identified);
    if (signal.samples.empty()) continue;
    signal.deviation = estimate.*quantity.deviation;
    if (quantity.deviations != nullptr) signal.deviations = estimate.*quantity.deviations;
    signal.band_limit = estimate.band_limit;
    const ForceScores scores = score_force(signal,
                                           {.truth = *(observation.*quantity.reference),
                                            .anti_aliased = std::nullopt,
                                            .fundamental = observation.fundamental},
                                           score);
    for (const WindowScore& window : scores.scores) found.push_back({quantity.name, window});
  }
  return found;
}

namespace {

// What both sensors have alike, their sign too, cancels in what a string is judged by.
void doubt_sign(const Observation& observation, SideIdentification& side) {
  constexpr double kOpposed = -0.5;
  if (observation.truth || side.scores.empty()) return;
  const double correlation = side.scores.front().correlation;
  if (!(correlation < kOpposed)) return;
  side.estimate.warnings.push_back(fmt::format(
      "the force that was recorded has the other sign (R = {:.3g}): if it is the right one, both "
      "reactions are those on the supports; state turned: true for both (a force > 0 pushes those "
      "on the string below 0)",
      correlation));
}

}  // namespace

void score_side(const Observation& observation, const ScoreOptions& score,
                SideIdentification& side) {
  static_cast<ForceScores&>(side) = scores_of(observation, ScoredForce(side.estimate), &score);
  side.motion = motion_scores(observation, side.estimate, score);
  doubt_sign(observation, side);
}

InversionCache::Prepared InversionCache::get(const AssumedModel& model,
                                             const Observation& observation,
                                             const InversionOptions& options,
                                             const InversionRecipe& recipe) {
  const std::string key = key_of(model, observation, options);
  const std::lock_guard lock(mutex_);
  for (const auto& [known, prepared] : prepared_) {
    if (known == key) return prepared;
  }
  prepared_.emplace_back(key, prepare_estimator(model, observation, recipe));
  if (prepared_.size() > kPreparedKept) prepared_.pop_front();
  return prepared_.back().second;
}

std::vector<SideIdentification> identify(const Observation& observation, const AssumedModel& model,
                                         const InversionOptions& options,
                                         const InversionOutputs& outputs, const ScoreOptions* score,
                                         InversionCache* cache) {
  const InversionRecipe recipe(options);
  const auto estimator = cache != nullptr ? cache->get(model, observation, options, recipe)
                                          : prepare_estimator(model, observation, recipe);
  std::vector<SideIdentification> sides;
  for (Estimate& estimate : estimator->estimate(record_of(observation), recipe.method(outputs))) {
    sides.push_back({{}, std::move(estimate)});
    if (score) score_side(observation, *score, sides.back());
  }
  return sides;
}

}  // namespace modcal
