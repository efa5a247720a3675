#include "benchmarks/stress/stress_cell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libsim/base/error.hpp"
#include "libsim/dynamics/energy_audit.hpp"
#include "libsim/dynamics/first_order_hold.hpp"
#include "libsim/dynamics/simulators/line_step.hpp"
#include "libsim/dynamics/simulators/modal_event.hpp"
#include "libsim/dynamics/simulators/modal_exact.hpp"
#include "libsim/dynamics/simulators/newmark_explicit.hpp"
#include "libsim/dynamics/simulators/scene_setup.hpp"

namespace modcal {
namespace {

// A simulation and the motion of every contact point.
struct CellRun {
  Simulation simulation;
  std::vector<PointMotion> points;
};

CellRun simulate_wide(const Scene& scene, double step, bool is_explicit) {
  CellRun cell;
  const OutputRequest outputs{.displacement = true, .velocity = true, .force = true};
  cell.simulation =
      simulate_line(scene, 1.0 / step, outputs, {}, step,
                    is_explicit ? ForceTiming::kPreviousStep : ForceTiming::kImplicit,
                    is_explicit ? trapezoidal_weights : first_order_hold_weights, &cell.points);
  return cell;
}

CellRun simulate(std::string_view simulator, const Scene& scene, double step) {
  const bool is_explicit = simulator == "newmark_explicit";
  if (scene.bow.points > 1 && simulator != "modal_event") {
    return simulate_wide(scene, step, is_explicit);
  }
  const OutputRequest outputs{.displacement = true, .velocity = true, .force = true};
  const double rate = 1.0 / step;
  CellRun cell;
  if (is_explicit) {
    cell.simulation = NewmarkExplicit({.time_step = step}).simulate(scene, rate, outputs);
  } else if (simulator == "modal_exact") {
    cell.simulation = ModalExact({.time_step = step}).simulate(scene, rate, outputs);
  } else {
    cell.simulation = ModalEvent({}).simulate(scene, rate, outputs);
  }
  PointMotion point(0);
  point.displacement = cell.simulation.displacement.samples;
  point.velocity = cell.simulation.velocity.samples;
  point.force = cell.simulation.force.samples;
  cell.points.push_back(std::move(point));
  return cell;
}

ForceHold hold_of(std::string_view simulator) {
  if (simulator == "newmark_explicit") return ForceHold::kLagged;
  return simulator == "modal_exact" ? ForceHold::kLinear : ForceHold::kSampled;
}

bool all_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
}
bool all_finite(const CellRun& cell) {
  return std::all_of(cell.points.begin(), cell.points.end(), [](const PointMotion& point) {
    return all_finite(point.displacement) && all_finite(point.velocity) && all_finite(point.force);
  });
}

// What friction allows at a sample [N]. Bristles carry μ_S F_N and their damper, limited to 4 g at
// a sudden slip, as much as |1 − μ_S F_N/g| ≤ 1 times that for the coefficients of the map.
double force_limit(const Scene& scene, const FrictionLaw& law, double normal_force) {
  const bool has_bristles = std::holds_alternative<BristleFriction>(law.stateful());
  return (has_bristles ? 5.0 : 1.0) * law.static_limit(normal_force) /
         static_cast<double>(scene.bow.points);
}

// Why a force is above its limit; empty: none is.
std::string excess_force(const Scene& scene, const BowMotion& bow, const CellRun& cell,
                         double step) {
  const auto law = scene.friction.make();
  for (const PointMotion& point : cell.points) {
    for (std::size_t k = 0; k < point.force.size(); ++k) {
      const double t = static_cast<double>(k) * step;
      const double limit = force_limit(scene, *law, bow.normal_force.at(t));
      if (std::abs(point.force[k]) <= limit * (1.0 + (cell.points.size() > 1 ? 1e-7 : 1e-12)))
        continue;
      return fmt::format("force of {:g} N above the limit of {:g} N", point.force[k], limit);
    }
  }
  return {};
}

// The samples hold for a step each: what a force that changes inside one may take from the contact
// or give to it, ∫|f v_c| over the steps in which the force changes by more than a twentieth of
// its limit (a switch, or a sliding speed that one step cannot follow).
double switching_tolerance(const PointMotion& point, const BowMotion& bow, double limit,
                           double step) {
  double sum = 0.0, before = 0.0;
  for (std::size_t k = 0; k < point.force.size(); ++k) {
    const double slip =
        std::abs(point.velocity[k] - bow.velocity.at(static_cast<double>(k) * step));
    const double change = k > 0 ? std::abs(point.force[k] - point.force[k - 1]) : 0.0;
    if (change > 0.05 * limit) sum += change * std::max(slip, before);
    before = slip;
  }
  return sum * step;
}

EnergyAccount audit(const Scene& scene, const BowMotion& bow, const CellRun& cell, double step,
                    ForceHold hold) {
  std::vector<PointRecord> records;
  for (const PointMotion& point : cell.points) {
    records.push_back({point.displacement, point.velocity, point.force});
  }
  return audit_energy(scene_line_modes(scene), bow, records, 1.0 / step, hold);
}

CellResult judged(const Scene& scene, const CellRun& cell, double step, ForceHold hold) {
  CellResult result;
  if (!all_finite(cell)) {
    result.reason = "a sample is not finite";
    return result;
  }
  const BowMotion bow = bow_motion(scene.bow, scene.duration);
  result.reason = excess_force(scene, bow, cell, step);
  if (!result.reason.empty()) return result;
  const EnergyAccount energy = audit(scene, bow, cell, step, hold);
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
  double given = -energy.contact_loss - energy.rounding - energy.interpolation;
  const double limit = force_limit(scene, *scene.friction.make(), bow.normal_force.highest());
  for (const PointMotion& point : cell.points) {
    given -= switching_tolerance(point, bow, limit, step);
  }
  if (!(given <= 1e-9 * energy.contact_throughput)) {
    result.reason =
        fmt::format("the contact gives energy: {:.1e} of what goes through it", -result.passivity);
    return result;
  }
  result.outcome = Outcome::kRight;
  return result;
}

// Relative L2 distance of the displacements from those with a quarter of the step, over the first
// thousand samples; NaN where that run is refused or stops.
double distance_from_quarter(std::string_view simulator, Scene scene, double step,
                             const CellRun& cell) {
  const auto& coarse = cell.points.front().displacement;
  const std::size_t count = std::min<std::size_t>(coarse.size(), 1000);
  scene.duration = static_cast<double>(4 * (count - 1) + 1) * (0.25 * step);
  CellRun run;
  try {
    run = simulate(simulator, scene, 0.25 * step);
  } catch (const InvalidInput&) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  if (run.simulation.diverged_at) return std::numeric_limits<double>::quiet_NaN();
  const auto& fine = run.points.front().displacement;
  double error = 0.0, power = 1e-290;
  for (std::size_t k = 0; k < count; ++k) {
    error += std::pow(coarse[k] - fine[4 * k], 2);
    power += std::pow(fine[4 * k], 2);
  }
  return std::sqrt(error / power);
}

}  // namespace

CellResult run_cell(std::string_view simulator, Scene scene, double time_step,
                    std::size_t samples) {
  scene.duration = static_cast<double>(samples) * time_step;
  CellRun run;
  try {
    run = simulate(simulator, scene, time_step);
  } catch (const InvalidInput& refusal) {
    return {.outcome = Outcome::kRefused, .reason = refusal.what()};
  }
  const Simulation& simulation = run.simulation;
  if (simulation.diverged_at) {
    const bool clear = !simulation.explanation.empty() && simulation.force.samples.empty();
    return {.outcome = clear ? Outcome::kReported : Outcome::kWrong,
            .reason = simulation.explanation};
  }
  CellResult result = judged(scene, run, time_step, hold_of(simulator));
  if (result.outcome == Outcome::kRight && result.allowed >= kTightBound) {
    result.distance = distance_from_quarter(simulator, scene, time_step, run);
  }
  return result;
}

std::size_t affordable_samples(const Scene& scene, double time_step) {
  const double modes = static_cast<double>(scene.string.modes);
  const double radians = 6.28 * scene.string.fundamental * modes * time_step;
  const double operations = modes * (1.0 + std::min(radians, 8.0));
  return static_cast<std::size_t>(std::clamp(5e5 / operations, 20.0, 20000.0));
}

}  // namespace modcal
