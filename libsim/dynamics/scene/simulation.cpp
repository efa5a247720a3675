#include "libsim/dynamics/scene/simulation.hpp"

#include <algorithm>
#include <cmath>

#include "libsim/base/error.hpp"

namespace modcal {

std::size_t sample_count(double duration, double sample_rate) {
  const double count = std::round(duration * sample_rate);
  MODCAL_REQUIRE(count >= 1.0 && count <= 2147483648.0,
                 "{:g} s at {:g} Hz make {:g} samples: a record has 1 to 2^31", duration,
                 sample_rate, count);
  return static_cast<std::size_t>(count);
}

StepPlan plan_steps(double wanted_time_step, double sample_rate) {
  MODCAL_REQUIRE(wanted_time_step > 0.0 && std::isfinite(wanted_time_step),
                 "time step {:g} s must be > 0", wanted_time_step);
  MODCAL_REQUIRE(sample_rate > 0.0 && std::isfinite(sample_rate), "sample rate {:g} Hz must be > 0",
                 sample_rate);
  const double ratio = 1.0 / (sample_rate * wanted_time_step);
  MODCAL_REQUIRE(ratio <= 1e9, "{:g} steps per sample: the time step {:g} s is too small", ratio,
                 wanted_time_step);
  // A ratio that is whole but for rounding is whole: 1/(50 kHz · 1 us) is 20 steps, not 21.
  const double nearest = std::round(ratio);
  const double count = std::abs(ratio - nearest) <= 1e-12 * ratio ? nearest : std::ceil(ratio);
  const double steps = std::max(count, 1.0);
  return {.time_step = 1.0 / (sample_rate * steps),
          .steps_per_sample = static_cast<std::size_t>(steps)};
}

Simulation empty_simulation(std::size_t count, double rate, const OutputRequest& outputs) {
  const auto signal = [&](const char* quantity, const char* unit, bool wanted) {
    return Signal{quantity, unit, rate, std::vector<double>(wanted ? count : 0)};
  };
  Simulation result;
  result.displacement = signal("y", "m", outputs.displacement);
  result.velocity = signal("v", "m/s", outputs.velocity);
  result.force = signal("f_c", "N", outputs.force);
  result.left_reaction = signal("R1", "N", outputs.left_reaction);
  result.right_reaction = signal("R2", "N", outputs.right_reaction);
  return result;
}

void Simulation::diverge(double time, std::string reason) {
  for (Signal* signal : {&displacement, &velocity, &force, &left_reaction, &right_reaction}) {
    signal->samples.clear();
  }
  switches.clear();
  diverged_at = time;
  explanation = std::move(reason);
}

SampleTargets targets_of(Simulation& result) {
  const auto samples = [](Signal& signal) {
    return signal.samples.empty() ? nullptr : signal.samples.data();
  };
  return {.displacement = samples(result.displacement),
          .velocity = samples(result.velocity),
          .force = samples(result.force),
          .left_reaction = samples(result.left_reaction),
          .right_reaction = samples(result.right_reaction)};
}

}  // namespace modcal
