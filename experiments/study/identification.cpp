#include "experiments/study/identification.hpp"

#include "libsim/signal/statistics.hpp"

namespace modcal {

PreparedInversions::PreparedInversions(const AssumedModel& model, std::size_t samples,
                                       double sample_rate) {
  for (const End end : kEnds) {
    sides_[static_cast<std::size_t>(end)] = std::make_unique<const OneSidedInversion>(
        model.basis, model.contact, end, samples, sample_rate);
  }
}

std::shared_ptr<const PreparedInversions> InversionCache::get(const AssumedModel& model,
                                                              std::size_t samples,
                                                              double sample_rate) {
  const ModalBasis& basis = model.basis;
  std::vector<double> key = {model.contact, sample_rate, static_cast<double>(samples), basis.length,
                             basis.tension};
  for (const auto* part : {&basis.omega, &basis.zeta, &basis.mass}) {
    key.insert(key.end(), part->begin(), part->end());
  }
  const std::lock_guard lock(mutex_);
  auto& slot = prepared_[std::move(key)];
  if (!slot) slot = std::make_shared<const PreparedInversions>(model, samples, sample_rate);
  return slot;
}

namespace {

// Noise of one sample as stated by a simulated measurement; unknown for a record.
double noise_rms_of(const Observation& observation, double noise_level, End end) {
  if (!observation.truth) return std::numeric_limits<double>::quiet_NaN();
  const Simulation& simulation = observation.truth->simulation;
  const Signal& clean = end == End::kLeft ? simulation.left_reaction : simulation.right_reaction;
  return noise_level * standard_deviation(clean.samples);
}

}  // namespace

std::vector<SideIdentification> identify(const Observation& observation,
                                         const PreparedInversions& inversions,
                                         const InversionRecipe& recipe,
                                         const InversionOutputs& outputs,
                                         const ScoreOptions* score) {
  std::vector<SideIdentification> sides;
  for (const End end : kEnds) {
    const auto& reaction = observation.reaction(end);
    if (!reaction) continue;
    const OneSidedInversion& inversion = inversions.of(end);
    SideIdentification side;
    side.end = end;
    side.result = inversion.invert(
        reaction->samples,
        recipe.method(outputs, noise_rms_of(observation, observation.noise_level, end)));
    side.largest_transfer =
        inversion.problem().sigma().empty() ? 0.0 : inversion.problem().sigma()[0];
    if (score && observation.reference) {
      const Signal force{"f_c", "N", observation.sample_rate, side.result.force};
      side.scores = score_windows(force, *observation.reference, *score, observation.fundamental);
    }
    sides.push_back(std::move(side));
  }
  return sides;
}

}  // namespace modcal
