#include "libinverse/structure/contact_place.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libinverse/structure/bin_evidence.hpp"
#include "libinverse/structure/strikes/strike_weights.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

// P y of every sensor: what no force at the contact of the model explains.
Transfers unexplained(const StructureTable& table, const ContourSpectra& spectra,
                      const BinWeights& weights) {
  Transfers h = transfers_of(table, spectra), left = spectra.responses;
  for (std::size_t m = 0; m < spectra.count(); ++m) {
    Complex along;
    double told = 0.0;
    for (std::size_t k = 0; k < h.size(); ++k) {
      h[k][m] *= weights[k][m];
      left[k][m] *= weights[k][m];
      along += std::conj(h[k][m]) * left[k][m];
      told += std::norm(h[k][m]);
    }
    for (std::size_t k = 0; k < h.size(); ++k) left[k][m] -= h[k][m] * along / told;
  }
  return left;
}

double power_of(const Transfers& values) {
  double sum = 0.0;
  for (const std::vector<Complex>& one : values) {
    for (const Complex& x : one) sum += std::norm(x);
  }
  return sum;
}

// Σ of the correlations of neighbors up to the first that is none.
double correlation_length(const Transfers& values) {
  const std::size_t bins = values.front().size();
  const double power = power_of(values);
  double length = 1.0;
  for (std::size_t lag = 1; lag < bins; ++lag) {
    double sum = 0.0;
    for (const std::vector<Complex>& one : values) {
      for (std::size_t m = 0; m + lag < bins; ++m) sum += (std::conj(one[m]) * one[m + lag]).real();
    }
    if (sum <= 0.0) break;
    length += 2.0 * sum / power;
  }
  return length;
}

}  // namespace

std::vector<std::size_t> ContactPlaces::credible(double share) const {
  std::vector<std::size_t> order(probability.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, std::greater{}, [this](std::size_t i) { return probability[i]; });
  double held = 0.0;
  std::size_t count = 0;
  while (count < order.size() && held < share) held += probability[order[count++]];
  order.resize(count);
  return order;
}

ContactPlaces weigh_places(std::span<const StructureTable> tables, const StructureRecord& record,
                           double sigma) {
  MODCAL_REQUIRE(tables.size() >= 2, "{}: places are compared, state the tables of two and more",
                 tables.size());
  const std::size_t sensors = record.responses.size();
  MODCAL_REQUIRE(sensors >= 2,
                 "{}: one response is explained by a force at any place; record two sensors and "
                 "more",
                 sensors);
  double low = 0.0, high = std::numeric_limits<double>::infinity();
  for (const StructureTable& table : tables) {
    MODCAL_REQUIRE(
        table.model.sensors == tables.front().model.sensors && table.model.pairs() == sensors,
        "{} sensors of a table, {} of the record: all places need the same sensors",
        table.model.pairs(), sensors);
    low = std::max(low, table.low);
    high = std::min(high, table.high);
  }
  const auto spectra = ContourSpectra::of(record, sigma, low, high);
  // Their scale is not known.
  const BinWeights weights = weights_of(spectra, 1.0);
  std::vector<double> costs;
  ContactPlaces result;
  Transfers least;
  Transfers all = spectra.responses;
  for (std::size_t k = 0; k < sensors; ++k) {
    for (std::size_t m = 0; m < spectra.count(); ++m) all[k][m] *= weights[k][m];
  }
  for (const StructureTable& table : tables) {
    Transfers left = unexplained(table, spectra, weights);
    costs.push_back(power_of(left));
    result.left.push_back(std::sqrt(costs.back() / power_of(all)));
    if (costs.back() <= std::ranges::min(costs)) {
      result.best = costs.size() - 1;
      least = std::move(left);
    }
  }
  result.numbers = 2.0 * static_cast<double>(spectra.count() * (sensors - 1)) /
                   std::max(spectra.correlated(), correlation_length(least));
  double sum = 0.0;
  for (const double cost : costs) {
    result.probability.push_back(std::pow(costs[result.best] / cost, 0.5 * result.numbers));
    sum += result.probability.back();
  }
  for (double& probability : result.probability) probability /= sum;
  return result;
}

}  // namespace modcal
