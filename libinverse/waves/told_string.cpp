// What a record tells of its string where nothing is stated.
#include <algorithm>
#include <cmath>
#include <vector>

#include "libinverse/waves/end_search.hpp"
#include "libinverse/waves/tuning.hpp"
#include "libsim/base/error.hpp"
#include "libsim/signal/fft.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

// Σ_j x_j x_{j+τ}/(K − τ) of both reactions, each in units of its power, for τ up to K/3.
std::vector<double> common_autocorrelation(const EndRecord& record) {
  const std::size_t length = record.left.size();
  std::vector<double> sum(length / 3);
  const RealFft fft(2 * length);
  for (const std::span<const double> reaction : {record.left, record.right}) {
    std::vector<double> padded(reaction.begin(), reaction.end());
    remove_mean(padded);
    padded.resize(2 * length);
    std::vector<Complex> spectrum = fft.forward(padded);
    for (Complex& value : spectrum) value = std::norm(value);
    const std::vector<double> products = fft.inverse(std::move(spectrum));
    for (std::size_t lag = 0; lag < sum.size(); ++lag) {
      const double share = static_cast<double>(length) / static_cast<double>(length - lag);
      sum[lag] += 0.5 * share * products[lag] / products[0];
    }
  }
  return sum;
}

// The first lag at which both reactions are nearly as they were, in seconds.
double period_of(const EndRecord& record) {
  const std::vector<double> alike = common_autocorrelation(record);
  const auto falls = std::find_if(alike.begin(), alike.end(), [](double r) { return r < 0.0; });
  MODCAL_REQUIRE(falls != alike.end(),
                 "the reactions have no period: the record holds no note of a string");
  const double most = *std::max_element(falls, alike.end());
  MODCAL_REQUIRE(
      most > kLeastAlike,
      "no two parts of the reactions are alike (autocorrelation {:.2g}, at least {:g} is "
      "asked): the record holds no note of a string",
      most, kLeastAlike);
  auto lag = static_cast<std::size_t>(falls - alike.begin()) + 1;
  while (lag + 1 < alike.size() && !(alike[lag] >= kAsAlike * most &&
                                     alike[lag] >= alike[lag - 1] && alike[lag] > alike[lag + 1])) {
    ++lag;
  }
  return static_cast<double>(lag) / record.sample_rate;
}

// At mode n a step of x_c, of f₀ and of B turns kL by 0.3 at most, a tenth of the way to another
// minimum; halved until all three are as good as the relation is asked to hold.
double refine(const EndSpectra& spectra, double top, StringGrid grid, StatedString& string) {
  const EndBins bins = bins_of(spectra, string.fundamental, top);
  double misfit = std::numeric_limits<double>::infinity();
  if (bins.size() == 0) return misfit;
  for (int round = 0; round <= kRefinements; ++round) {
    misfit = least_misfits(bins, grid, string)[0];
    grid = grid.halved();
  }
  return misfit;
}

StringGrid grid_of(double top, int steps_of_inharmonicity) {
  return {.fundamental = {0.1 / top, 2},
          .contact = {0.1 / top, 2},
          .inharmonicity = {0.2 / (top * top * top), steps_of_inharmonicity}};
}

// The best of all contacts and of all f₀ between two.
StatedString scanned(const EndSpectra& spectra, double lowest, double highest) {
  StatedString best{.length = 1.0};
  double least = std::numeric_limits<double>::infinity();
  const double step = 0.1 / kScanBand;
  for (double f = lowest; f <= highest; f *= 1.0 + step) {
    const EndBins bins = bins_of(spectra, f, kScanBand);
    if (bins.size() < kLeastBins) continue;
    for (double contact = 0.5 * step; contact < 1.0; contact += step) {
      StatedString string{.length = 1.0, .fundamental = f, .contact = contact};
      const double misfit = least_misfits(bins, {}, string)[0];
      if (!(misfit < least)) continue;
      least = misfit;
      best = string;
    }
  }
  return best;
}

ToldString told_by(const EndRecord& record, const EndSpectra& spectra, StatedString string) {
  if (!(string.fundamental > 0.0)) return {};
  for (const double top : {kScanBand, 2.0 * kScanBand}) {
    refine(spectra, top, grid_of(top, 0), string);
  }
  refine(spectra, kStiffBand, grid_of(kStiffBand, kStiffSteps), string);
  const double misfit = refine(spectra, 2.0 * kStiffBand, grid_of(2.0 * kStiffBand, 4), string);
  const EndRelationFit fit = fit_end_relations(record, string);
  return {
      .fundamental = string.fundamental,
      .inharmonicity = string.inharmonicity,
      .contact = string.contact,
      .misfit = misfit,
      .explained = misfit < kToldMisfit && fit.best() == EndRelation::kString && fit.explained()};
}

}  // namespace

ToldString find_string(const EndRecord& record) {
  MODCAL_REQUIRE(record.left.size() == record.right.size() && record.left.size() >= 64,
                 "the reactions have {} and {} samples: one record has as many of both, and 64 at "
                 "least",
                 record.left.size(), record.right.size());
  const EndSpectra spectra(record);
  const double pitch = 1.0 / period_of(record);
  ToldString told = told_by(record, spectra, scanned(spectra, 0.96 * pitch, 1.04 * pitch));
  if (told.explained) return told;
  // A string that slips out of step repeats itself after some periods, or nearly.
  return told_by(record, spectra, scanned(spectra, 0.7 * pitch, 8.0 * pitch));
}

}  // namespace modcal
