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
    misfit = least_misfit(bins, grid, string);
    grid = grid.halved();
  }
  return misfit;
}

StringGrid grid_of(double top, int steps_of_inharmonicity) {
  return {.fundamental = {0.1 / top, 2},
          .contact = {0.1 / top, 2},
          .inharmonicity = {0.2 / (top * top * top), steps_of_inharmonicity}};
}

struct Candidate {
  StatedString string;
  double misfit = std::numeric_limits<double>::infinity();
};

// Keeps the strings of least misfit, that first.
void keep_best(std::size_t count, std::vector<Candidate>& candidates) {
  std::ranges::sort(candidates, {}, &Candidate::misfit);
  if (candidates.size() > count) candidates.resize(count);
}

// By the modes up to `top` f₀, the best string between two f₀ of every contact at which it is
// better than beside it.
std::vector<Candidate> scanned(const EndSpectra& spectra, double top, double lowest,
                               double highest) {
  const double step = 0.1 / top;
  std::vector<Candidate> of_contact(static_cast<std::size_t>(std::ceil(1.0 / step)));
  std::vector<StringMisfits> sums(of_contact.size());
  double f = lowest;
  while (f <= highest) {
    const EndBins bins = bins_of(spectra, f, top);
    if (bins.size() >= kLeastBins) {
      sum_misfits(powers_of(bins), {.fundamental = f, .contact = 0.5 * step, .step = step}, true,
                  sums);
      for (std::size_t i = 0; i < of_contact.size(); ++i) {
        const double contact = (static_cast<double>(i) + 0.5) * step;
        const double misfit = sums[i][0] / static_cast<double>(bins.size());
        if (misfit >= of_contact[i].misfit || contact >= 1.0) continue;
        of_contact[i] = {{.length = 1.0, .fundamental = f, .contact = contact}, misfit};
      }
    }
    f *= 1.0 + step;
  }
  std::vector<Candidate> best;
  for (std::size_t i = 0; i < of_contact.size(); ++i) {
    const double own = of_contact[i].misfit;
    const bool below = i == 0 || own < of_contact[i - 1].misfit;
    const bool above = i + 1 == of_contact.size() || own <= of_contact[i + 1].misfit;
    if (below && above && std::isfinite(own)) best.push_back(of_contact[i]);
  }
  return best;
}

// By more and more modes, among which B is told.
void refine_all(const EndSpectra& spectra, std::vector<Candidate>& candidates) {
  for (const double top : {2.0 * kScanBand, kStiffBand, 2.0 * kStiffBand}) {
    const int steps = top < kStiffBand ? 0 : top > kStiffBand ? 4 : kStiffSteps;
    for (auto& [string, misfit] : candidates) {
      misfit = refine(spectra, top, grid_of(top, steps), string);
    }
    keep_best(kCandidates, candidates);
  }
}

// Of contacts elsewhere the one that serves best, if nearly as well as the best of all.
std::optional<double> rival_of(const std::vector<Candidate>& candidates) {
  const Candidate& best = candidates.front();
  const auto is_elsewhere = [&best](const Candidate& other) {
    return std::abs(other.string.contact - best.string.contact) > kSameContact;
  };
  const auto found = std::ranges::find_if(candidates, is_elsewhere);
  if (found == candidates.end() || found->misfit - best.misfit > kContactTold) return std::nullopt;
  return found->string.contact;
}

// Near its modes a string moves both ends alike, wherever the contact is: few modes tell f₀, and
// more of them which contact of several.
ToldString told_by(const EndRecord& record, const EndSpectra& spectra, double lowest,
                   double highest, std::optional<double> stated) {
  std::vector<Candidate> candidates = scanned(spectra, kScanBand, lowest, highest);
  if (candidates.empty()) return {};
  keep_best(1, candidates);
  refine(spectra, kScanBand, grid_of(kScanBand, 0), candidates.front().string);
  const double fundamental = candidates.front().string.fundamental;
  candidates = scanned(spectra, 2.0 * kScanBand, 0.99 * fundamental, 1.01 * fundamental);
  if (candidates.empty()) return {};
  refine_all(spectra, candidates);
  Candidate best = candidates.front();
  if (!std::isfinite(best.misfit)) return {};
  std::optional<double> rival = rival_of(candidates);
  if (rival && stated) {
    candidates = {{.string = {.length = 1.0, .fundamental = fundamental, .contact = *stated}}};
    refine_all(spectra, candidates);
    if (std::abs(best.string.contact - *stated) > kSameContact) rival = best.string.contact;
    best = candidates.front();
    if (!std::isfinite(best.misfit)) return {};
  }
  const auto& [string, misfit] = best;
  const EndRelationFit fit = fit_end_relations(record, string);
  return {
      .fundamental = string.fundamental,
      .inharmonicity = string.inharmonicity,
      .contact = string.contact,
      .misfit = misfit,
      .explained = misfit < kToldMisfit && fit.best() == EndRelation::kString && fit.explained(),
      .rival = rival};
}

}  // namespace

ToldString find_string(const EndRecord& record, std::optional<double> contact) {
  MODCAL_REQUIRE(record.left.size() == record.right.size() && record.left.size() >= 64,
                 "the reactions have {} and {} samples: one record has as many of both, and 64 at "
                 "least",
                 record.left.size(), record.right.size());
  const EndSpectra spectra(record);
  const double pitch = 1.0 / period_of(record);
  ToldString told = told_by(record, spectra, 0.96 * pitch, 1.04 * pitch, contact);
  if (told.explained) return told;
  // A string that slips out of step repeats itself after some periods, or nearly.
  ToldString other = told_by(record, spectra, 0.7 * pitch, 8.0 * pitch, contact);
  other.near_pitch = false;
  return other.explained || !std::isfinite(told.misfit) ? other : told;
}

}  // namespace modcal
