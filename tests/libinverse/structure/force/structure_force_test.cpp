// The force at a structure's contact from sensors that contradict each other.
#include "libinverse/structure/force/structure_force.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libinverse/structure/tuning.hpp"
#include "libsim/base/error.hpp"
#include "libsim/base/random.hpp"
#include "tests/refusal.hpp"

namespace modcal::structure_force_test {
namespace {

constexpr double kRate = 3200.0;
constexpr std::size_t kSamples = 3200;
const std::vector<ModalPole> kPoles = {{2.0 * std::numbers::pi * 61.0, 0.02},
                                       {2.0 * std::numbers::pi * 140.0, 0.01},
                                       {2.0 * std::numbers::pi * 287.0, 0.015}};

double constant(std::size_t sensor, std::size_t mode) {
  return std::cos(1.0 + 2.0 * static_cast<double>(sensor) + 1.3 * static_cast<double>(mode));
}

// Exact but for 1 % of what its modes make, as the table says.
StructureTable table_of(const std::vector<std::size_t>& sensors) {
  StructureTable table{.low = 20.0, .high = 400.0};
  table.model.poles = kPoles;
  for (const std::size_t k : sensors) {
    table.model.sensors.push_back(SensorKind::kDisplacement);
    for (std::size_t n = 0; n < kPoles.size(); ++n) {
      table.model.constants.push_back(constant(k, n));
    }
    table.scatters.push_back({.modal = 0.01, .noise = 1e-9});
  }
  return table;
}

struct Burst {
  double at, size;
};

std::vector<double> force_of(const std::vector<Burst>& bursts) {
  std::vector<double> force(kSamples);
  for (std::size_t j = 0; j < kSamples; ++j) {
    const double t = static_cast<double>(j) / kRate;
    for (const auto& [at, size] : bursts) {
      force[j] += size * std::exp(-0.5 * std::pow((t - at) / 2e-3, 2)) * std::cos(700.0 * (t - at));
    }
  }
  return force;
}

// Three sensors of which the first reads a tenth too much and the last a twentieth too little.
StructureRecord record_under(const std::vector<double>& force,
                             const std::vector<std::size_t>& sensors) {
  StructureRecord record{.sample_rate = kRate};
  for (const std::size_t k : sensors) {
    const double gain = k == 0 ? 1.1 : k == 2 ? 0.95 : 1.0;
    std::vector<double> answer(kSamples);
    for (std::size_t j = 0; j < kSamples; ++j) {
      const double t = static_cast<double>(j) / kRate;
      for (std::size_t n = 0; n < kPoles.size(); ++n) {
        const auto [omega, zeta] = kPoles[n];
        const double damped = omega * std::sqrt(1.0 - zeta * zeta);
        answer[j] += gain * constant(k, n) / damped * std::exp(-zeta * omega * t) *
                     std::sin(damped * t) / kRate;
      }
    }
    std::vector<double>& response = record.responses.emplace_back(kSamples);
    for (std::size_t j = 0; j < kSamples; ++j) {
      for (std::size_t i = 0; i <= j; ++i) response[j] += force[i] * answer[j - i];
    }
  }
  return record;
}

// White noise of a share of each response.
StructureRecord in_noise(StructureRecord record, double share) {
  std::vector<double> draws(kSamples);
  for (std::size_t k = 0; k < record.responses.size(); ++k) {
    std::vector<double>& response = record.responses[k];
    fill_standard_normal(StreamKey(1).with(k), draws);
    double squares = 0.0;
    for (const double sample : response) squares += sample * sample;
    const double deviation = share * std::sqrt(squares / kSamples);
    for (std::size_t j = 0; j < kSamples; ++j) response[j] += deviation * draws[j];
  }
  return record;
}

// By default under bursts from 0.1 s to 0.6 s.
StructureRecord record_of(const std::vector<std::size_t>& sensors,
                          const std::vector<Burst>& bursts = {
                              {0.1, 1.0}, {0.17, 1.0}, {0.33, 1.0}, {0.6, 1.0}}) {
  return record_under(force_of(bursts), sensors);
}

StructureForce force_by(const std::vector<std::size_t>& sensors) {
  return structure_force(
      table_of(sensors), record_of(sensors),
      {.shape = ForceShape::kSmooth, .window = 1.0, .draws = 2, .may_have_changed = false});
}

// (K − 1)/K Σ (f_k − mean)² of the forces without one sensor each, as wide as Student's t of two
// degrees of freedom, 4.303, is beyond the normal's 1.960. The power that the force is supposed to
// have, which all sensors tell, is another where two of them do.
TEST(StructureForce, HasTheJackknifeOfSensorsThatContradictEachOther) {
  const StructureForce found = force_by({0, 1, 2});
  const std::vector<double> without[] = {force_by({1, 2}).force, force_by({0, 2}).force,
                                         force_by({0, 1}).force};
  double expected = 0.0, told = 0.0;
  for (std::size_t j = 0; j < found.force.size(); ++j) {
    const double mean = (without[0][j] + without[1][j] + without[2][j]) / 3.0;
    for (const auto& force : without) {
      expected += 2.0 / 3.0 * std::pow(4.303 / 1.960 * (force[j] - mean), 2);
    }
    told += found.by_model[j] * found.by_model[j];
  }
  EXPECT_GT(expected, 0.0);
  EXPECT_NEAR(std::sqrt(told / expected), 1.0, 0.1);
}

// A mode that the strike did not tell has deviations of any size.
TEST(StructureForce, IsFiniteByATableThatDoesNotTellAMode) {
  StructureTable table = table_of({0, 1});
  table.frequency_deviations.assign(table.model.poles.size(), 1e-3);
  table.frequency_deviations[0] = 300.0;
  const StructureForce found =
      structure_force(table, record_of({0, 1}), {.shape = ForceShape::kSmooth, .window = 1.0});
  for (const double deviation : found.deviation) ASSERT_TRUE(std::isfinite(deviation));
}

TEST(StructureForce, TriesNoPulsesWhereNoiseIsAllThereIs) {
  StructureRecord record = record_of({0, 1, 2});
  const StructureForceOptions options{.window = 0.2, .draws = 2};
  EXPECT_FALSE(std::isnan(structure_force(table_of({0, 1, 2}), record, options).evidence_impacts));
  for (std::vector<double>& response : record.responses) {
    for (double& sample : response) sample *= 1e-9;
  }
  const StructureForce found = structure_force(table_of({0, 1, 2}), record, options);
  EXPECT_TRUE(std::isnan(found.evidence_impacts));
  EXPECT_LT(found.told, 1.0);
  EXPECT_EQ(found.shape, ForceShape::kSmooth);
}

// Of a push that sets in and stays, the power is that of 1/f: between 20 and 36 Hz 3.4 times that
// of the 32 Hz above. A blow's is even.
TEST(StructureForce, IsAPushWhereItPushesAndNoneWhereItStrikesInNoiseToo) {
  std::vector<double> push(kSamples, 0.0), blow(kSamples, 0.0);
  for (std::size_t j = 0; j < kSamples; ++j) {
    const double t = static_cast<double>(j) / kRate - 0.3;
    push[j] = t > 0.0 ? 1.0 : 0.0;
    blow[j] = std::exp(-0.5 * std::pow(t / 5e-4, 2));
  }
  const std::vector<std::size_t> sensors = {1, 3};
  const StructureForceOptions options{.window = 0.5, .draws = 2};
  for (const double noise : {0.0, 0.1, 0.5}) {
    SCOPED_TRACE(noise);
    const StructureForce pushed =
        structure_force(table_of(sensors), in_noise(record_under(push, sensors), noise), options);
    EXPECT_FALSE(pushed.from_zero);
    EXPECT_GT(pushed.rise, kRise);
    const StructureForce struck =
        structure_force(table_of(sensors), in_noise(record_under(blow, sensors), noise), options);
    EXPECT_NEAR(struck.rise, 1.0, 0.3);
    // Loud noise hides the pulses.
    EXPECT_EQ(pushed.shape, noise == 0.0 ? ForceShape::kImpacts : ForceShape::kSmooth);
    EXPECT_EQ(struck.shape, noise < 0.5 ? ForceShape::kImpacts : ForceShape::kSmooth);
    if (noise == 0.0) {
      EXPECT_GT(pushed.push_odds, kPushOdds);
    }
    if (noise < 0.5) {
      EXPECT_LT(struck.push_odds, 0.0);
    }
  }
}

TEST(StructureForce, OfABandFromZeroIsToldFromAPushToo) {
  std::vector<double> blow(kSamples, 0.0);
  for (std::size_t j = 0; j < kSamples; ++j) {
    blow[j] = std::exp(-0.5 * std::pow((static_cast<double>(j) / kRate - 0.3) / 5e-4, 2));
  }
  StructureTable table = table_of({1, 3});
  table.low = 0.0;
  const StructureForce struck =
      structure_force(table, record_under(blow, {1, 3}), {.window = 0.5, .draws = 2});
  EXPECT_TRUE(struck.from_zero);
  EXPECT_EQ(struck.shape, ForceShape::kImpacts);
  EXPECT_LT(struck.push_odds, 0.0);
}

ActingPart part_of(const std::vector<Burst>& bursts, const StructureForceOptions& options) {
  return acting_part(table_of({0, 1, 2}), record_of({0, 1, 2}, bursts), options);
}

// Bursts last 8 ms to either side. Three modes in 380 Hz have 4 ms, half a period of their mean
// spacing; from the end of what is quiet the window is a quarter and 4 ms longer than the force,
// and another 10 ms where its deviation, as the sensors contradict each other, is that of a tenth.
TEST(ActingPart, EndsSoonAfterTheForceAndHoldsItsLastBlow) {
  const ActingPart once = part_of({{0.15, 1.0}}, {.rests = true, .quiet = 0.125});
  EXPECT_EQ(once.first, 400u);
  EXPECT_GT(once.duration, 0.025);
  EXPECT_LT(once.duration, 1.25 * 0.033 + 0.015);
  const ActingPart again = part_of({{0.15, 1.0}, {0.4, 0.3}}, {.rests = true, .quiet = 0.125});
  EXPECT_GT(again.duration, 0.275);
  EXPECT_LT(again.duration, 1.25 * 0.283 + 0.005);
  const ActingPart never_quiet = part_of({{0.15, 1.0}}, {});
  EXPECT_EQ(never_quiet.first, 0u);
  EXPECT_GT(never_quiet.duration, 0.15);
  EXPECT_LT(never_quiet.duration, 1.25 * 0.158 + 0.005);
}

// The responses are larger in the last tenth than before.
TEST(ActingPart, IsAllOfARecordWhoseLastBlowIsLate) {
  const ActingPart late = part_of({{0.15, 0.3}, {0.95, 1.0}}, {.rests = true, .quiet = 0.125});
  EXPECT_DOUBLE_EQ(late.duration, 0.875);
  EXPECT_EQ(late.weak_until, 0.0);
  const ActingPart once = part_of({{0.15, 0.3}}, {.rests = true, .quiet = 0.125});
  EXPECT_LT(once.duration, 0.1);
  EXPECT_NEAR(once.weak_until, 0.125 + 0.9 * 0.875, 1e-12);
}

TEST(ActingPart, IsTheWindowThatIsStated) {
  const ActingPart stated = part_of({{0.15, 1.0}}, {.window = 0.8, .rests = true, .quiet = 0.125});
  EXPECT_EQ(stated.first, 0u);
  EXPECT_EQ(stated.duration, 0.8);
  EXPECT_THAT(refusal_of([] {
                structure_force(table_of({0, 1}), record_of({0, 1}),
                                {.window = 0.8, .sigma = 20.0, .draws = 2});
              }),
              testing::HasSubstr("leaves exp(-16) at the end of a window of 0.8 s"));
}

// Lines half a hertz apart are no modes: half a period of theirs is all of a second. Twenty periods
// of the band of 380 Hz are 53 ms.
TEST(ActingPart, ByFineLinesEndsSoonAfterTheForce) {
  StructureTable table = table_of({1, 2});
  FrequencyGrid grid{.spacing = std::numbers::pi, .bins = 1201};
  std::vector<std::vector<Complex>> functions(2, std::vector<Complex>(grid.bins));
  for (std::size_t k = 0; k < 2; ++k) {
    for (std::size_t m = 0; m < grid.bins; ++m) {
      for (std::size_t n = 0; n < kPoles.size(); ++n) {
        functions[k][m] += constant(k + 1, n) / kPoles[n].denominator(grid.s(m));
      }
    }
  }
  table.measured = {.grid = grid, .sensors = table.model.sensors, .sessions = {functions}};
  const ActingPart part = acting_part(table, record_of({1, 2}, {{0.15, 1.0}}), {});
  EXPECT_EQ(part.first, 0u);
  EXPECT_GT(part.duration, 0.15);
  EXPECT_LT(part.duration, 1.25 * 0.158 + 0.053 + 0.01);
  EXPECT_NEAR(part.weak_until, 0.8, 1e-12);
}

TEST(ActingPart, IsFoundByItsOwnContourAndTheForceBeginsWithTheRecord) {
  const std::vector<Burst> bursts = {{0.15, 1.0}};
  const StructureForce found =
      structure_force(table_of({1, 2}), record_of({1, 2}, bursts),
                      {.sigma = 15.0, .rests = true, .quiet = 0.125, .draws = 2});
  EXPECT_EQ(found.sigma, 15.0);
  EXPECT_LT(found.window, 0.2);
  const std::vector<double> force = force_of(bursts);
  double off = 0.0, power = 0.0;
  for (std::size_t j = 0; j < found.force.size(); ++j) {
    EXPECT_TRUE(j >= 400 || found.force[j] == 0.0) << j;
    off += std::pow(found.force[j] - force[j], 2);
    power += force[j] * force[j];
  }
  // The last sensor reads a twentieth too little.
  EXPECT_LT(std::sqrt(off / power), 0.05);
  EXPECT_EQ(found.deviation.size(), found.force.size());
}

}  // namespace
}  // namespace modcal::structure_force_test
