#include "libinverse/structure/bin_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libinverse/structure/bin_forces.hpp"
#include "libinverse/structure/tuning.hpp"
#include "libsim/base/turn.hpp"

namespace modcal {
namespace {

double spacing_of(const ContourSpectra& spectra) { return spectra.grid.spacing / kTurn; }

// E|F|² by what F̂ has and its variance explains; never less than a tenth of what F̂ has.
std::vector<double> power_of_force(const ContourSpectra& spectra, const BinEvidence& evidence) {
  std::vector<double> found, own;
  for (std::size_t m = 0; m < spectra.count(); ++m) {
    const double told = std::max(evidence.told[m], 1e-300);
    // A bin that tells little has little weight in the mean.
    found.push_back(std::norm(evidence.score[m]) / told);
    own.push_back(told);
  }
  const double spacing = spacing_of(spectra);
  const std::vector<double> sum = smoothed(found, spacing, kReach);
  const std::vector<double> weight = smoothed(own, spacing, kReach);
  std::vector<double> result;
  for (std::size_t m = 0; m < spectra.count(); ++m) {
    result.push_back(std::max(sum[m] - 1.0, 0.1 * sum[m]) / weight[m]);
  }
  return result;
}

// Squares of what the best forces leave of the sensors about every bin, over what is expected
// without `more`, per degree of freedom; tells the same of each sensor.
std::vector<double> contradiction(const ContourSpectra& spectra, const Transfers& transfers,
                                  const std::vector<double>& more, BinVariances& variances) {
  const std::size_t sensors = transfers.size(), bins = spectra.count();
  std::vector<double> left(bins, 0.0), power(sensors, 0.0);
  variances.by_sensor.assign(sensors, 0.0);
  variances.left.assign(sensors, 0.0);
  for (std::size_t m = 0; m < bins; ++m) {
    const BinForces forces(spectra, transfers, variances, kNoSensor, m);
    const Complex force = forces.force();
    const double degrees = static_cast<double>(sensors - 1) - forces.others_taken();
    for (std::size_t k = 0; k < sensors; ++k) {
      const double rest = std::norm(forces.left(k, force));
      const double own = rest / variances.of[k][m] * more[m];
      power[k] += std::norm(spectra.responses[k][m]);
      variances.left[k] += rest;
      left[m] += own / degrees;
      variances.by_sensor[k] += own / static_cast<double>(bins);
    }
  }
  for (std::size_t k = 0; k < sensors; ++k) {
    variances.left[k] = std::sqrt(variances.left[k] / power[k]);
  }
  return left;
}

// E|δH|² of every sensor is a share of these.
std::vector<std::vector<double>> spread_of(const StructureTable& table,
                                           const ContourSpectra& spectra) {
  if (!table.measured.empty()) return table.measured.variances(spectra);
  std::vector<std::vector<double>> spread(table.model.pairs());
  for (std::size_t k = 0; k < spread.size(); ++k) {
    for (std::size_t m = 0; m < spectra.count(); ++m) {
      spread[k].push_back(modal_power(table.model, k, spectra.s(m)));
    }
  }
  return spread;
}

// What the sensors other than `k` leave of the forces that they tell.
double left_by_others(const ContourSpectra& spectra, const Transfers& transfers,
                      const BinVariances& variances, std::size_t k) {
  const std::size_t forces_told = 1 + variances.others.size();
  if (transfers.size() < forces_told + 2) return std::numeric_limits<double>::quiet_NaN();
  double sum = 0.0;
  for (std::size_t m = 0; m < spectra.count(); ++m) {
    const BinForces forces(spectra, transfers, variances, k, m);
    for (std::size_t j = 0; j < transfers.size(); ++j) {
      if (j != k) sum += std::norm(forces.left(j, forces.force())) / variances.of[j][m];
    }
  }
  return sum / static_cast<double>(spectra.count() * (transfers.size() - 1 - forces_told));
}

}  // namespace

Transfers transfers_of(const StructureTable& table, const ContourSpectra& spectra) {
  return table.measured.empty() ? transfers_of(table.model, spectra) : table.measured.at(spectra);
}

Transfers transfers_of(const ModalModel& model, const ContourSpectra& spectra) {
  SplitSpectra split;
  model.evaluate(spectra.grid, spectra.bins, split);
  Transfers result;
  for (std::size_t k = 0; k < model.pairs(); ++k) result.push_back(split.joined(k));
  return result;
}

BinEvidence evidence_of(const ContourSpectra& spectra, const Transfers& transfers,
                        const BinVariances& variances, std::size_t left_out) {
  BinEvidence result{std::vector<double>(spectra.count()), std::vector<Complex>(spectra.count())};
  if (!variances.others.empty()) {
    for (std::size_t m = 0; m < spectra.count(); ++m) {
      const BinForces forces(spectra, transfers, variances, left_out, m);
      result.told[m] = forces.told();
      result.score[m] = forces.score();
    }
    return result;
  }
  for (std::size_t k = 0; k < transfers.size(); ++k) {
    if (k == left_out) continue;
    for (std::size_t m = 0; m < spectra.count(); ++m) {
      const double weight = bin_weight(transfers, variances, k, m);
      result.told[m] += weight * std::norm(transfers[k][m]);
      result.score[m] += weight * std::conj(transfers[k][m]) * spectra.responses[k][m];
    }
  }
  return result;
}

std::vector<std::vector<double>> transfer_variances(const StructureTable& table,
                                                    const ContourSpectra& spectra) {
  std::vector<std::vector<double>> result = spread_of(table, spectra);
  for (std::size_t k = 0; k < result.size(); ++k) {
    const double scatter = table.measured.empty() ? table.scatters[k].modal : 1.0;
    for (double& x : result[k]) x *= scatter * scatter;
  }
  return result;
}

BinVariances variances_of(const StructureTable& table, const ContourSpectra& spectra,
                          const Transfers& transfers, std::vector<OtherForce> others) {
  const std::size_t sensors = transfers.size(), bins = spectra.count();
  BinVariances result{.of = spread_of(table, spectra), .others = std::move(others)};
  const double noise_power = spectra.noise_power();
  result.of_transfer = transfer_variances(table, spectra);
  // Relative weights at first; of the size that they have where others are of known powers.
  for (std::size_t m = 0; m < bins && !result.others.empty(); ++m) {
    double power_elsewhere = 1e-300;
    for (const OtherForce& other : result.others) power_elsewhere += other.power[m];
    for (std::vector<double>& of : result.of) of[m] *= power_elsewhere;
  }
  std::vector<double> more(bins, 1.0);
  for (int round = 0; round < 4; ++round) {
    const BinEvidence evidence = evidence_of(spectra, transfers, result, kNoSensor);
    // Once they are variances: at first they are relative weights alone.
    std::vector<double> power(bins);
    if (round == 0) {
      std::vector<double> squares;
      for (std::size_t m = 0; m < bins; ++m) {
        squares.push_back(std::norm(evidence.score[m] / std::max(evidence.told[m], 1e-300)));
      }
      power = smoothed(squares, spacing_of(spectra), kReach);
    } else {
      power = power_of_force(spectra, evidence);
    }
    for (std::size_t k = 0; k < sensors; ++k) {
      const double noise = table.scatters[k].noise;
      for (std::size_t m = 0; m < bins; ++m) {
        double model = power[m] * result.of_transfer[k][m];
        for (const OtherForce& other : result.others) {
          model += other.power[m] * other.of_transfer[k][m];
        }
        result.of[k][m] = more[m] * (model + noise * noise * noise_power) + 1e-300;
      }
    }
    if (sensors < 2 + result.others.size()) continue;
    const std::vector<double> left = contradiction(spectra, transfers, more, result);
    double mean = 0.0;
    for (const double x : left) mean += x / static_cast<double>(bins);
    result.misfit = mean;
    const std::vector<double> next = smoothed(left, spacing_of(spectra), kReach);
    for (std::size_t m = 0; m < bins; ++m) {
      const double factor = std::max(next[m], 0.05) / more[m];
      for (std::size_t k = 0; k < sensors; ++k) result.of[k][m] *= factor;
      more[m] *= factor;
    }
  }
  for (double& x : result.by_sensor) x = std::sqrt(x);
  return result;
}

std::vector<double> hidden_power(const BinEvidence& evidence, const ContourSpectra& spectra) {
  std::vector<double> power = smoothed(evidence.told, spacing_of(spectra), kReach);
  const double bins = std::max(1.0, 2.0 * kReach / spacing_of(spectra) / spectra.correlated());
  for (double& x : power) x = std::max(1.0 / (x * std::sqrt(bins)), 1e-300);
  return power;
}

std::vector<SensorPrediction> predictions_of(const ContourSpectra& spectra,
                                             const Transfers& transfers,
                                             const BinVariances& variances) {
  std::vector<SensorPrediction> result;
  if (transfers.size() < 2 + variances.others.size()) return result;
  for (std::size_t k = 0; k < transfers.size(); ++k) {
    double power = 0.0, inside = 0.0, off = 0.0;
    for (std::size_t m = 0; m < spectra.count(); ++m) {
      const BinForces others(spectra, transfers, variances, k, m);
      const Complex left = others.left(k, others.force());
      const double sd = std::sqrt(0.5 * (others.variance(k) + variances.of[k][m]));
      for (const double part : {left.real(), left.imag()}) {
        inside += std::abs(part) <= 1.959964 * sd ? 1.0 : 0.0;
      }
      off += std::norm(left);
      power += std::norm(spectra.responses[k][m]);
    }
    result.push_back({.error = std::sqrt(off / power),
                      .coverage = inside / (2.0 * static_cast<double>(spectra.count())),
                      .others = left_by_others(spectra, transfers, variances, k)});
  }
  return result;
}

double contradiction_of(std::span<const double> left, std::size_t forces) {
  double power = 0.0;
  for (const double x : left) power += x * x;
  return left.size() <= forces ? 0.0 : power / static_cast<double>(left.size() - forces);
}

std::optional<std::size_t> odd_one_out(std::span<const SensorPrediction> predicted) {
  const auto odd = std::ranges::min_element(predicted, {}, &SensorPrediction::others);
  if (odd == predicted.end() || !(odd->others < kAgreement)) return std::nullopt;
  return static_cast<std::size_t>(odd - predicted.begin());
}

std::optional<std::size_t> odd_of_many(const ContourSpectra& spectra, const Transfers& transfers,
                                       const BinVariances& variances) {
  const std::size_t forces = 1 + variances.others.size();
  if (transfers.size() < 3 + forces) return std::nullopt;
  if (!(contradiction_of(variances.left, forces) >= kContradiction * kContradiction))
    return std::nullopt;
  return odd_one_out(predictions_of(spectra, transfers, variances));
}

double power_told(const BinEvidence& evidence) {
  double sum = 0.0;
  for (std::size_t m = 0; m < evidence.told.size(); ++m) {
    sum += std::norm(evidence.score[m]) / evidence.told[m];
  }
  return sum / static_cast<double>(evidence.told.size());
}

}  // namespace modcal
