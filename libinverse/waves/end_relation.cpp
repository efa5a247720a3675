#include "libinverse/waves/end_relation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "libinverse/waves/end_residual.hpp"
#include "libinverse/waves/tuning.hpp"
#include "libsim/base/error.hpp"
#include "libsim/signal/fft.hpp"

namespace modcal {
namespace {

void require_record(const EndRecord& record, const StatedString& string) {
  MODCAL_REQUIRE(record.left.size() == record.right.size(),
                 "the reactions have {} and {} samples: one record has as many of both",
                 record.left.size(), record.right.size());
  MODCAL_REQUIRE(string.contact > 0.0 && string.contact < string.length,
                 "contact {:g} m is not inside the string of {:g} m", string.contact,
                 string.length);
  const double duration = static_cast<double>(record.left.size()) / record.sample_rate;
  MODCAL_REQUIRE(duration * string.fundamental >= 2.0,
                 "{} samples at {:g} Hz are {:.3g} s, less than two periods of the string of {:g} "
                 "Hz: its modes cannot be told apart; record for longer",
                 record.left.size(), record.sample_rate, duration, string.fundamental);
}

/// Powers of the Hann-windowed record at some bins, white noise of 1 N being 1 in each.
struct EndBins {
  std::vector<double> frequency;
  std::vector<double> left, right, product;  ///< |R₁|², |R₂|², Re R₁ R₂*
  std::array<double, 2> variance{};
  std::array<double, 2> peak_over_noise{};
  double error = kRelationError;  ///< of the relation, relative

  std::size_t size() const { return frequency.size(); }
  /// 1 + |e|²/v of e = a R₁ ∓ b R₂.
  std::array<double, 2> misfits(std::size_t i, double a, double b) const {
    const double power = a * a * left[i] + b * b * right[i];
    const double allowed = a * a * variance[0] + b * b * variance[1] + error * error * power;
    if (!(allowed > 0.0)) return {1.0, 1.0};
    const double cross = 2.0 * a * b * product[i];
    return {1.0 + std::max(power - cross, 0.0) / allowed,
            1.0 + std::max(power + cross, 0.0) / allowed};
  }
};

// Bins that stand above the noise: the others tell of no relation.
EndBins bins_of(const EndRecord& record, const StatedString& string) {
  const double width = record.sample_rate / static_cast<double>(record.left.size());
  const double top = std::min(kRelationTop * string.fundamental, 0.4 * record.sample_rate);
  const auto first = static_cast<std::size_t>(std::ceil(0.5 * string.fundamental / width));
  const auto last = static_cast<std::size_t>(std::floor(top / width));
  const std::vector<Complex> left = hann_spectrum(record.left);
  const std::vector<Complex> right = hann_spectrum(record.right);
  EndBins bins;
  bins.variance = {record.noise[0] * record.noise[0], record.noise[1] * record.noise[1]};
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

/// Mean of ln(1 + |e|²/v) over the bins of one string, as stated, with one sign turned, and both
/// again with the ends exchanged.
using StringMisfits = std::array<double, 4>;

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

/// Steps of f₀ and x_c about a string, so many to either side.
struct StringGrid {
  double fundamental, contact;  ///< f₀ [1], x_c/L [1]
  int fundamentals, contacts;
};

// The least misfits of the strings of the grid; `best` becomes the one that serves best as stated.
StringMisfits least_misfits(const EndBins& bins, const StringGrid& grid, StatedString& best) {
  const StatedString start = best;
  StringMisfits least;
  least.fill(std::numeric_limits<double>::infinity());
  for (int i = -grid.fundamentals; i <= grid.fundamentals; ++i) {
    for (int j = -grid.contacts; j <= grid.contacts; ++j) {
      StatedString string = start;
      string.fundamental *= 1.0 + grid.fundamental * i;
      string.contact += grid.contact * start.length * j;
      if (!(string.contact > 0.0 && string.contact < start.length)) continue;
      const StringMisfits misfits = string_misfits(bins, string);
      if (misfits[0] < least[0]) best = string;
      for (std::size_t h = 0; h < misfits.size(); ++h) least[h] = std::min(least[h], misfits[h]);
    }
  }
  return least;
}

// R₂ = g R₁, the same g in every bin.
double copy_misfit(const EndBins& bins, double& gain) {
  double product = 0.0, power = 0.0;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    product += bins.product[i];
    power += bins.left[i];
  }
  gain = power > 0.0 ? product / power : 0.0;
  double sum = 0.0;
  for (std::size_t i = 0; i < bins.size(); ++i) sum += std::log(bins.misfits(i, gain, 1.0)[0]);
  return sum / static_cast<double>(std::max<std::size_t>(1, bins.size()));
}

}  // namespace

EndRelation EndRelationFit::best() const {
  const auto least = std::min_element(misfit.begin(), misfit.end());
  const bool better = *least < 0.5 * misfit_of(EndRelation::kString);
  return better ? static_cast<EndRelation>(least - misfit.begin()) : EndRelation::kString;
}

bool EndRelationFit::noise_alone(std::size_t end) const {
  return !(peak_over_noise[end] > kNoiseAlone);
}

bool EndRelationFit::explained() const { return !at_edge && unexplained < kUnexplained; }

EndRelationFit fit_end_relations(const EndRecord& record, const StatedString& string) {
  require_record(record, string);
  EndBins bins = bins_of(record, string);
  EndRelationFit fit;
  fit.peak_over_noise = bins.peak_over_noise;
  StatedString found = string;
  StringGrid grid{kFundamentalStep, kContactStep, kFundamentalSteps, kContactSteps};
  const StringMisfits coarse = least_misfits(bins, grid, found);
  std::copy(coarse.begin(), coarse.end(), fit.misfit.begin());
  fit.misfit.back() = copy_misfit(bins, fit.copy_gain);
  // The relations are compared on one grid; the string alone is found more closely.
  bins.error = kRefinedError;
  for (int round = 0; round < kRefinements; ++round) {
    grid = {0.5 * grid.fundamental, 0.5 * grid.contact, 1, 1};
    least_misfits(bins, grid, found);
  }
  fit.fundamental = found.fundamental;
  fit.contact = found.contact;
  const double shift = std::abs(found.fundamental / string.fundamental - 1.0);
  fit.at_edge = shift > (kFundamentalSteps - 0.5) * kFundamentalStep;
  judge_residual(record, found, fit);
  return fit;
}

}  // namespace modcal
