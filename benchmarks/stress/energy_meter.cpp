#include "benchmarks/stress/energy_meter.hpp"

#include <algorithm>
#include <cmath>

namespace modcal::event {
namespace {

// ∫₀^θ.
double integral_to(std::span<const double> powers, double theta) {
  double sum = 0.0;
  for (std::size_t p = powers.size(); p-- > 0;) {
    sum = sum * theta + powers[p] / static_cast<double>(p + 1);
  }
  return sum * theta;
}

// Powers of θ of the polynomial on [from, from + scale].
std::vector<double> restricted(std::span<const double> powers, double from, double scale) {
  std::vector<double> result(powers.begin(), powers.end());
  const std::size_t count = result.size();
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = count - 1; k-- > i;) result[k] += from * result[k + 1];
  }
  double factor = 1.0;
  for (double& c : result) {
    c *= factor;
    factor *= scale;
  }
  return result;
}

}  // namespace

EnergyMeter::EnergyMeter(const EventLoop& loop, const ContactModes& modes, const EventState& start)
    : stiffness_(loop.contact.stiffness),
      damping_(loop.contact.damping),
      law_(loop.law),
      thermal_(loop.thermal),
      replay_(modes),
      rule_(gauss_rule(14)),
      sticking_(start.sticking),
      elongation_(start.sticking ? start.elongation : 0.0),
      start_energy_(replay_.energy(start.modes)),
      start_spring_(spring_energy()) {}

void EnergyMeter::piece(const ForcePiece& piece) {
  if (!(piece.duration > 0.0)) return;
  const double phase = replay_.fastest() * piece.duration;
  if (phase > ModeReplay::kLongestPhase) return divide(piece, phase);
  part(piece);
}

void EnergyMeter::divide(const ForcePiece& piece, double phase) {
  const double parts = std::ceil(phase / ModeReplay::kLongestPhase);
  const double length = 1.0 / parts, duration = piece.duration / parts;
  for (int k = 0; k < parts; ++k) {
    const std::vector<double> force = restricted(piece.force, k * length, length);
    const std::vector<double> rise = restricted(piece.rise, k * length, length);
    ForcePiece smaller = piece;
    smaller.duration = duration;
    smaller.force = force;
    smaller.rise = rise;
    smaller.drive = piece.drive.from(k * duration);
    part(smaller);
  }
}

// The force that the law asks for at the slip velocity v_c.
double EnergyMeter::law_force(const ForcePiece& piece, double theta, double slip,
                              double elongation) const {
  if (piece.phase == ContactPhase::kFree) return 0.0;
  if (piece.phase == ContactPhase::kSticking) return -stiffness_ * elongation - damping_ * slip;
  const double load = piece.drive.load_at(theta * piece.duration);
  if (thermal_) {
    return -piece.side * load * thermal_->softening_at(power_sum(piece.rise, theta)).coefficient;
  }
  return -piece.side * load * sliding_force(law_, std::max(0.0, piece.side * slip));
}

void EnergyMeter::part(const ForcePiece& piece) {
  const double h = piece.duration;
  sum_.dissipated += replay_.advance(h, {&piece.force, 1}, velocities_);
  const std::vector<double>& velocity = velocities_[0];
  ++sum_.pieces;
  sum_.pieces_and_radians += 1.0 + replay_.fastest() * h;
  if (piece.phase == ContactPhase::kFree) return;
  double explained = 0.0;  // heat of the contact
  for (std::size_t g = 0; g < rule_.node.size(); ++g) {
    const double theta = rule_.node[g], weight = rule_.weight[g] * h;
    const double f = power_sum(piece.force, theta), v = power_sum(velocity, theta);
    const double bow = piece.drive.velocity_at(theta * h), slip = v - bow;
    const double elongation =
        piece.phase == ContactPhase::kSticking
            ? elongation_ + h * integral_to(velocity, theta) - piece.drive.travel(theta * h)
            : 0.0;
    const double law = law_force(piece, theta, slip, elongation);
    sum_.bow_work += weight * f * bow;
    sum_.string_work += weight * f * v;
    sum_.throughput += weight * std::abs(f * v);
    sum_.bow_throughput += weight * std::abs(f * bow);
    sum_.contact_throughput += weight * std::abs(f * slip);
    sum_.defect += weight * std::abs((f - law) * slip);
    if (piece.phase == ContactPhase::kSticking) {
      sum_.damper += weight * damping_ * slip * slip;
    } else {
      sum_.friction -= weight * law * slip;
      if (thermal_) {
        const double speed = piece.side * slip, rise = power_sum(piece.rise, theta);
        explained += weight * (std::abs(law) * speed -
                               (thermal_->conductance + thermal_->carried * speed) * rise);
      }
    }
  }
  if (piece.phase == ContactPhase::kSticking) {
    elongation_ += h * integral_to(velocity, 1.0) - piece.drive.travel(h);
  } else if (thermal_) {
    const double change = power_sum(piece.rise, 1.0) - power_sum(piece.rise, 0.0);
    sum_.heat_residual += std::abs(thermal_->capacity * change - explained);
  }
}

void EnergyMeter::attached(double elongation) {
  sticking_ = true;
  elongation_ = elongation;
  sum_.wound += spring_energy();
}

void EnergyMeter::released() {
  sum_.dropped += spring_energy();
  sticking_ = false;
  elongation_ = 0.0;
}

EventEnergy EnergyMeter::account(const EventState& end) const {
  EventEnergy result = sum_;
  result.spring = (sticking_ ? spring_energy() : 0.0) - start_spring_;
  const double end_energy = replay_.energy(end.modes);
  result.stored = end_energy - start_energy_;
  result.largest_stored = std::max(start_energy_, end_energy);
  return result;
}

}  // namespace modcal::event

namespace modcal {

AuditedRun simulate_audited(const ModalEvent& simulator, const Scene& scene, double sample_rate,
                            const OutputRequest& outputs) {
  AuditedRun result;
  std::optional<event::EnergyMeter> meter;
  result.simulation = simulator.simulate_watched(
      scene, sample_rate, outputs,
      {.begin = [&](const auto& loop, const auto& modes,
                    const auto& state) { return &meter.emplace(loop, modes, state); },
       .end = [&](const auto& state) { result.energy = meter->account(state); }});
  return result;
}

}  // namespace modcal
