#include "libinverse/waves/end_search.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libinverse/waves/tuning.hpp"

namespace modcal {

std::array<double, 2> EndBins::misfits(std::size_t i, double a, double b) const {
  const double power = a * a * left[i] + b * b * right[i];
  const double allowed = a * a * variance[0] + b * b * variance[1] + error * error * power;
  if (!(allowed > 0.0)) return {1.0, 1.0};
  const double cross = 2.0 * a * b * product[i];
  return {1.0 + std::max(power - cross, 0.0) / allowed,
          1.0 + std::max(power + cross, 0.0) / allowed};
}

EndSpectra::EndSpectra(const EndRecord& record)
    : sample_rate(record.sample_rate),
      width(record.sample_rate / static_cast<double>(record.left.size())),
      variance{record.noise[0] * record.noise[0], record.noise[1] * record.noise[1]},
      left(hann_spectrum(record.left)),
      right(hann_spectrum(record.right)) {}

EndBins bins_of(const EndSpectra& spectra, double fundamental, double top) {
  const auto& [sample_rate, width, variance, left, right] = spectra;
  const double highest = std::min(top * fundamental, 0.4 * sample_rate);
  const auto first = static_cast<std::size_t>(std::ceil(0.5 * fundamental / width));
  const auto last = static_cast<std::size_t>(std::floor(highest / width));
  EndBins bins;
  bins.error = kRelationError;
  bins.variance = variance;
  std::vector<std::size_t> above;
  for (std::size_t k = first; k <= last; ++k) {
    const double ratios[] = {std::norm(left[k]) / bins.variance[0],
                             std::norm(right[k]) / bins.variance[1]};
    for (std::size_t r = 0; r < 2; ++r) {
      bins.peak_over_noise[r] = std::max(bins.peak_over_noise[r], ratios[r]);
    }
    if (std::max(ratios[0], ratios[1]) > kNoiseAlone) above.push_back(k);
  }
  const std::size_t step = 1 + above.size() / kRelationBins;
  for (std::size_t i = 0; i < above.size(); i += step) {
    const std::size_t k = above[i];
    bins.frequency.push_back(static_cast<double>(k) * width);
    bins.left.push_back(std::norm(left[k]));
    bins.right.push_back(std::norm(right[k]));
    bins.product.push_back((left[k] * std::conj(right[k])).real());
  }
  return bins;
}

EndPowers powers_of(const EndBins& bins) {
  EndPowers powers;
  const double share = bins.error * bins.error;
  powers.frequency = padded(bins.frequency);
  powers.left = padded(bins.left);
  powers.right = padded(bins.right);
  powers.product = padded(bins.size(), 0.0, [&](std::size_t i) { return 2.0 * bins.product[i]; });
  powers.left_allowed = padded(
      bins.size(), 0.0, [&](std::size_t i) { return bins.variance[0] + share * bins.left[i]; });
  powers.right_allowed = padded(
      bins.size(), 0.0, [&](std::size_t i) { return bins.variance[1] + share * bins.right[i]; });
  return powers;
}

namespace {

// Calls take(string, misfits) for the strings of the grid.
template <typename Take>
void search(const EndBins& bins, const StringGrid& grid, const StatedString& start,
            bool string_alone, Take take) {
  const EndPowers powers = powers_of(bins);
  const int steps = grid.contact.count;
  std::vector<StringMisfits> sums(static_cast<std::size_t>(2 * steps + 1));
  for (int f = -grid.fundamental.count; f <= grid.fundamental.count; ++f) {
    for (int b = -grid.inharmonicity.count; b <= grid.inharmonicity.count; ++b) {
      StatedString string = start;
      string.fundamental *= 1.0 + grid.fundamental.size * f;
      string.inharmonicity += grid.inharmonicity.size * b;
      if (string.inharmonicity < 0.0) continue;
      sum_misfits(powers,
                  {.fundamental = string.fundamental,
                   .inharmonicity = string.inharmonicity,
                   .contact = start.contact / start.length - grid.contact.size * steps,
                   .step = grid.contact.size},
                  string_alone, sums);
      for (int x = -steps; x <= steps; ++x) {
        string.contact = start.contact + grid.contact.size * start.length * x;
        if (!(string.contact > 0.0 && string.contact < start.length)) continue;
        const int place = x + steps;
        StringMisfits& misfits = sums[static_cast<std::size_t>(place)];
        for (double& misfit : misfits) misfit /= static_cast<double>(bins.size());
        take(string, misfits);
      }
    }
  }
}

}  // namespace

StringMisfits least_misfits(const EndBins& bins, const StringGrid& grid, StatedString& best) {
  StringMisfits least;
  least.fill(std::numeric_limits<double>::infinity());
  search(bins, grid, StatedString(best), false,
         [&](const StatedString& string, const StringMisfits& misfits) {
           if (misfits[0] < least[0]) best = string;
           for (std::size_t h = 0; h < misfits.size(); ++h) {
             least[h] = std::min(least[h], misfits[h]);
           }
         });
  return least;
}

double least_misfit(const EndBins& bins, const StringGrid& grid, StatedString& best) {
  double least = std::numeric_limits<double>::infinity();
  search(bins, grid, StatedString(best), true,
         [&](const StatedString& string, const StringMisfits& misfits) {
           if (misfits[0] >= least) return;
           least = misfits[0];
           best = string;
         });
  return least;
}

}  // namespace modcal
