#include "benchmarks/stress/stress_cell.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "benchmarks/stress/energy_meter.hpp"
#include "libsim/base/error.hpp"
#include "libsim/dynamics/event/modal_event.hpp"
#include "libsim/dynamics/fixed_step/fixed_step.hpp"
#include "libsim/dynamics/scene/contact_modes.hpp"

namespace modcal {
namespace {

// A simulation and the motion of every contact point.
struct CellRun {
  Simulation simulation;
  std::vector<PointMotion> points;
  EventEnergy energy;  // of modal_event, over its own steps
};

CellRun simulate_wide(const Scene& scene, double step, bool is_explicit) {
  CellRun cell;
  const OutputRequest outputs{.displacement = true, .velocity = true, .force = true};
  cell.simulation = simulate_fixed_step(scene, 1.0 / step, outputs, {}, step,
                                        is_explicit ? kNewmarkScheme : kExactScheme, &cell.points);
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
    auto [run, energy] = simulate_audited(ModalEvent({}), scene, rate, outputs);
    cell.simulation = std::move(run);
    cell.energy = energy;
  }
  PointMotion point(0);
  point.displacement = cell.simulation.displacement.samples;
  point.velocity = cell.simulation.velocity.samples;
  point.force = cell.simulation.force.samples;
  cell.points.push_back(std::move(point));
  return cell;
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
  // At the instant of a lift the normal force is what two rounded times leave of it.
  const double rounding = 1e-14 * force_limit(scene, *law, bow.normal_force.highest());
  for (const PointMotion& point : cell.points) {
    for (std::size_t k = 0; k < point.force.size(); ++k) {
      const double t = static_cast<double>(k) * step;
      const double limit = force_limit(scene, *law, bow.normal_force.at(t));
      const double solved = cell.points.size() > 1 ? 1e-7 : 1e-12;
      if (std::abs(point.force[k]) <= limit * (1.0 + solved) + rounding) continue;
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

// The energies of a cell in one form for all simulators.
struct Balance {
  // Residuals and their bounds over all energy at hand [1].
  struct Share {
    double open = 0.0, allowed = 0.0;
  };
  std::vector<Share> shares;
  double contact_loss = 0.0, contact_throughput = 0.0;  // [J]
  double contact_may_give = 0.0;                        // [J]
};

// Below 1e-290 J products of samples are denormal or zero.
constexpr double kNoEnergy = 1e-290;

// The fixed steps' energies from their samples: every step's force is known.
Balance sampled_balance(const Scene& scene, const CellRun& cell, double step, ForceHold hold) {
  const BowMotion bow = bow_motion(scene.bow, scene.duration);
  std::vector<PointRecord> records;
  for (const PointMotion& point : cell.points) {
    records.push_back({point.displacement, point.velocity, point.force});
  }
  const EnergyAccount energy =
      audit_energy(scene_line_modes(scene), bow, records, 1.0 / step, hold);
  const double at_hand = energy.throughput + energy.dissipated + energy.largest_stored + kNoEnergy;
  Balance balance{
      .shares = {{std::abs(energy.string_residual()) / at_hand, energy.rounding / at_hand}},
      .contact_loss = energy.contact_loss(),
      .contact_throughput = energy.contact_throughput,
      .contact_may_give = energy.rounding};
  const double limit = force_limit(scene, *scene.friction.make(), bow.normal_force.highest());
  for (const PointMotion& point : cell.points) {
    balance.contact_may_give += switching_tolerance(point, bow, limit, step);
  }
  return balance;
}

// The event-driven run's own account, of string and contact.
Balance event_balance(const EventEnergy& energy) {
  const double string = energy.string_at_hand() + kNoEnergy;
  const double contact = energy.contact_at_hand() + kNoEnergy;
  const double heat = energy.heat_residual / contact;
  return {.shares = {{std::abs(energy.string_residual()) / string, energy.string_bound() / string},
                     {std::abs(energy.contact_residual()) / contact,
                      energy.contact_bound() / contact + heat}},
          .contact_loss = energy.bow_work - energy.string_work,
          .contact_throughput = energy.contact_throughput,
          .contact_may_give = energy.contact_bound() + energy.wound};
}

Balance balance_of(std::string_view simulator, const Scene& scene, const CellRun& cell,
                   double step) {
  if (simulator == "modal_event") return event_balance(cell.energy);
  return sampled_balance(scene, cell, step,
                         simulator == "newmark_explicit" ? ForceHold::kLagged : ForceHold::kLinear);
}

CellResult judged(std::string_view simulator, const Scene& scene, const CellRun& cell,
                  double step) {
  CellResult result;
  if (!all_finite(cell)) {
    result.reason = "a sample is not finite";
    return result;
  }
  result.reason = excess_force(scene, bow_motion(scene.bow, scene.duration), cell, step);
  if (!result.reason.empty()) return result;
  const Balance energy = balance_of(simulator, scene, cell, step);
  result.passivity = energy.contact_loss / (energy.contact_throughput + kNoEnergy);
  for (const auto& [open, allowed] : energy.shares) {
    result.unbalanced = std::max(result.unbalanced, open);
    result.allowed = std::max(result.allowed, allowed);
    if (open <= allowed + 1e-15 && allowed < kTightBound) continue;
    result.reason = fmt::format("energy balance open by {:.1e}, allowed {:.1e}", open, allowed);
    return result;
  }
  const double given = -energy.contact_loss - energy.contact_may_give;
  if (!(given <= 1e-9 * energy.contact_throughput)) {
    result.reason =
        fmt::format("the contact gives energy: {:.1e} of what goes through it", -result.passivity);
    return result;
  }
  result.outcome = Outcome::kRight;
  return result;
}

// Relative L2 distance of every stride-th sample of y from a reference.
double distance_between(const std::vector<double>& y, std::size_t stride,
                        const std::vector<double>& reference) {
  double error = 0.0, power = kNoEnergy;
  for (std::size_t k = 0; k < reference.size(); ++k) {
    error += std::pow(y[stride * k] - reference[k], 2);
    power += std::pow(reference[k], 2);
  }
  return std::sqrt(error / power);
}

// The displacements, as many as `samples`, of an event-driven run with a quarter of the step.
// Nothing where it is refused or stops.
std::optional<std::vector<double>> quarter_run(const Scene& scene, double step,
                                               std::size_t samples) {
  Scene part = scene;
  part.duration = static_cast<double>(samples) * step;
  try {
    const Simulation run =
        ModalEvent({.max_step = 0.25 * step}).simulate(part, 1.0 / step, {.displacement = true});
    if (!run.diverged_at) return run.displacement.samples;
  } catch (const InvalidInput&) {
  }
  return std::nullopt;
}

// The same with every mode 1e-12 m/s faster at t = 0.
Scene disturbed(Scene scene) {
  const ModalBasis basis = make_modal_basis(scene.string);
  scene.initial = initial_state(scene, basis);
  scene.initial.displacement.resize(basis.size());
  scene.initial.velocity.resize(basis.size());
  for (double& velocity : scene.initial.velocity) velocity += 1e-12;
  return scene;
}

// Whether an event-driven run keeps its motion with a quarter of the step, over the first thousand
// samples, and if not, whether the motion has digits that could be kept.
void compare_with_quarter(const Scene& scene, double step, const CellRun& cell,
                          CellResult& result) {
  const auto& y = cell.points.front().displacement;
  const std::size_t samples = std::min<std::size_t>(y.size(), 1000);
  const auto fine = quarter_run(scene, step, samples);
  if (!fine) return;
  result.distance = distance_between(y, 1, *fine);
  if (result.distance <= kSameMotion) return;
  const auto moved = quarter_run(disturbed(scene), step, samples);
  if (moved) result.sensitivity = distance_between(*moved, 1, *fine);
  if (result.sensitivity > kNoDigits) return;
  result.outcome = Outcome::kWrong;
  result.reason = fmt::format(
      "y moves by {:.1e} with a quarter of the step, by {:.1e} with 1e-12 "
      "m/s more",
      result.distance, result.sensitivity);
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
  CellResult result = judged(simulator, scene, run, time_step);
  if (result.outcome == Outcome::kRight && simulator == "modal_event") {
    compare_with_quarter(scene, time_step, run, result);
  }
  return result;
}

std::size_t affordable_samples(const Scene& scene, double time_step) {
  const double modes = static_cast<double>(scene.string.modes);
  const double radians = 6.28 * scene.string.fundamental * modes * time_step;
  const double operations = modes * (1.0 + std::min(radians, 8.0));
  // The audit takes a step in parts of at most four radians of the fastest mode, each of some 300
  // operations a mode.
  const double audited = 1e9 / (300.0 * modes * (1.0 + radians / 4.0));
  return static_cast<std::size_t>(std::clamp(std::min(5e5 / operations, audited), 4.0, 20000.0));
}

}  // namespace modcal
