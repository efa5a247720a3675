#include "experiments/kinds/calibrate/calibrate.hpp"

namespace modcal {
namespace {

constexpr double kRate = 22050.0;   // [Hz], about: strings have little above half of it
constexpr double kLongest = 1.0;    // [s]: four or eight players share a page of 2 MB
constexpr double kPassBand = 0.45;  // of the rate that is played

// Thins signals of one record for the players.
class Thinner {
 public:
  explicit Thinner(double sample_rate)
      : rate_(sample_rate),
        step_(std::max<std::size_t>(1, static_cast<std::size_t>(sample_rate / kRate))) {}

  double played_rate() const { return std::round(rate_ / static_cast<double>(step_)); }
  std::vector<double> operator()(const std::vector<double>& samples) const {
    const auto longest = static_cast<std::size_t>(kLongest * rate_);
    const std::vector<double> first(
        samples.begin(),
        samples.begin() + static_cast<std::ptrdiff_t>(std::min(samples.size(), longest)));
    return low_passed(first, rate_, kPassBand * played_rate(), step_);
  }

 private:
  double rate_;
  std::size_t step_;
};

std::vector<SideIdentification> identified_by(const char* name, const InvertOptions& inversion,
                                              const Observation& observation,
                                              const AssumedModel& refined) {
  InversionOptions options = inversion.inversion;
  if (options.estimator.selected() != name) options.estimator = Choice<Estimator>(name);
  return identify(observation, refined, options, {.force = true, .velocity = true}, nullptr);
}

}  // namespace

report::Audio calibration_audio(const CalibrateOptions& options, const Observation& observation,
                                const AssumedModel& refined) {
  const Thinner thinned(observation.sample_rate);
  report::Audio audio{.id = "sound",
                      .title = "Listen to force and string velocity at the contact",
                      .caption = "Each is scaled to its own peak.",
                      .sample_rate = thinned.played_rate()};
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
