#include "libsim/dynamics/energy/energy_audit.hpp"

#include <algorithm>
#include <cmath>

#include "libsim/base/error.hpp"
#include "libsim/dynamics/fixed_step/scene_setup.hpp"

namespace modcal {
namespace {

constexpr double kEpsilon = 2.220446049250313e-16;

ReplayedMode replayed_mode(const LineModes& modes, std::size_t n) {
  return {modes.pole[n], modes.quadrature[n], modes.compliance[n], modes.initial[n]};
}

// Everything that is the string's; returns the velocity of every point that its force explains.
std::vector<std::vector<double>> account_string(const LineModes& modes,
                                                std::span<const PointRecord> points, double step,
                                                ForceHold hold, EnergyAccount& account) {
  const std::size_t count = points.front().force.size();
  std::vector<std::vector<double>> replayed(points.size(), std::vector<double>(count));
  std::vector<double> load(count), velocity(count);
  double start = 0.0, end = 0.0;
  for (std::size_t n = 0; n < modes.size(); ++n) {
    std::fill(load.begin(), load.end(), 0.0);
    for (std::size_t j = 0; j < points.size(); ++j) {
      const double drive = modes.shape[j][n] * modes.inverse_mass[n];
      for (std::size_t k = 0; k < count; ++k) load[k] += drive * points[j].force[k];
    }
    const ModeAccount mode = replay(replayed_mode(modes, n), load, step, hold, velocity);
    const double mass = 1.0 / modes.inverse_mass[n];
    account.string_work += mass * mode.work;
    account.dissipated += mass * mode.loss_rate * mode.square;
    account.stored += mass * (mode.end - mode.start);
    start += mass * mode.start;
    end += mass * mode.end;
    for (std::size_t j = 0; hold != ForceHold::kLagged && j < points.size(); ++j) {
      for (std::size_t k = 0; k < count; ++k) replayed[j][k] += modes.shape[j][n] * velocity[k];
    }
  }
  account.largest_stored = std::max(start, end);
  return replayed;
}

// The bow at the samples.
struct BowRecord {
  std::vector<double> velocity, travel;
  BowRecord(const BowMotion& bow, std::size_t count, double step) {
    for (std::size_t k = 0; k < count; ++k) {
      const double t = static_cast<double>(k) * step;
      velocity.push_back(bow.velocity.at(t));
      travel.push_back(bow.velocity.integral(t));
    }
  }
};

// What the samples of a point say themselves: works of the step and magnitudes.
void account_contact(const PointRecord& point, const BowRecord& bow, double h, ForceHold hold,
                     const std::vector<double>& replayed, EnergyAccount& account) {
  for (std::size_t k = 0; k + 1 < point.force.size(); ++k) {
    const double travel = bow.travel[k + 1] - bow.travel[k];
    double force = 0.0, velocity = 0.0;
    if (hold == ForceHold::kLagged) {
      force = lagged_force(point.force, k);
      velocity = (point.displacement[k + 1] - point.displacement[k]) / h;
      account.string_work += force * velocity * h;
    } else {
      force = 0.5 * (point.force[k] + point.force[k + 1]);
      velocity = 0.5 * (point.velocity[k] + point.velocity[k + 1]);
      // The replayed modes have done the work under their own velocity: the rest is the
      // simulator's.
      account.string_work += force * h * (velocity - 0.5 * (replayed[k] + replayed[k + 1]));
      account.bow_work += (point.force[k + 1] - point.force[k]) *
                          (bow.velocity[k + 1] - bow.velocity[k]) * h / 12.0;
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

EnergyAccount audit_energy(const LineModes& modes, const BowMotion& bow,
                           std::span<const PointRecord> points, double sample_rate,
                           ForceHold hold) {
  require_records(modes, points);
  const double step = 1.0 / sample_rate;
  const std::size_t count = points.front().force.size();
  EnergyAccount account;
  const auto replayed = account_string(modes, points, step, hold, account);
  const BowRecord bow_record(bow, count, step);
  for (std::size_t j = 0; j < points.size(); ++j) {
    account_contact(points[j], bow_record, step, hold, replayed[j], account);
  }
  account.contact_loss = account.bow_work - account.string_work;
  double fastest = 0.0;
  for (const auto& pole : modes.pole) fastest = std::max(fastest, std::abs(pole) * step);
  account.rounding = 4.0 * kEpsilon * static_cast<double>(count) * (1.0 + fastest) *
                         (account.throughput + account.dissipated + account.largest_stored) +
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
