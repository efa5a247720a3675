#include "libsim/dynamics/scene/simulator.hpp"

namespace modcal {
namespace {

// Fixed by: range of a double; its square, an energy, is finite.
constexpr double kLargestInput = 1e150;

}  // namespace

Simulation Simulator::simulate(const Scene& scene, double sample_rate, const OutputRequest& outputs,
                               const StopToken& stop) const {
  const double length = scene.string.length;
  MODCAL_REQUIRE(
      scene.structure != nullptr || (scene.bow.position > 0.0 && scene.bow.position < length),
      "bow position {:g} m is not inside the string: it must lie in (0, {:g}) m",
      scene.bow.position, length);
  MODCAL_REQUIRE(scene.structure == nullptr || !scene.torsion.present,
                 "torsion is that of a string: leave scene.torsion out for a structure");
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

void simulate_ensemble(const Simulator& simulator, const Ensemble& ensemble,
                       const std::function<void(std::size_t, Simulation)>& take,
                       const StopToken& stop) {
  for_each_task(
      ensemble.size,
      [&](std::size_t index) {
        take(index, simulator.simulate(ensemble.scene(index), ensemble.sample_rate,
                                       ensemble.outputs, stop));
      },
      stop);
}

}  // namespace modcal
