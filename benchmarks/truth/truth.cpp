#include "benchmarks/truth/truth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "benchmarks/truth/decimator.hpp"

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
        decimators_(5, Decimator(factor(), options.filtered)) {
    if (string.torsion) {
      torsion_.emplace(torsional(string, *string.torsion), grid_);
      mobility_ += torsion_->mobility(contact_at_);
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
  double surface_velocity() const {
    return velocity(wave_) + (torsion_ ? velocity(*torsion_) : 0.0);
  }
  double energy() const { return wave_.energy() + (torsion_ ? torsion_->energy() : 0.0); }
  double reaction(bool right) const;
  ContactState force_at(double time, double free_velocity);
  void wait();  ///< at rest, before the gesture
  void step(std::size_t index);
  void check(const ContactState& state, double time);

  TruthGesture gesture_;
  TruthOptions options_;
  WaveGrid grid_;
  Wave wave_;
  std::optional<Wave> torsion_;
  Interpolation contact_at_;
  std::vector<double> reaction_;
  double line_mobility_, mobility_;  ///< of the centre line, of the surface
  std::optional<Contact> contact_;
  std::vector<Decimator> decimators_;  ///< R1, R2, f, y, v
  std::size_t stuck_ = 0, slips_ = 0;
  bool was_stuck_ = false;
  TruthAudit audit_;
};

double Session::reaction(bool right) const {
  const double* y = wave_.y();
  double even = 0.0, odd = 0.0;
  for (std::size_t i = 0; i < reaction_.size(); i += 2) {
    const std::size_t j = i + 1;
    even += reaction_[i] * y[right ? grid_.intervals - j : j];
    odd += reaction_[j] * y[right ? grid_.intervals - j - 1 : j + 1];
  }
  return even + odd;
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
  decimators_[0].push(reaction(false));
  decimators_[1].push(reaction(true));
  decimators_[2].push(0.0);
  decimators_[3].push(contact_at_.of(wave_.y()));
  decimators_[4].push(0.0);
}

void Session::step(std::size_t index) {
  const double time = static_cast<double>(index) * grid_.time_step;
  decimators_[0].push(reaction(false));
  decimators_[1].push(reaction(true));
  decimators_[3].push(contact_at_.of(wave_.y()));
  wave_.advance();
  if (torsion_) torsion_->advance();
  const double free = velocity(wave_);
  const ContactState state = force_at(time, free + (torsion_ ? velocity(*torsion_) : 0.0));
  if (state.force != 0.0) {
    wave_.push(contact_at_, state.force);
    if (torsion_) torsion_->push(contact_at_, state.force);
  }
  decimators_[2].push(state.force);
  decimators_[4].push(free + line_mobility_ * state.force);
  stuck_ += state.stuck;
  slips_ += was_stuck_ && !state.stuck;
  was_stuck_ = state.stuck;
  if (options_.audit) check(state, time);
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
  if (options_.noise_level > 0.0) add_noise(record, options_.noise_level, options_.seed);
  return record;
}

/// Counter-based: draw i of a channel depends on nothing else (SplitMix64; Steele, Lea and Flood,
/// 2014).
double uniform(std::uint64_t seed, std::uint64_t counter) {
  std::uint64_t z = seed * 0xD1342543DE82EF95u + (counter + 1) * 0x9E3779B97F4A7C15u;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  z ^= z >> 31;
  return (static_cast<double>(z >> 11) + 0.5) * 0x1.0p-53;
}

double deviation(const std::vector<double>& samples) {
  double mean = 0.0, square = 0.0;
  for (const double x : samples) mean += x / static_cast<double>(samples.size());
  for (const double x : samples) square += (x - mean) * (x - mean);
  return std::sqrt(square / static_cast<double>(samples.size()));
}

}  // namespace

double TruthString::bending() const {
  const double width = length / std::numbers::pi;
  return inharmonicity * tension() * width * width;
}

double value_at(const Course& course, double time) {
  if (time <= course.front().time) return course.front().value;
  for (std::size_t i = 1; i < course.size(); ++i) {
    if (time >= course[i].time) continue;
    const Knot &a = course[i - 1], &b = course[i];
    return a.value + (b.value - a.value) * (time - a.time) / (b.time - a.time);
  }
  return course.back().value;
}

WaveGrid grid_of(const TruthString& string, const TruthOptions& options) {
  require(options.sample_rate > 0.0 && options.least_rate > 0.0, "rates must be > 0");
  const double multiple = std::ceil(options.least_rate / (8.0 * options.sample_rate) - 1e-9);
  std::size_t intervals = options.intervals;
  if (intervals == 0) {
    // n f₀ √(1 + B n²) = f_s/2.
    const double part = 0.5 * options.sample_rate / string.fundamental, b = string.inharmonicity;
    const double square =
        b > 0.0 ? (std::sqrt(1.0 + 4.0 * b * part * part) - 1.0) / (2.0 * b) : part * part;
    intervals =
        std::max<std::size_t>(128, static_cast<std::size_t>(std::ceil(3.0 * std::sqrt(square))));
  }
  return {.intervals = intervals,
          .time_step = 1.0 / (8.0 * multiple * options.sample_rate),
          .half_width = options.half_width,
          .loss_half_width = options.half_width / 2};
}

TruthRecord simulate(const TruthString& string, const TruthGesture& gesture,
                     const TruthOptions& options) {
  require(string.fundamental > 0.0 && string.length > 0.0 && string.linear_density > 0.0,
          "f0, L and the linear density must be > 0");
  require(string.inharmonicity >= 0.0 && string.loss >= 0.0 && string.diffusion >= 0.0,
          "B and the losses must be >= 0");
  require(options.duration > 0.0, "duration must be > 0");
  const WaveGrid grid = grid_of(string, options);
  const double cell = string.length / static_cast<double>(grid.intervals);
  const double reach = cell * (kInterpolationPoints / 2);
  if (!(gesture.position > reach) || !(gesture.position < string.length - reach)) {
    throw std::invalid_argument(
        fmt::format("contact at {:g} m: {} cells of {:g} m are needed on both sides of it",
                    gesture.position, kInterpolationPoints / 2, cell));
  }
  return Session(string, gesture, options).run();
}

void add_noise(TruthRecord& record, double level, std::uint64_t seed) {
  std::vector<double>* const channels[] = {&record.r1, &record.r2};
  for (std::uint64_t c = 0; c < 2; ++c) {
    record.noise[c] = level * deviation(*channels[c]);
    for (std::size_t i = 0; i < channels[c]->size(); ++i) {
      const double radius = std::sqrt(-2.0 * std::log(uniform(2 * seed + c, 2 * i)));
      const double turn = 2.0 * std::numbers::pi * uniform(2 * seed + c, 2 * i + 1);
      (*channels[c])[i] += record.noise[c] * radius * std::cos(turn);
    }
  }
}

}  // namespace modcal::truth
