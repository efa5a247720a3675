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
        observation.truth ? 0.0 : 1.0, basis.length, basis.tension}) {
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
                                     .recorded = observation.truth == nullptr});
}

}  // namespace

void ScoreOptions::visit(OptionVisitor& visitor) {
  visitor("windows", "starts of the windows in which forces are compared; none: the whole record",
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
  visitor({.key = "correlation", .name = "correlation R"}, known(correlation));
  visitor({.key = "relative_rms_error", .name = "relative rms error"}, known(relative_rms_error));
  visitor({.key = "anti_aliased", .name = "R, anti-aliased"}, known(anti_aliased));
}

std::string WindowScore::text() const {
  return fmt::format("window from {:g} s: R = {:.4f}, relative rms error {:.4f}", start,
                     correlation, relative_rms_error);
}

ForceScores score_force(std::span<const double> identified, const ScoreReference& reference,
                        const ScoreOptions& options, std::span<const double> unaliased) {
  const Signal& truth = reference.truth;
  const double rate = truth.sample_rate;
  std::vector<double> smooth;
  if (reference.anti_aliased) {
    smooth = low_passed(unaliased.empty() ? identified : unaliased, rate, reference.anti_alias_cut);
  }
  const auto place = [rate](double time) {
    return static_cast<std::size_t>(std::round(time * rate));
  };
  const auto score = [&](double start, std::size_t length) {
    const auto part = [first = place(start), length](std::span<const double> samples) {
      return samples.subspan(first, length);
    };
    const std::span<const double> exact = part(truth.samples);
    WindowScore result{.start = start,
                       .correlation = correlation(part(identified), exact),
                       .relative_rms_error = relative_rms_error(part(identified), exact)};
    if (!smooth.empty()) {
      result.anti_aliased = correlation(part(smooth), part(reference.anti_aliased->samples));
    }
    return result;
  };

  ForceScores found;
  const std::size_t length = place(options.periods / reference.fundamental);
  if (options.windows.empty()) found.scores.push_back(score(0.0, truth.size()));
  for (const double start : options.windows) {
    MODCAL_REQUIRE(length >= 2 && place(start) + length <= truth.size(),
                   "the score window from {:g} s over {:g} periods ({} samples) is not inside the "
                   "record of {:g} s",
                   start, options.periods, length, truth.duration());
    found.scores.push_back(score(start, length));
  }
  if (options.whole.empty()) return found;
  MODCAL_REQUIRE(options.whole.size() == 2, "the long window has {} ends: start and stop are two",
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

ForceScores scores_of(const Observation& observation, std::span<const double> force,
                      const ScoreOptions* score, std::span<const double> unaliased) {
  if (score == nullptr || !observation.reference) return {};
  return score_force(force,
                     {.truth = *observation.reference,
                      .anti_aliased = observation.anti_aliased,
                      .anti_alias_cut = observation.anti_alias_cut,
                      .fundamental = observation.fundamental},
                     *score, unaliased);
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
    const ForceScores scores =
        scores_of(observation, estimate.result.force, score, estimate.unaliased_force);
    sides.push_back({scores, std::move(estimate)});
  }
  return sides;
}

}  // namespace modcal
