#include "libsim/dynamics/scene/simulator.hpp"

#include <cmath>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

// Its square, an energy, is finite.
constexpr double kLargestInput = 1e150;

}  // namespace

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

Simulation Simulator::simulate(const Scene& scene, double sample_rate, const OutputRequest& outputs,
                               const StopToken& stop) const {
  const double length = scene.string.length;
  MODCAL_REQUIRE(scene.bow.position > 0.0 && scene.bow.position < length,
                 "bow position {:g} m is not inside the string: it must lie in (0, {:g}) m",
                 scene.bow.position, length);
  MODCAL_REQUIRE(std::abs(scene.bow.velocity) <= kLargestInput &&
                     std::abs(scene.bow.normal_force) <= kLargestInput,
                 "bow velocity {:g} m/s or normal force {:g} N is beyond {:g}: energies would "
                 "overflow",
                 scene.bow.velocity, scene.bow.normal_force, kLargestInput);
  sample_count(scene.duration, sample_rate);
  for (const SceneRefusal& refusal : refusals(scene)) {
    throw_invalid_input("scene.{}: {}", refusal.key, refusal.reason);
  }
  Simulation result = run(scene, sample_rate, outputs, stop);
  stop.throw_if_requested();
  return result;
}

}  // namespace modcal
