// Forces at several contacts at once.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libinverse/structure/force/structure_force.hpp"
#include "libinverse/structure/tuning.hpp"
#include "libsim/base/random.hpp"
#include "libsim/base/turn.hpp"
#include "tests/refusal.hpp"

namespace modcal::contacts_test {
namespace {

constexpr double kRate = 2048.0;
constexpr std::size_t kSamples = 4096, kModes = 8;
using testing::HasSubstr;

double shape(std::size_t n, double place) {
  return std::sin((static_cast<double>(n) + 1.0) * 0.5 * kTurn * place);
}

// Modes of a bar on supports, 60 to 480 Hz, driven at `place`, under `sensors` displacements.
StructureTable driven_at(double place, std::size_t sensors) {
  StructureTable table{.low = 30.0, .high = 520.0};
  for (std::size_t n = 0; n < kModes; ++n) {
    table.model.poles.push_back({kTurn * (60.0 + 60.0 * static_cast<double>(n)), 0.02});
  }
  table.model.sensors.assign(sensors, SensorKind::kDisplacement);
  for (std::size_t k = 0; k < sensors; ++k) {
    const double at = 0.09 + 0.17 * static_cast<double>(k);
    for (std::size_t n = 0; n < kModes; ++n) {
      table.model.constants.push_back(shape(n, place) * shape(n, at));
    }
  }
  table.scatters.assign(sensors, {.modal = 1e-3, .noise = 0.0});
  return table;
}

// Noise between 60 and 450 Hz that sets in after 0.1 s.
std::vector<double> noise_force(std::uint64_t seed) {
  const RealFft fft(kSamples);
  std::vector<double> normal(kSamples);
  fill_standard_normal(StreamKey(seed).with("force"), normal);
  std::vector<Complex> bins = fft.forward(normal);
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const double at = static_cast<double>(i) * kRate / kSamples;
    bins[i] *= at > 60.0 ? std::exp(-std::pow(at / 420.0, 8)) : 0.0;
  }
  std::vector<double> force = fft.inverse(std::move(bins));
  for (std::size_t j = 0; j < kSamples; ++j) {
    force[j] *= std::clamp((static_cast<double>(j) / kRate - 0.1) / 0.05, 0.0, 1.0);
  }
  return force;
}

// Adds what a force does, mode by mode, held from sample to sample by its mean.
void drive(const StructureTable& table, const std::vector<double>& force,
           std::vector<std::vector<double>>& responses) {
  constexpr std::size_t kSteps = 16;  // of a sample: the force is linear between
  const double step = 1.0 / kRate / kSteps;
  for (std::size_t n = 0; n < kModes; ++n) {
    const auto [omega, zeta] = table.model.poles[n];
    const double damped = omega * std::sqrt(1.0 - zeta * zeta);
    const Complex root(-zeta * omega, damped), turn = std::exp(root * step);
    Complex state = 0.0;
    for (std::size_t j = 1; j < kSamples; ++j) {
      for (std::size_t i = 0; i < kSteps; ++i) {
        const double share = (static_cast<double>(i) + 0.5) / kSteps;
        const double mean = (1.0 - share) * force[j - 1] + share * force[j];
        state = turn * state + mean * (turn - 1.0) / root;
      }
      for (std::size_t k = 0; k < responses.size(); ++k) {
        responses[k][j] += table.model.constant(k, n) * state.imag() / damped;
      }
    }
  }
}

struct Driven {
  std::vector<StructureTable> tables;
  std::vector<std::vector<double>> forces;
  StructureRecord record{.sample_rate = kRate};
};

// White noise of `noise` times the rms of every response.
Driven driven(const std::vector<double>& places, std::size_t sensors, double noise,
              std::uint64_t seed) {
  Driven result;
  result.record.responses.assign(sensors, std::vector<double>(kSamples, 0.0));
  for (const double place : places) {
    result.tables.push_back(driven_at(place, sensors));
    result.forces.push_back(noise_force(seed + result.forces.size()));
    drive(result.tables.back(), result.forces.back(), result.record.responses);
  }
  for (std::size_t k = 0; k < sensors; ++k) {
    std::vector<double>& response = result.record.responses[k];
    std::vector<double> normal(kSamples);
    fill_standard_normal(StreamKey(seed).with("noise").with(k), normal);
    double squares = 0.0;
    for (const double x : response) squares += x * x / kSamples;
    const double sd = noise * std::sqrt(squares);
    for (std::size_t j = 0; j < kSamples; ++j) response[j] += sd * normal[j];
    for (StructureTable& table : result.tables) table.scatters[k].noise = sd;
  }
  return result;
}

struct Score {
  double error, coverage;
};

// Over what of the record is loud and not at its end, which nothing tells.
Score score_of(const StructureForce& found, const std::vector<double>& truth) {
  double off = 0.0, all = 0.0, inside = 0.0, count = 0.0;
  for (std::size_t j = truth.size() / 10; j < truth.size() * 8 / 10; ++j) {
    const double error = found.force[j] - truth[j];
    off += error * error, all += truth[j] * truth[j], count += 1.0;
    inside += std::abs(error) <= 1.959964 * found.deviation[j] ? 1.0 : 0.0;
  }
  return {std::sqrt(off / all), inside / count};
}

constexpr StructureForceOptions kSmooth{.shape = ForceShape::kSmooth, .rests = true, .draws = 4};

// As well as each is told where it acts alone, but for the noise that the other has in common with
// all sensors.
TEST(Contacts, TellTheirForcesAtOnce) {
  for (const double noise : {1e-3, 1e-2}) {
    SCOPED_TRACE(noise);
    const Driven it = driven({0.23, 0.61}, 5, noise, 3);
    const std::vector<StructureForce> found = structure_forces(it.tables, it.record, kSmooth);
    ASSERT_EQ(found.size(), 2u);
    for (std::size_t p = 0; p < 2; ++p) {
      const auto [error, coverage] = score_of(found[p], it.forces[p]);
      EXPECT_EQ(found[p].forces, 2u);
      EXPECT_LT(error, 0.1);
      EXPECT_GT(coverage, 0.95);
      EXPECT_NEAR(found[p].misfit, 1.0, 0.25);
    }
    const Driven one = driven({0.23}, 5, noise, 3);
    const Score alone =
        score_of(structure_forces(one.tables, one.record, kSmooth)[0], one.forces[0]);
    EXPECT_LT(score_of(found[0], it.forces[0]).error, 1.5 * alone.error);
    // One force cannot have done both.
    const StructureForce both = structure_force(it.tables[0], it.record, kSmooth);
    EXPECT_GT(contradiction_of(both.sensor_left), kContradiction * kContradiction);
    EXPECT_LT(contradiction_of(found[0].sensor_left, 2), kContradiction * kContradiction);
  }
}

// Cut out of its middle, the structure rings when the record begins, and forces go on at its end.
TEST(Contacts, AreToldBesideWhatRangBefore) {
  Driven it = driven({0.23, 0.61}, 6, 1e-3, 9);
  constexpr std::ptrdiff_t kFirst = kSamples / 3;
  for (std::vector<double>& response : it.record.responses) {
    response.erase(response.begin(), response.begin() + kFirst);
  }
  StructureForceOptions options = kSmooth;
  options.rests = false;
  const std::vector<StructureForce> found = structure_forces(it.tables, it.record, options);
  for (std::size_t p = 0; p < 2; ++p) {
    EXPECT_TRUE(found[p].rang);
    std::vector<double>& truth = it.forces[p];
    truth.erase(truth.begin(), truth.begin() + kFirst);
    const auto [error, coverage] = score_of(found[p], truth);
    EXPECT_LT(error, 0.15) << p;
    EXPECT_GT(coverage, 0.95) << p;
  }
}

TEST(Contacts, AreFewerThanSensors) {
  const Driven it = driven({0.23, 0.61}, 2, 1e-3, 3);
  EXPECT_THAT(refusal_of([&] { structure_forces(it.tables, it.record, kSmooth); }),
              HasSubstr("2 sensors read what forces at 2 contacts explain whatever they read"));
  std::vector<StructureTable> apart = driven({0.23, 0.61}, 3, 1e-3, 3).tables;
  apart[1].low = 2.0 * apart[0].high;
  apart[1].high = 3.0 * apart[0].high;
  const Driven three = driven({0.23}, 3, 1e-3, 3);
  EXPECT_THAT(refusal_of([&] { structure_forces(apart, three.record, kSmooth); }),
              HasSubstr("no band in common"));
}

}  // namespace
}  // namespace modcal::contacts_test
