#include "libinverse/waves/end_relation.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "libinverse/waves/end_residual.hpp"
#include "libinverse/waves/end_search.hpp"
#include "libinverse/waves/tuning.hpp"
#include "libsim/base/error.hpp"

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

// What makes R₂ as strong as the relation asks.
double gain_at(const EndBins& bins, const StatedString& string) {
  double left = 0.0, right = 0.0;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const EndFactors factors = end_factors(bins.frequency[i], string);
    left += factors.left * factors.left * bins.left[i];
    right += factors.right * factors.right * bins.right[i];
  }
  return right > 0.0 ? std::sqrt(left / right) : 0.0;
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

bool EndRelationFit::explained_at_edge() const { return at_edge && unexplained < kUnexplained; }

bool EndRelationFit::tells_fundamental() const {
  return misfit_as_stated - least_misfit > kFundamentalTold;
}

EndRelationFit fit_end_relations(const EndRecord& record, const StatedString& string) {
  require_record(record, string);
  EndBins bins = bins_of(EndSpectra(record), string.fundamental, kRelationTop);
  EndRelationFit fit;
  fit.peak_over_noise = bins.peak_over_noise;
  StatedString found = string;
  StringGrid grid{.fundamental = {kFundamentalStep, kFundamentalSteps},
                  .contact = {kContactStep, kContactSteps}};
  const StringMisfits coarse = least_misfits(bins, grid, found);
  std::copy(coarse.begin(), coarse.end(), fit.misfit.begin());
  fit.misfit.back() = copy_misfit(bins, fit.copy_gain);
  // The relations are compared on one grid; the string alone is found more closely.
  bins.error = kRefinedError;
  const StringGrid held{.contact = grid.contact};
  const auto refined = [&bins](StringGrid steps, StatedString& from) {
    double misfit = 0.0;
    for (int round = 0; round < kRefinements; ++round) {
      steps = steps.halved();
      misfit = least_misfit(bins, steps, from);
    }
    return misfit;
  };
  StatedString stated = string;
  least_misfit(bins, held, stated);
  fit.misfit_as_stated = refined(held, stated);
  fit.least_misfit = refined(grid, found);
  fit.fundamental = found.fundamental;
  fit.contact = found.contact;
  const double shift = std::abs(found.fundamental / string.fundamental - 1.0);
  fit.at_edge = shift > (kFundamentalSteps - 0.5) * kFundamentalStep;
  judge_residual(record, found, string.contact, fit);
  return fit;
}

std::optional<double> gain_of_right(const EndRecord& record, const StatedString& string) {
  require_record(record, string);
  const EndBins bins = bins_of(EndSpectra(record), string.fundamental, kRelationTop);
  const double gain = gain_at(bins, string);
  if (!(gain > 0.0)) return std::nullopt;
  std::vector<double> right(record.right.begin(), record.right.end());
  for (double& sample : right) sample *= gain;
  EndRecord mended = record;
  mended.right = right;
  mended.noise[1] *= gain;
  const EndRelationFit fit = fit_end_relations(mended, string);
  if (!fit.explained() || fit.best() != EndRelation::kString) return std::nullopt;
  StatedString found = string;
  found.fundamental = fit.fundamental;
  found.contact = fit.contact;
  return gain_at(bins, found);
}

}  // namespace modcal
