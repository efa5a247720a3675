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

namespace {

StringMisfits string_misfits(const EndBins& bins, const StatedString& string) {
  StringMisfits misfits{};
  // Sums of logarithms as logarithms of products that stay in range.
  StringMisfits products{1.0, 1.0, 1.0, 1.0};
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const EndFactors factors = end_factors(bins.frequency[i], string);
    const auto stated = bins.misfits(i, factors.left, factors.right);
    const auto exchanged = bins.misfits(i, factors.right, factors.left);
    const StringMisfits factor = {stated[0], stated[1], exchanged[0], exchanged[1]};
    const bool whole = i % 32 == 31 || i + 1 == bins.size();
    for (std::size_t h = 0; h < misfits.size(); ++h) {
      products[h] *= factor[h];
      if (!whole) continue;
      misfits[h] += std::log(products[h]) / static_cast<double>(bins.size());
      products[h] = 1.0;
    }
  }
  return misfits;
}

}  // namespace

StringMisfits least_misfits(const EndBins& bins, const StringGrid& grid, StatedString& best) {
  const StatedString start = best;
  StringMisfits least;
  least.fill(std::numeric_limits<double>::infinity());
  const auto try_string = [&](int f, int x, int b) {
    StatedString string = start;
    string.fundamental *= 1.0 + grid.fundamental.size * f;
    string.contact += grid.contact.size * start.length * x;
    string.inharmonicity += grid.inharmonicity.size * b;
    if (!(string.contact > 0.0 && string.contact < start.length)) return;
    if (string.inharmonicity < 0.0) return;
    const StringMisfits misfits = string_misfits(bins, string);
    if (misfits[0] < least[0]) best = string;
    for (std::size_t h = 0; h < misfits.size(); ++h) least[h] = std::min(least[h], misfits[h]);
  };
  for (int f = -grid.fundamental.count; f <= grid.fundamental.count; ++f) {
    for (int x = -grid.contact.count; x <= grid.contact.count; ++x) {
      for (int b = -grid.inharmonicity.count; b <= grid.inharmonicity.count; ++b) {
        try_string(f, x, b);
      }
    }
  }
  return least;
}

}  // namespace modcal
