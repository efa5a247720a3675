#include "benchmarks/stress/energy_account.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <vector>

#include "libsim/base/error.hpp"

namespace modcal {

namespace {

constexpr std::size_t kMostTerms = 64;  // the most that terms() asks for, at 4 radians, is 35

constexpr double kEpsilon = 2.220446049250313e-16;

using PointSamples = std::vector<std::vector<double>>;  // points × samples

// Mean force of the step after sample k for kLagged; no force is known before t = 0.
double lagged_force(std::span<const double> force, std::size_t k) {
  return 0.5 * (force[k] + (k > 0 ? force[k - 1] : 0.0));
}

// The string under forces straight between the samples; returns the velocity of every point that
// they explain.
PointSamples replay_linear(const LineModes& modes, std::span<const PointRecord> points, double step,
                           EnergyAccount& account) {
  ModeReplay replay(modes);
  const double parts =
      std::max(1.0, std::ceil(replay.fastest() * step / ModeReplay::kLongestPhase));
  const double part = step / parts;
  const std::size_t count = points.front().force.size();
  PointSamples replayed(points.size(), std::vector<double>(count));
  PointPowers force(points.size(), std::vector<double>(2)), velocity;
  const std::vector<std::span<const double>> pushes(force.begin(), force.end());
  const double start = replay.energy();
  for (std::size_t k = 0; k + 1 < count; ++k) {
    for (int p = 0; p < parts; ++p) {
      for (std::size_t j = 0; j < points.size(); ++j) {
        const double change = points[j].force[k + 1] - points[j].force[k];
        force[j] = {points[j].force[k] + change * (p / parts), change / parts};
      }
      account.dissipated += replay.advance(part, pushes, velocity);
      for (std::size_t j = 0; j < points.size(); ++j) {
        if (k == 0 && p == 0) replayed[j][0] = velocity[j][0];
        replayed[j][k + 1] = 0.0;
        for (std::size_t i = 0; i < velocity[j].size(); ++i) {
          const auto power = static_cast<double>(i);
          replayed[j][k + 1] += velocity[j][i];
          account.string_work +=
              part * velocity[j][i] * (force[j][0] / (power + 1.0) + force[j][1] / (power + 2.0));
        }
      }
    }
  }
  const double end = replay.energy();
  account.stored = end - start;
  account.largest_stored = std::max(start, end);
  return replayed;
}

// The string by the trapezoidal rule under the forces of the steps before.
void replay_lagged(const LineModes& modes, std::span<const PointRecord> points, double h,
                   EnergyAccount& account) {
  const std::size_t count = points.front().force.size();
  std::vector<double> load(count);
  double start = 0.0, end = 0.0;
  for (std::size_t n = 0; n < modes.size(); ++n) {
    std::fill(load.begin(), load.end(), 0.0);
    for (std::size_t j = 0; j < points.size(); ++j) {
      const double drive = modes.shape[j][n] * modes.inverse_mass[n];
      for (std::size_t k = 0; k < count; ++k) load[k] += drive * points[j].force[k];
    }
    const double mass = 1.0 / modes.inverse_mass[n], decay = -modes.pole[n].real() * h;
    const double square = std::norm(modes.pole[n]), quarter = 0.25 * square * h * h;
    double v = modes.initial[n].real() - modes.quadrature[n] * modes.initial[n].imag();
    double y = modes.compliance[n] * modes.initial[n].imag();
    start += 0.5 * mass * (v * v + square * y * y);
    for (std::size_t k = 0; k + 1 < count; ++k) {
      const double push = h * (lagged_force(load, k) - square * y);
      const double next = (v * (1.0 - decay - quarter) + push) / (1.0 + decay + quarter);
      const double mean = 0.5 * (v + next);
      y += h * mean;
      v = next;
      account.dissipated += 2.0 * decay * mass * mean * mean;
    }
    end += 0.5 * mass * (v * v + square * y * y);
  }
  account.stored = end - start;
  account.largest_stored = std::max(start, end);
}

// What the samples of a point say themselves: works of the steps and magnitudes. `replayed`: the
// velocity that the force explains; none for kLagged.
void account_contact(const PointRecord& point, const PiecewiseLinear& bow, double h,
                     const std::vector<double>* replayed, EnergyAccount& account) {
  for (std::size_t k = 0; k + 1 < point.force.size(); ++k) {
    const double t = static_cast<double>(k) * h, next = static_cast<double>(k + 1) * h;
    const double travel = bow.integral(next) - bow.integral(t);
    double force = 0.0, velocity = 0.0;
    if (replayed == nullptr) {
      force = lagged_force(point.force, k);
      velocity = (point.displacement[k + 1] - point.displacement[k]) / h;
      account.string_work += force * velocity * h;
    } else {
      force = 0.5 * (point.force[k] + point.force[k + 1]);
      velocity = 0.5 * (point.velocity[k] + point.velocity[k + 1]);
      // The replayed modes have done the work under their own velocity: the rest is the
      // simulator's.
      account.string_work += force * h * (velocity - 0.5 * ((*replayed)[k] + (*replayed)[k + 1]));
      account.bow_work +=
          (point.force[k + 1] - point.force[k]) * (bow.at(next) - bow.at(t)) * h / 12.0;
    }
    account.bow_work += force * travel;
    account.throughput += std::abs(force * velocity) * h;
    account.contact_throughput += std::abs(force * (velocity * h - travel));
  }
}

void require_records(const LineModes& modes, std::span<const PointRecord> points) {
  MODCAL_REQUIRE(points.size() == modes.points(), "{} records for {} contact points", points.size(),
                 modes.points());
  const std::size_t count = points.front().force.size();
  for (const PointRecord& point : points) {
    MODCAL_REQUIRE(count > 0 && point.force.size() == count && point.displacement.size() == count &&
                       point.velocity.size() == count,
                   "an energy account needs displacement, velocity and force, but they have {}, {} "
                   "and {} samples: ask the simulator for all three",
                   point.displacement.size(), point.velocity.size(), point.force.size());
  }
}

}  // namespace

GaussRule gauss_rule(int points) {
  GaussRule rule;
  for (int i = 0; i < points; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (points + 0.5)), slope = 1.0;
    for (int iteration = 0; iteration < 8; ++iteration) {
      double p = 1.0, before = 0.0;
      for (int k = 1; k <= points; ++k) {
        const double next = ((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k;
        before = p;
        p = next;
      }
      slope = points * (x * p - before) / (x * x - 1.0);
      x -= p / slope;
    }
    rule.node.push_back(0.5 * (1.0 - x));
    rule.weight.push_back(1.0 / ((1.0 - x * x) * slope * slope));
  }
  return rule;
}

ModeReplay::ModeReplay(const ContactModes& modes)
    : ModeReplay(modes, modes.drive, {std::vector<double>(modes.size(), 1.0)}) {}

ModeReplay::ModeReplay(const LineModes& modes)
    : ModeReplay(modes, modes.inverse_mass, modes.shape) {}

ModeReplay::ModeReplay(const ModeTable& modes, const std::vector<double>& inverse_mass,
                       const std::vector<std::vector<double>>& shape)
    : modes_(modes),
      inverse_mass_(inverse_mass),
      shape_(shape),
      state_(modes.initial),
      few_(gauss_rule(8)),
      many_(gauss_rule(14)) {
  for (const auto& pole : modes.pole) fastest_ = std::max(fastest_, std::abs(pole));
}

// Behind the last coefficient of the force a term falls by |λ|h/(p + 1) from the one before.
std::size_t ModeReplay::terms(double phase, std::size_t forces) {
  std::size_t p = forces + 1;
  double size = 1.0;
  for (std::size_t k = 1; k < p; ++k) size *= std::min(1.0, phase / static_cast<double>(k));
  // A force of few coefficients need not fall with them: it counts from its last one on.
  if (forces < 8) size = 1.0;
  while (size > 1e-18 && p < kMostTerms) size *= phase / static_cast<double>(p++);
  return p;
}

double ModeReplay::advance(double time, std::span<const std::span<const double>> force,
                           PointPowers& velocity) {
  const double phase = fastest_ * time;
  assert(phase <= kLongestPhase && force.size() == shape_.size());
  const std::size_t count = terms(phase, force[0].size());
  velocity.assign(force.size(), std::vector<double>(count));
  // The rule of 8 points misses e^{2iφθ} by (2φ)¹⁶ (8!)⁴/(17 (16!)³): 5e-15 at φ = 1.7; that of 14
  // by less at 4.
  const GaussRule& rule = phase <= 1.7 ? few_ : many_;
  const std::size_t nodes = rule.node.size();
  double lost = 0.0;
  std::vector<double> series(count);
  for (std::size_t n = 0; n < modes_.size(); ++n) {
    std::complex<double> term = state_[n], end = 0.0;
    for (std::size_t p = 0; p < count; ++p) {
      end += term;
      series[p] = term.real() - modes_.quadrature[n] * term.imag();
      double load = 0.0;
      for (std::size_t j = 0; j < force.size(); ++j) {
        velocity[j][p] += shape_[j][n] * series[p];
        if (p < force[j].size()) load += shape_[j][n] * force[j][p];
      }
      term =
          (modes_.pole[n] * term + inverse_mass_[n] * load) * (time / static_cast<double>(p + 1));
    }
    state_[n] = end;
    // The nodes side by side: a chain of dependent operations each.
    std::array<double, 14> v{};
    for (std::size_t p = count; p-- > 0;) {
      for (std::size_t g = 0; g < nodes; ++g) v[g] = v[g] * rule.node[g] + series[p];
    }
    double square = 0.0;
    for (std::size_t g = 0; g < nodes; ++g) square += rule.weight[g] * v[g] * v[g];
    lost -= 2.0 * modes_.pole[n].real() / inverse_mass_[n] * square;
  }
  return time * lost;
}

double ModeReplay::energy_of(std::size_t n, std::complex<double> z) const {
  const double v = z.real() - modes_.quadrature[n] * z.imag();
  const double y = modes_.compliance[n] * z.imag();
  return 0.5 * (v * v + std::norm(modes_.pole[n]) * y * y) / inverse_mass_[n];
}

double ModeReplay::energy() const {
  double sum = 0.0;
  for (std::size_t n = 0; n < state_.size(); ++n) sum += energy_of(n, state_[n]);
  return sum;
}

double ModeReplay::energy(const PlanarVector& state) const {
  double sum = 0.0;
  for (std::size_t n = 0; n < state_.size(); ++n) sum += energy_of(n, state.at(n));
  return sum;
}

EnergyAccount audit_energy(const LineModes& modes, const BowMotion& bow,
                           std::span<const PointRecord> points, double sample_rate,
                           ForceHold hold) {
  require_records(modes, points);
  const double step = 1.0 / sample_rate;
  EnergyAccount account;
  PointSamples replayed;
  if (hold == ForceHold::kLagged) {
    replay_lagged(modes, points, step, account);
  } else {
    replayed = replay_linear(modes, points, step, account);
  }
  for (std::size_t j = 0; j < points.size(); ++j) {
    account_contact(points[j], bow.velocity, step, replayed.empty() ? nullptr : &replayed[j],
                    account);
  }
  double fastest = 0.0;
  for (const auto& pole : modes.pole) fastest = std::max(fastest, std::abs(pole) * step);
  account.rounding = 4.0 * kEpsilon * static_cast<double>(points.front().force.size()) *
                         (1.0 + fastest) * account.string_at_hand() +
                     1e-12 * (account.throughput + account.dissipated);
  return account;
}

EnergyAccount audit_energy(const Scene& scene, const Simulation& run, ForceHold hold) {
  MODCAL_REQUIRE(scene.bow.points == 1,
                 "{} contact points: a simulation holds their mean motion only; audit the records "
                 "of every point",
                 scene.bow.points);
  const PointRecord point{run.displacement.samples, run.velocity.samples, run.force.samples};
  return audit_energy(scene_line_modes(scene), bow_motion(scene.bow, scene.duration), {&point, 1},
                      run.force.sample_rate, hold);
}

}  // namespace modcal
