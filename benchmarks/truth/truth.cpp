#include "benchmarks/truth/truth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "benchmarks/truth/bridge.hpp"
#include "benchmarks/truth/decimator.hpp"
#include "benchmarks/truth/sensor.hpp"

namespace modcal::truth {
namespace {

constexpr std::size_t kInterpolationPoints = 16;
constexpr std::size_t kReactionPoints = 12;

void require(bool condition, const char* message) {
  if (!condition) throw std::invalid_argument(message);
}

WaveEquation transverse(const TruthString& string) {
  return {.length = string.length,
          .density = string.linear_density,
          .speed = string.wave_speed(),
          .stiffness = std::sqrt(string.bending() / string.linear_density),
          .loss = string.loss,
          .diffusion = string.diffusion};
}

/// Z_τ = ρ_τ c_τ.
WaveEquation torsional(const TruthString& string, const TruthTorsion& torsion) {
  return {.length = string.length,
          .density = string.linear_density * torsion.impedance_ratio / torsion.speed_ratio,
          .speed = string.wave_speed() * torsion.speed_ratio,
          .stiffness = 0.0,
          .loss = torsion.loss,
          .diffusion = torsion.diffusion};
}

/// Weights of −T y'(0), or of −T y'(0) + EI y'''(0), by the points next to the end.
std::vector<double> reaction_weights(const TruthString& string, double spacing, Reactions kind) {
  Series series(kReactionPoints, 0.0L);
  series[0] = string.tension() / spacing;
  if (kind == Reactions::kSupport) series[1] = string.bending() / (spacing * spacing * spacing);
  std::vector<double> weights = matched_odd_weights(series);
  for (double& w : weights) w = -w;
  return weights;
}

/// Triangle with its corner at x_c, averaged over the width.
std::vector<double> drawn_aside(const TruthPluck& pluck, double position, const Wave& wave) {
  const double length = wave.equation().length, half = 0.5 * pluck.width;
  require(position - half > 0.0 && position + half < length,
          "the finger reaches beyond the string");
  std::vector<double> shape(wave.grid().intervals + 1);
  const double kink = pluck.height * (1.0 / position + 1.0 / (length - position));
  for (std::size_t j = 0; j < shape.size(); ++j) {
    const double x = wave.spacing() * static_cast<double>(j), from = x - position;
    shape[j] = pluck.height * std::min(x / position, (length - x) / (length - position));
    if (std::abs(from) < half) {
      const double inside = half - std::abs(from);
      shape[j] -= kink * inside * inside / (4.0 * half);
    }
  }
  return shape;
}

/// String, torsion and contact at work.
class Session {
 public:
  Session(const TruthString& string, const TruthGesture& gesture, const TruthOptions& options)
      : gesture_(gesture),
        options_(options),
        grid_(grid_of(string, options)),
        wave_(transverse(string), grid_),
        contact_at_(interpolation_at(gesture.position / wave_.spacing(), kInterpolationPoints)),
        reaction_(reaction_weights(string, wave_.spacing(), options.reactions)),
        line_mobility_(wave_.mobility(contact_at_)),
        mobility_(line_mobility_),
        sensor_({.gain = options.mismatch.gain,
                 .delay = options.mismatch.delay,
                 .corner = options.mismatch.corner,
                 .body_peak = options.mismatch.body_peak,
                 .body_frequency = options.mismatch.body_frequency,
                 .body_damping = options.mismatch.body_damping},
                1.0 / grid_.time_step),
        decimators_(5, Decimator(factor(), options.filtered)) {
    if (string.torsion) {
      torsion_.emplace(torsional(string, *string.torsion), grid_);
      mobility_ += torsion_->mobility(contact_at_);
    }
    if (options.mismatch.polarization[0] != 0.0 || options.mismatch.polarization[1] != 0.0) {
      TruthString other = string;
      other.fundamental *= 1.0 + options.mismatch.detuning;
      other_.emplace(transverse(other), grid_);
    }
    if (options.mismatch.bridge_mass > 0.0) {
      bridge_.emplace(string, options.mismatch, grid_);
      support_ = reaction_weights(string, wave_.spacing(), Reactions::kSupport);
      chord_ = gesture.position / string.length;
      chord_force_ = string.tension() / string.length;
    }
    if (const auto* bow = std::get_if<TruthBow>(&gesture.action)) {
      contact_.emplace(bow->friction, grid_.time_step);
    } else if (const auto* pluck = std::get_if<TruthPluck>(&gesture.action)) {
      wave_.set_rest(drawn_aside(*pluck, gesture.position, wave_));
    }
  }

  TruthRecord run();

 private:
  std::size_t factor() const {
    return static_cast<std::size_t>(std::llround(1.0 / (grid_.time_step * options_.sample_rate)));
  }
  /// Velocity of the contact between the last two changes, v = (d_c^n + d_c^{n+1})/2k.
  double velocity(const Wave& wave) const {
    return (contact_at_.of(wave.change()) + contact_at_.of(wave.last_change())) /
           (2.0 * grid_.time_step);
  }
  double line_velocity() const {
    return velocity(wave_) + (bridge_ ? chord_ * bridge_->velocity() : 0.0);
  }
  double line_displacement() const {
    return contact_at_.of(wave_.y()) + (bridge_ ? chord_ * bridge_->displacement() : 0.0);
  }
  double surface_velocity() const {
    return line_velocity() + (torsion_ ? velocity(*torsion_) : 0.0);
  }
  double energy() const { return wave_.energy() + (torsion_ ? torsion_->energy() : 0.0); }
  double reaction(const std::vector<double>& weights, const Wave& wave, bool right) const;
  void read_ends();
  ContactState force_at(double time, double free_velocity);
  void wait();  ///< at rest, before the gesture
  void step(std::size_t index);
  void drift(double time);
  void wander(double time);
  void check(const ContactState& state, double time);

  TruthGesture gesture_;
  TruthOptions options_;
  WaveGrid grid_;
  Wave wave_;
  std::optional<Wave> torsion_, other_;  ///< other_: the second polarization
  Interpolation contact_at_;
  std::vector<double> reaction_, support_;  ///< support_: of what moves the bridge
  std::optional<Bridge> bridge_;
  double chord_ = 0.0, chord_force_ = 0.0;  ///< x_c/L [1], T/L [N/m]
  double tension_ = 1.0;                    ///< over that of the string: drift
  double line_mobility_, mobility_;         ///< of the centre line, of the surface
  TruthSensor sensor_;
  std::optional<Contact> contact_;
  std::vector<Decimator> decimators_;  ///< R1, R2, f, y, v
  std::size_t stuck_ = 0, slips_ = 0;
  bool was_stuck_ = false;
  TruthAudit audit_;
};

double Session::reaction(const std::vector<double>& weights, const Wave& wave, bool right) const {
  const double* y = wave.y();
  double even = 0.0, odd = 0.0;
  for (std::size_t i = 0; i < weights.size(); i += 2) {
    const std::size_t j = i + 1;
    even += weights[i] * y[right ? grid_.intervals - j : j];
    odd += weights[j] * y[right ? grid_.intervals - j - 1 : j + 1];
  }
  return even + odd;
}

void Session::read_ends() {
  double ends[2];
  for (std::size_t r = 0; r < 2; ++r) {
    ends[r] = tension_ * reaction(reaction_, wave_, r == 1);
    if (other_) ends[r] += options_.mismatch.polarization[r] * reaction(reaction_, *other_, r == 1);
    if (bridge_) ends[r] += (r == 1 ? chord_force_ : -chord_force_) * bridge_->displacement();
  }
  decimators_[0].push(ends[0]);
  decimators_[1].push(sensor_.read(ends[1]));
}

ContactState Session::force_at(double time, double free_velocity) {
  if (const auto* bow = std::get_if<TruthBow>(&gesture_.action)) {
    return contact_->solve({.free_velocity = free_velocity,
                            .mobility = mobility_,
                            .bow_velocity = value_at(bow->velocity, time),
                            .normal_force = value_at(bow->normal_force, time)});
  }
  if (const auto* stated = std::get_if<TruthForce>(&gesture_.action)) {
    return {.force = value_at(stated->force, time)};
  }
  return {};
}

void Session::wait() {
  read_ends();
  decimators_[2].push(0.0);
  decimators_[3].push(line_displacement());
  decimators_[4].push(0.0);
}

void Session::step(std::size_t index) {
  const double time = static_cast<double>(index) * grid_.time_step;
  read_ends();
  decimators_[3].push(line_displacement());
  if (options_.mismatch.drift != 0.0) drift(time);
  if (options_.mismatch.wander != 0.0) wander(time);
  const double moved = bridge_ ? bridge_->acceleration(reaction(support_, wave_, true)) : 0.0;
  wave_.advance();
  if (bridge_) {
    wave_.push_everywhere(bridge_->load(), -moved);
    bridge_->advance(moved);
  }
  if (torsion_) torsion_->advance();
  if (other_) other_->advance();
  const double free = line_velocity();
  const ContactState state = force_at(time, free + (torsion_ ? velocity(*torsion_) : 0.0));
  if (state.force != 0.0) {
    wave_.push(contact_at_, state.force);
    if (torsion_) torsion_->push(contact_at_, state.force);
    if (other_) other_->push(contact_at_, state.force);
  }
  decimators_[2].push(state.force);
  decimators_[4].push(free + line_mobility_ * state.force);
  stuck_ += state.stuck;
  slips_ += was_stuck_ && !state.stuck;
  was_stuck_ = state.stuck;
  if (options_.audit) check(state, time);
}

void Session::drift(double time) {
  const double part = (time - options_.start) / options_.duration - 0.5;
  const double relative = 2.0 * options_.mismatch.drift * part;  // T ∝ f₀²
  wave_.retune(relative);
  tension_ = 1.0 + relative;
}

void Session::wander(double time) {
  const TruthMismatch& m = options_.mismatch;
  const double since = time - options_.start;
  const double turn = m.wander_frequency > 0.0
                          ? std::sin(2.0 * std::numbers::pi * m.wander_frequency * since)
                          : 2.0 * since / options_.duration - 1.0;
  const double position = gesture_.position + m.wander * turn;
  contact_at_ = interpolation_at(position / wave_.spacing(), kInterpolationPoints);
  const double before = line_mobility_;
  line_mobility_ = wave_.mobility(contact_at_);
  mobility_ += line_mobility_ - before;
  if (bridge_) chord_ = position / (wave_.spacing() * static_cast<double>(grid_.intervals));
}

void Session::check(const ContactState& state, double time) {
  const double velocity = surface_velocity(), k = grid_.time_step;
  double bow_velocity = velocity;
  if (const auto* bow = std::get_if<TruthBow>(&gesture_.action)) {
    bow_velocity = value_at(bow->velocity, time);
    const double slip = velocity - bow_velocity, normal = value_at(bow->normal_force, time);
    const double mu = contact_->last_coefficient(state.stuck ? 0.0 : std::abs(slip));
    const double beyond = state.stuck ? std::abs(state.force) - mu * normal
                                      : std::abs(state.force + std::copysign(mu * normal, slip));
    if (normal > 0.0) {
      audit_.friction_violation = std::max(audit_.friction_violation, beyond / normal);
    }
  }
  const double power = -state.force * (velocity - bow_velocity);
  audit_.least_heat_power = std::min(audit_.least_heat_power, power);
  audit_.heat += power * k;
  audit_.bow_work += state.force * bow_velocity * k;
  audit_.lost += wave_.lost() + (torsion_ ? torsion_->lost() : 0.0);
  audit_.largest = std::max({audit_.largest, std::abs(audit_.bow_work), audit_.lost});
}

TruthRecord Session::run() {
  const double begin = energy();
  audit_.largest = begin;
  const auto count =
      static_cast<std::size_t>(std::llround(options_.duration * options_.sample_rate));
  const auto start = std::llround(options_.start * options_.sample_rate);
  const auto lead = static_cast<std::size_t>(std::max(-start, 0LL));
  const auto first = static_cast<std::size_t>(std::max(start, 0LL));
  for (std::size_t i = 0; i < lead * factor(); ++i) wait();
  const std::size_t needed = (first + count) * factor() + decimators_[0].latency();
  const std::size_t steps = needed - std::min(needed, lead * factor());
  for (std::size_t i = 0; i < steps; ++i) step(i);
  audit_.stored = energy() - begin;

  TruthRecord record{.rate = options_.sample_rate,
                     .internal_rate = 1.0 / grid_.time_step,
                     .intervals = grid_.intervals,
                     .stuck = static_cast<double>(stuck_) / static_cast<double>(steps),
                     .slips = slips_,
                     .audit = audit_};
  std::vector<double>* const channels[] = {&record.r1, &record.r2, &record.f, &record.y, &record.v};
  for (std::size_t c = 0; c < decimators_.size(); ++c) {
    const auto from = decimators_[c].samples().begin() + static_cast<std::ptrdiff_t>(first);
    channels[c]->assign(from, from + static_cast<std::ptrdiff_t>(count));
  }
  for (std::size_t n = 1; n < grid_.intervals; ++n) record.modes.push_back(wave_.mode(n));
  if (bridge_) record.modes = bridge_->coupled(record.modes);
  if (options_.noise_level > 0.0) add_noise(record, options_.noise_level, options_.seed);
  return record;
}

}  // namespace

TruthRecord simulate(const TruthString& string, const TruthGesture& gesture,
                     const TruthOptions& options) {
  require(string.fundamental > 0.0 && string.length > 0.0 && string.linear_density > 0.0,
          "f0, L and the linear density must be > 0");
  require(string.inharmonicity >= 0.0 && string.loss >= 0.0 && string.diffusion >= 0.0,
          "B and the losses must be >= 0");
  const bool still = options.mismatch.drift == 0.0 && options.mismatch.wander == 0.0;
  require((still && options.mismatch.bridge_mass == 0.0) || !options.audit,
          "the audit is of a string between ends at rest that keeps its tension");
  require(options.mismatch.bridge_mass >= 0.0, "the mass of the bridge must be >= 0");
  require(options.duration > 0.0, "duration must be > 0");
  const WaveGrid grid = grid_of(string, options);
  const double cell = string.length / static_cast<double>(grid.intervals);
  constexpr std::size_t kCellsBeside = kInterpolationPoints / 2;
  const double reach = cell * kCellsBeside;
  if (!(gesture.position > reach) || !(gesture.position < string.length - reach)) {
    throw std::invalid_argument(
        fmt::format("contact at {:g} m: {} cells of {:g} m are needed on both sides of it",
                    gesture.position, kCellsBeside, cell));
  }
  return Session(string, gesture, options).run();
}

}  // namespace modcal::truth
