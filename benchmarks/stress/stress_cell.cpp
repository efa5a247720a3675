#include "benchmarks/stress/stress_cell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libsim/base/error.hpp"
#include "libsim/dynamics/energy_audit.hpp"
#include "libsim/dynamics/simulators/modal_event.hpp"
#include "libsim/dynamics/simulators/modal_exact.hpp"
#include "libsim/dynamics/simulators/newmark_explicit.hpp"
#include "libsim/dynamics/simulators/scene_setup.hpp"

namespace modcal {
namespace {

Simulation simulate(std::string_view simulator, const Scene& scene, double step) {
  const OutputRequest outputs{.displacement = true, .velocity = true, .force = true};
  const double rate = 1.0 / step;
  if (simulator == "newmark_explicit") {
    return NewmarkExplicit({.time_step = step}).simulate(scene, rate, outputs);
  }
  if (simulator == "modal_exact") {
    return ModalExact({.time_step = step}).simulate(scene, rate, outputs);
  }
  return ModalEvent({}).simulate(scene, rate, outputs);
}

ForceHold hold_of(std::string_view simulator) {
  if (simulator == "newmark_explicit") return ForceHold::kLagged;
  return simulator == "modal_exact" ? ForceHold::kLinear : ForceHold::kSampled;
}

bool all_finite(const Simulation& run) {
  for (const Signal* signal : {&run.displacement, &run.velocity, &run.force}) {
    for (const double x : signal->samples) {
      if (!std::isfinite(x)) return false;
    }
  }
  return true;
}

double largest_force(const Simulation& run) {
  double result = 0.0;
  for (const double f : run.force.samples) result = std::max(result, std::abs(f));
  return result;
}

// The samples hold for a step each: what a force that changes inside one may take from the contact
// or give to it, ∫|f v_c| over the steps in which the force changes by more than a twentieth of
// its limit (a switch, or a sliding speed that one step cannot follow).
double switching_tolerance(const Simulation& run, double bow, double limit) {
  const auto& f = run.force.samples;
  const auto& v = run.velocity.samples;
  double sum = 0.0;
  for (std::size_t k = 1; k < f.size(); ++k) {
    const double change = std::abs(f[k] - f[k - 1]);
    const double slip = std::max(std::abs(v[k] - bow), std::abs(v[k - 1] - bow));
    if (change > 0.05 * limit) sum += change * slip;
  }
  return sum / run.force.sample_rate;
}

CellResult judged(const Scene& scene, const Simulation& run, ForceHold hold) {
  CellResult result;
  const double limit = scene.friction.make()->static_limit(scene.bow.normal_force);
  if (!all_finite(run)) {
    result.reason = "a sample is not finite";
    return result;
  }
  if (largest_force(run) > limit * (1.0 + 1e-12)) {
    result.reason =
        fmt::format("force of {:g} N above the limit of {:g} N", largest_force(run), limit);
    return result;
  }
  const EnergyAccount energy = audit_energy(scene_modes(scene), run, scene.bow.velocity, hold);
  // Below 1e-290 J products of samples are denormal or zero.
  const double at_hand = energy.throughput + energy.dissipated + energy.largest_stored + 1e-290;
  result.unbalanced = std::abs(energy.residual()) / at_hand;
  result.allowed = (energy.rounding + energy.interpolation) / at_hand;
  result.passivity = energy.contact_loss / (energy.contact_throughput + 1e-290);
  if (!(result.unbalanced <= result.allowed + 1e-15)) {
    result.reason = fmt::format("energy balance open by {:.1e}, allowed {:.1e}", result.unbalanced,
                                result.allowed);
    return result;
  }
  const double given = -energy.contact_loss - energy.rounding - energy.interpolation -
                       switching_tolerance(run, scene.bow.velocity, limit);
  if (given > 1e-9 * energy.contact_throughput) {
    result.reason =
        fmt::format("the contact gives energy: {:.1e} of what goes through it", -result.passivity);
    return result;
  }
  result.outcome = Outcome::kRight;
  return result;
}

}  // namespace

CellResult run_cell(std::string_view simulator, Scene scene, double time_step,
                    std::size_t samples) {
  scene.duration = static_cast<double>(samples) * time_step;
  Simulation run;
  try {
    run = simulate(simulator, scene, time_step);
  } catch (const InvalidInput& refusal) {
    return {.outcome = Outcome::kRefused, .reason = refusal.what()};
  }
  if (run.diverged_at) {
    const bool clear = !run.explanation.empty() && run.force.samples.empty();
    return {.outcome = clear ? Outcome::kReported : Outcome::kWrong, .reason = run.explanation};
  }
  return judged(scene, run, hold_of(simulator));
}

std::size_t affordable_samples(const Scene& scene, double time_step) {
  const double modes = static_cast<double>(scene.string.modes);
  const double radians = 6.28 * scene.string.fundamental * modes * time_step;
  const double operations = modes * (1.0 + std::min(radians, 8.0));
  return static_cast<std::size_t>(std::clamp(5e5 / operations, 20.0, 20000.0));
}

}  // namespace modcal
