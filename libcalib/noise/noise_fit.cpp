#include "libcalib/noise/noise_fit.hpp"

#include <gsl/gsl_cdf.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "libcalib/noise/tuning.hpp"
#include "libinverse/noise/noise_model.hpp"

namespace modcal {
namespace {

using std::numbers::pi;

// Whether a bin lies where a mode or a line has left little of its noise.
class Excluded {
 public:
  Excluded(const WhitenedRecord& record, const ModelPoint& point) {
    for (std::size_t n = 0; n < point.basis.size(); ++n) {
      const double omega = point.basis.omega[n];
      const double half = std::max(kBinsAround * record.spacing,
                                   kWidths * (point.basis.zeta[n] * omega + record.sigma));
      // Of the widest at most half of what lies between modes.
      const double spacing = point.basis.omega[0];
      add(omega, std::min(half, 0.25 * spacing));
    }
    for (const double line : record.lines) add(line, kBinsAround * record.spacing);
  }
  bool holds(double omega) const {
    return std::any_of(ranges_.begin(), ranges_.end(), [omega](const auto& range) {
      return omega > range.first && omega < range.second;
    });
  }

 private:
  void add(double center, double half) { ranges_.emplace_back(center - half, center + half); }
  std::vector<std::pair<double, double>> ranges_;
};

std::vector<NoiseRow> rows_of(const ProjectedLikelihood& likelihood, const ModelPoint& point,
                              double octaves) {
  const WhitenedRecord& record = likelihood.record();
  std::vector<double> residuals, gain;
  std::vector<Complex> force, left, right;
  likelihood.evaluate(
      point, {},
      {.residuals = &residuals, .force = &force, .gain = &gain, .left = &left, .right = &right});
  std::vector<double> power(record.bins + 1, 0.0);
  for (std::size_t k = 0; k < record.bins; ++k) {
    power[k + 1] = power[k] + std::norm(force[k]) * gain[k];
  }
  const Excluded excluded(record, point);
  const double top = record.omega[record.bins - 1];
  std::vector<NoiseRow> rows;
  for (std::size_t k = 0; k < record.bins; ++k) {
    const double below = -std::log2(record.omega[k] / top);
    if (below > octaves || excluded.holds(record.omega[k])) continue;
    NoiseRow& row = rows.emplace_back();
    row.octaves = below;
    row.power = std::pow(residuals[2 * k], 2) + std::pow(residuals[2 * k + 1], 2);
    const double per = 1.0 / record.noise_at(k).of_residual(left[k], right[k]);
    const double mixed = -2.0 * per * std::real(std::conj(left[k]) * right[k]);
    const std::size_t begin = k > kAround ? k - kAround : 0;
    const std::size_t end = std::min(k + kAround + 1, record.bins);
    const double excess = (power[end] - power[begin]) / static_cast<double>(end - begin) - 1.0;
    const double both = std::norm(left[k]) * std::norm(right[k]) * per / gain[k];
    row.by = {std::norm(right[k]) * per, std::norm(left[k]) * per, mixed,
              std::log1p(std::max(excess * both, 0.0) / kLittle)};
  }
  return rows;
}

// Mean |e|² where the signal is least: a wrong model leaves least there.
double quiet_power(std::vector<NoiseRow> rows) {
  const auto count = static_cast<long>(rows.size() / kQuiet);
  std::nth_element(rows.begin(), rows.begin() + count, rows.end(),
                   [](const NoiseRow& a, const NoiseRow& b) {
                     return a.by[NoiseRow::kNoise] < b.by[NoiseRow::kNoise];
                   });
  return std::accumulate(rows.begin(), rows.begin() + count, 0.0,
                         [](double sum, const NoiseRow& row) { return sum + row.power; }) /
         static_cast<double>(count);
}

// Probability that noise alone leaves as much more where there is more signal; 1 where it is less.
double probability(const NoiseModel::Excess& excess) {
  return excess.above > 0.0 ? gsl_cdf_chisq_Q(excess.statistic, excess.degrees) : 1.0;
}

// Probability that noise alone has so large a run among those of so many bins, at most 1.
double probability_of_run(double power, double bins) {
  constexpr auto kLength = static_cast<double>(kLump);
  return std::min(1.0, bins / kLength * gsl_cdf_gamma_Q(power, kLength, 1.0));
}

// The noise by the form of least BIC; nothing where more than noise is left.
std::optional<NoiseSpectrum> noise_alone(const NoiseModel& model, double bins, double top) {
  const std::size_t knots = model.knots();
  double least = std::numeric_limits<double>::infinity();
  NoiseForm best;
  Eigen::VectorXd levels = model.white(), best_factors;
  model.fit({1, 0}, levels);
  Eigen::VectorXd factors = levels;
  for (const NoiseForm& form :
       {NoiseForm{1, 0}, NoiseForm{1, 1}, NoiseForm{knots, 0}, NoiseForm{knots, knots}}) {
    if (form.coherence == 0) factors = levels;
    const double criterion = model.fit(form, factors) + std::log(bins) * form.parameters();
    if (!(criterion < least)) continue;
    least = criterion;
    best = form;
    best_factors = factors;
  }
  const bool alone = probability(model.excess(best, best_factors)) > kNoiseAlone &&
                     probability_of_run(model.largest_run(best_factors, kLump), bins) > kNoiseAlone;
  return alone ? std::optional(model.spectrum(best, best_factors, top)) : std::nullopt;
}

}  // namespace

NoiseFit fit_noise(const ProjectedLikelihood& likelihood, const ModelPoint& point) {
  const WhitenedRecord& record = likelihood.record();
  std::size_t octaves = 1;
  for (std::size_t bins = record.bins; bins >= 4 * kLeastBins; bins /= 2) ++octaves;
  std::vector<NoiseRow> rows = rows_of(likelihood, point, static_cast<double>(octaves));
  const double top = record.omega[record.bins - 1] / (2.0 * pi);
  const auto bins = static_cast<double>(rows.size());
  if (bins < kFewestBins) return {.misfit = true};
  // Finer knots are for noise with a hill that an octave does not show.
  for (const std::size_t per_octave : {std::size_t{1}, kFineKnots}) {
    const NoiseModel model(rows, {.count = per_octave * octaves + 1, .per_octave = per_octave});
    if (auto found = noise_alone(model, bins, top)) {
      return {.spectrum = std::move(*found), .error = 1.0 / std::sqrt(bins)};
    }
  }
  return {.misfit = true,
          .level = quiet_power(std::move(rows)),
          .error = std::sqrt(static_cast<double>(kQuiet) / bins)};
}

}  // namespace modcal
