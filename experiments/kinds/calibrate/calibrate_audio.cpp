#include "experiments/kinds/calibrate/calibrate_force.hpp"

namespace modcal {
namespace {

constexpr double kRate = 22050.0;   // [Hz], about: strings have little above half of it
constexpr double kLongest = 1.0;    // [s]: four or eight players share a page of 2 MB
constexpr double kPassBand = 0.45;  // of the rate that is played

std::vector<SideIdentification> identified_by(const char* name, const InvertOptions& inversion,
                                              const Observation& observation,
                                              const AssumedModel& refined) {
  return identify(observation, refined, with_estimator(name, inversion.inversion),
                  {.force = true, .velocity = true}, nullptr);
}

}  // namespace

report::Audio calibration_audio(const CalibrateOptions& options, const Observation& observation,
                                const AssumedModel& refined) {
  const double rate = observation.sample_rate;
  const auto step = std::max<std::size_t>(1, static_cast<std::size_t>(rate / kRate));
  const double played = std::round(rate / static_cast<double>(step));
  const auto thinned = [&](std::span<const double> samples) {
    const auto longest = static_cast<std::size_t>(kLongest * rate);
    return low_passed(samples.first(std::min(samples.size(), longest)), rate, kPassBand * played,
                      step);
  };
  report::Audio audio{.id = "sound",
                      .title = "Listen to force and string velocity at the contact",
                      .caption = "Each is scaled to its own peak.",
                      .sample_rate = played};
  std::vector<report::Track> velocities;
  const auto add = [&](const std::string& name, const std::vector<double>& force,
                       const std::vector<double>& velocity) {
    if (!force.empty()) audio.tracks.push_back({name + " force", thinned(force)});
    if (!velocity.empty()) velocities.push_back({name + " velocity", thinned(velocity)});
  };
  if (observation.truth != nullptr) {
    const Simulation& truth = observation.truth->simulation;
    add("true", truth.force.samples, truth.velocity.samples);
  } else if (observation.reference) {
    add("recorded", observation.reference->samples, {});
  }
  for (const char* estimator : {"one_sided", "joint"}) {
    for (const SideIdentification& side :
         identified_by(estimator, options.inversion, observation, refined)) {
      const InversionResult& result = side.estimate.result;
      add(std::string(estimator) + ", " + side.estimate.label + ":", result.force, result.velocity);
    }
  }
  std::move(velocities.begin(), velocities.end(), std::back_inserter(audio.tracks));
  return audio;
}

}  // namespace modcal
