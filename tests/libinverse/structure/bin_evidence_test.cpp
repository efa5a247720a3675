// What sensors tell of each other.
#include "libinverse/structure/bin_evidence.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace modcal::bin_evidence_test {
namespace {

constexpr double kRate = 3200.0;

// Two modes and a sensor for each gain that it has, which a blow after 50 ms makes ring, all of it
// in closed form.
struct Struck {
  StructureTable table{.low = 20.0, .high = 400.0};
  StructureRecord record{.sample_rate = kRate};
};

Struck struck(const std::vector<double>& gains) {
  Struck result;
  result.table.model.poles = {{2.0 * std::numbers::pi * 61.0, 0.03},
                              {2.0 * std::numbers::pi * 140.0, 0.02}};
  for (std::size_t k = 0; k < gains.size(); ++k) {
    result.table.model.sensors.push_back(SensorKind::kDisplacement);
    result.table.scatters.push_back({.modal = 0.01, .noise = 1e-9});
    std::vector<double>& response = result.record.responses.emplace_back(3200);
    for (std::size_t n = 0; n < 2; ++n) {
      const double constant = std::cos(1.0 + 2.0 * static_cast<double>(k + 2 * n));
      result.table.model.constants.push_back(constant);
      const auto [omega, zeta] = result.table.model.poles[n];
      const double damped = omega * std::sqrt(1.0 - zeta * zeta);
      for (std::size_t j = 160; j < response.size(); ++j) {
        const double t = static_cast<double>(j - 160) / kRate;
        response[j] +=
            gains[k] * constant / damped * std::exp(-zeta * omega * t) * std::sin(damped * t);
      }
    }
  }
  return result;
}

std::vector<SensorPrediction> predictions(const std::vector<double>& gains) {
  const Struck it = struck(gains);
  const ContourSpectra spectra = ContourSpectra::of(it.record, 4.0, it.table.low, it.table.high);
  const Transfers transfers = transfers_of(it.table, spectra);
  return predictions_of(spectra, transfers, variances_of(it.table, spectra, transfers));
}

// The others are exact: without the sensor that is off they leave what the sampling makes of them.
// With it two of three leave as much as all do, about 1 a degree of freedom.
TEST(BinEvidence, NamesTheOneSensorThatContradictsTheOthers) {
  for (const std::size_t sensors : {std::size_t{3}, std::size_t{5}}) {
    std::vector<double> gains(sensors, 1.0);
    gains[1] = 1.5;
    const std::vector<SensorPrediction> found = predictions(gains);
    EXPECT_EQ(odd_one_out(found), 1u);
    ASSERT_EQ(found.size(), sensors);
    for (std::size_t k = 0; k < sensors; ++k) {
      if (k == 1) {
        EXPECT_LT(found[k].others, 0.05) << sensors;
      } else {
        EXPECT_GT(found[k].others, 0.5) << sensors << " " << k;
      }
    }
  }
}

// |H|² = E|H_true|² + E|δH|²: where the error is twice |H|² as good as nothing is told, where it is
// half of it half of what a bin tells whose H is known.
TEST(BinEvidence, OfATransferThatIsNoLargerThanItsErrorIsNone) {
  const Struck it = struck({1.0});
  const ContourSpectra spectra = ContourSpectra::of(it.record, 4.0, it.table.low, it.table.high);
  const Transfers transfers = transfers_of(it.table, spectra);
  BinVariances variances{.of = {std::vector<double>(spectra.count(), 1.0)}};
  const BinEvidence known = evidence_of(spectra, transfers, variances, kNoSensor);
  std::vector<double>& error = variances.of_transfer.emplace_back();
  for (const Complex h : transfers[0])
    error.push_back(std::norm(h) * (error.size() % 2 == 0 ? 0.5 : 2.0));
  const BinEvidence found = evidence_of(spectra, transfers, variances, kNoSensor);
  for (std::size_t m = 0; m < spectra.count(); ++m) {
    const double share = found.told[m] / known.told[m];
    if (m % 2 == 0) {
      EXPECT_NEAR(share, 0.5, 1e-12) << m;
    } else {
      EXPECT_LT(share, 0.02) << m;
    }
    // The force of the bin is the same.
    EXPECT_LT(std::abs(found.score[m] / found.told[m] - known.score[m] / known.told[m]),
              1e-9 * std::abs(known.score[m] / known.told[m]));
  }
}

// Of two, either may be the one.
TEST(BinEvidence, NamesNoneOfTwoSensors) {
  for (const SensorPrediction& sensor : predictions({1.0, 1.5})) {
    EXPECT_TRUE(std::isnan(sensor.others));
    EXPECT_GT(sensor.error, 0.0);
  }
}

// A structure that has changed: without any one of them the others contradict each other, too.
TEST(BinEvidence, NamesNoneWhereAllSensorsAreOff) {
  EXPECT_EQ(odd_one_out(predictions({1.2, 0.8, 1.1, 0.9})), std::nullopt);
}

}  // namespace
}  // namespace modcal::bin_evidence_test
