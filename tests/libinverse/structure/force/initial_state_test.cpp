// What a structure rings of before its record begins, and the force beside it.
#include "libinverse/structure/force/initial_state.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "libinverse/structure/force/structure_force.hpp"
#include "libsim/base/random.hpp"
#include "libsim/base/turn.hpp"

namespace modcal::initial_state_test {
namespace {

constexpr double kRate = 2000.0;
constexpr std::size_t kSamples = 2000;

StructureTable table() {
  StructureTable result{.low = 20.0, .high = 300.0};
  result.model.poles = {{kTurn * 70.0, 0.01}, {kTurn * 160.0, 0.008}};
  result.model.sensors.assign(2, SensorKind::kDisplacement);
  result.model.constants = {1.0, -0.6, 0.5, 1.1};
  result.model.quadrature.assign(4, 0.0);
  result.model.residuals.assign(2, {});
  result.scatters.assign(2, {.modal = 1e-4, .noise = 1e-9});
  result.frequency_deviations.assign(2, 0.0);
  result.damping_deviations.assign(2, 0.0);
  return result;
}

// Modes one by one: x¨ + 2ζω x˙ + ω² x = f, struck by f_j/f_s at every sample, from (x, x˙) on.
StructureRecord record(const std::vector<double>& force, double displacement, double velocity) {
  const StructureTable told = table();
  StructureRecord result{.sample_rate = kRate};
  result.responses.assign(2, std::vector<double>(kSamples, 0.0));
  for (std::size_t n = 0; n < 2; ++n) {
    const auto [omega, zeta] = told.model.poles[n];
    const double damped = omega * std::sqrt(1.0 - zeta * zeta), decay = zeta * omega;
    const double step = 1.0 / kRate, fades = std::exp(-decay * step);
    const double c = std::cos(damped * step), s = std::sin(damped * step) / damped;
    double x = displacement, v = velocity;
    for (std::size_t j = 0; j < kSamples; ++j) {
      for (std::size_t k = 0; k < 2; ++k) result.responses[k][j] += told.model.constant(k, n) * x;
      v += force[j] / kRate;
      const double next = fades * (x * (c + decay * s) + v * s);
      v = fades * (v * (c - decay * s) - x * omega * omega * s);
      x = next;
    }
  }
  for (std::size_t k = 0; k < 2; ++k) {
    std::vector<double> noise(kSamples);
    fill_standard_normal(StreamKey(3).with(k), noise);
    for (std::size_t j = 0; j < kSamples; ++j) result.responses[k][j] += 1e-9 * noise[j];
  }
  return result;
}

// Smooth, of 20 N about 90 Hz and 40 Hz.
std::vector<double> smooth_force() {
  std::vector<double> force;
  for (std::size_t j = 0; j < kSamples; ++j) {
    const double t = static_cast<double>(j) / kRate;
    force.push_back(14.0 * std::sin(kTurn * 91.3 * t + 0.4) + 14.0 * std::cos(kTurn * 41.7 * t));
  }
  return force;
}

StructureForce found_in(const StructureRecord& record) {
  return structure_force(table(), record, {.shape = ForceShape::kSmooth, .window = 0.5});
}

TEST(InitialState, OfAFreeDecayIsNoForce) {
  const std::vector<double> none(kSamples, 0.0);
  const StructureForce found = found_in(record(none, 1e-4, 0.03));
  EXPECT_TRUE(found.rang);
  // The force that would have made it: v f_s on the first sample, 60 N.
  for (const double force : found.force) EXPECT_LT(std::abs(force), 0.05);
}

TEST(InitialState, BesideAForceChangesItByLessThanItsDeviation) {
  const StructureForce rest = found_in(record(smooth_force(), 0.0, 0.0));
  const StructureForce rang = found_in(record(smooth_force(), 1e-4, 0.03));
  EXPECT_TRUE(rang.rang);
  for (std::size_t j = 0; j < rang.force.size(); ++j) {
    EXPECT_LT(std::abs(rang.force[j] - rest.force[j]), 2.0 * rang.deviation[j]) << j;
  }
}

StructureTable table_of_one() {
  StructureTable one = table();
  one.model.sensors.resize(1);
  one.model.constants.resize(2);
  one.model.quadrature.resize(2);
  one.model.residuals.resize(1);
  one.scatters.resize(1);
  return one;
}

// The force sets in and acts on when the record ends. What it leaves ringing there is a share
// exp(−σT) of all on the contour and, taken for a force, 8 deviations off where the record begins.
// The force's step at the end is beyond the band: half a period of its 300 Hz is not compared.
TEST(InitialState, OfOneSensorHoldsWhatTheEndCutsOff) {
  std::vector<double> force = smooth_force();
  for (std::size_t j = 0; j < kSamples; ++j)
    force[j] *= std::min(1.0, static_cast<double>(j) / 200.0);
  StructureRecord first = record(force, 0.0, 0.0);
  first.responses.resize(1);
  const StructureForce found =
      structure_force(table_of_one(), first,
                      {.shape = ForceShape::kSmooth, .window = first.duration(), .rests = true});
  EXPECT_FALSE(found.rang);
  std::size_t held = 0;
  double worst = 0.0;
  const auto count = kSamples - static_cast<std::size_t>(0.5 * kRate / 300.0);
  for (std::size_t j = 0; j < count; ++j) {
    const double z = std::abs(found.force[j] - force[j]) / found.deviation[j];
    worst = std::max(worst, z);
    held += z < 2.0 ? 1 : 0;
  }
  EXPECT_LT(worst, 5.0);
  EXPECT_GT(static_cast<double>(held), 0.9 * static_cast<double>(count));
}

// What rang before is a hundred times what the end cuts off: no width of that holds it. Of a free
// decay alone nothing is left for a force but where the state is not told from one.
TEST(InitialState, OfOneSensorThatRangHasNoWidth) {
  const std::vector<double> none(kSamples, 0.0);
  StructureRecord first = record(none, 1e-4, 0.03);
  first.responses.resize(1);
  const StructureForce found = structure_force(
      table_of_one(), first, {.shape = ForceShape::kSmooth, .window = first.duration()});
  EXPECT_TRUE(found.rang);
  for (const double force : found.force) EXPECT_LT(std::abs(force), 0.05);
}

// A third mode that the sensor does not hear, above the band.
TEST(InitialState, OfOneSensorHasNoModesThatItDoesNotHear) {
  StructureTable one = table_of_one();
  one.model.poles.push_back({kTurn * 900.0, 0.01});
  one.model.constants = {1.0, -0.6, 0.0};
  one.model.quadrature.assign(3, 0.0);
  one.frequency_deviations.assign(3, 0.0);
  one.damping_deviations.assign(3, 0.0);
  StructureRecord first = record(smooth_force(), 0.0, 0.0);
  first.responses.resize(1);
  const StructureForce found = structure_force(
      one, first, {.shape = ForceShape::kSmooth, .window = first.duration(), .rests = true});
  for (std::size_t j = 0; j < kSamples; ++j) {
    ASSERT_TRUE(std::isfinite(found.force[j]) && std::isfinite(found.deviation[j])) << j;
  }
}

TEST(InitialState, OfOneSensorIsNotLookedForBehindAQuietBeginning) {
  const StructureTable one = table_of_one();
  StructureRecord first = record(smooth_force(), 1e-4, 0.03);
  first.responses.resize(1);
  const auto rang = [&](bool rests) {
    return structure_force(one, first,
                           {.shape = ForceShape::kSmooth, .window = 0.5, .rests = rests})
        .rang;
  };
  EXPECT_FALSE(rang(true));
  EXPECT_TRUE(rang(false));
}

// y = X c and noise of V: the state is found within its deviations, four numbers of 50 draws; the
// mean square of 200 normal numbers is 1 ± .1.
TEST(InitialState, IsKnownAsWellAsItsRootSays) {
  const std::vector<double> none(kSamples, 0.0);
  const StructureTable told = table();
  ContourSpectra spectra = ContourSpectra::of(record(none, 0.0, 0.0), 8.0, 20.0, 300.0);
  const Transfers transfers = transfers_of(told.model, spectra);
  const double sd = 1e-3;
  const BinVariances variances{.of = std::vector(2, std::vector<double>(spectra.count(), sd * sd))};
  const std::vector<double> power(spectra.count(), 1e-20);  // no force
  const Eigen::Vector4d state(1.0, -2.0, 0.5, 3.0);
  for (std::vector<Complex>& response : spectra.responses) {
    std::ranges::fill(response, Complex(0.0));
  }
  const Transfers rings = [&] {
    Transfers result = InitialState(told.model, spectra).without(-state);
    return result;
  }();
  // Bins of a contour tell alike: noise as that of bins that do not is κ times as sure.
  double squares = 0.0;
  for (std::uint64_t draw = 0; draw < 50; ++draw) {
    std::vector<double> normal(4 * spectra.count());
    fill_standard_normal(StreamKey(draw).with("noise"), normal);
    for (std::size_t k = 0; k < 2; ++k) {
      for (std::size_t m = 0; m < spectra.count(); ++m) {
        const double* z = &normal[2 * (k * spectra.count() + m)];
        spectra.responses[k][m] = rings[k][m] + sd * std::sqrt(0.5) * Complex(z[0], z[1]);
      }
    }
    const InitialState::Fit fit =
        InitialState(told.model, spectra).fit(transfers, variances, power);
    const Eigen::VectorXd off = fit.root.colPivHouseholderQr().solve(fit.state - state);
    squares += off.squaredNorm() / 200.0 * spectra.correlated();
  }
  EXPECT_NEAR(squares, 1.0, 0.3);
}

// Nothing but noise: no force is told, and its error bar is not 0. |f| beyond five deviations has a
// chance of 6e-7 a sample.
TEST(InitialState, OfNoiseAloneIsNoneAndTheForceHasAnErrorBar) {
  const std::vector<double> none(kSamples, 0.0);
  const StructureForce found = found_in(record(none, 0.0, 0.0));
  EXPECT_FALSE(found.rang);
  for (std::size_t j = 0; j < found.force.size(); ++j) {
    EXPECT_LT(std::abs(found.force[j]), 5.0 * found.deviation[j]) << j;
  }
}

}  // namespace
}  // namespace modcal::initial_state_test
