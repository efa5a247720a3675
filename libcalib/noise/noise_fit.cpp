#include "libcalib/noise/noise_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "libcalib/noise/noise_model.hpp"
#include "libcalib/noise/tuning.hpp"

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
                              std::size_t knots) {
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
    const double place = static_cast<double>(knots - 1) + std::log2(record.omega[k] / top);
    if (place < 0.0 || excluded.holds(record.omega[k])) continue;
    NoiseRow& row = rows.emplace_back();
    row.knot = std::min(static_cast<std::size_t>(place), knots - 2);
    row.next = place - static_cast<double>(row.knot);
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

// Under exp(−σt) neighboring bins are not independent: (Σw²)²/(K Σw⁴) of them are.
double independent_share(const WhitenedRecord& record) {
  if (record.sigma == 0.0) return 1.0;
  const double duration = 2.0 * pi / record.spacing;
  const double second = -std::expm1(-2.0 * record.sigma * duration) / (2.0 * record.sigma);
  const double fourth = -std::expm1(-4.0 * record.sigma * duration) / (4.0 * record.sigma);
  return second * second / (fourth * duration);
}

// Where the signal is least a wrong model leaves least: the third of the bins that have least of
// it.
std::vector<NoiseRow> least_signal(std::vector<NoiseRow> rows) {
  const std::size_t count = rows.size() / kQuiet;
  std::nth_element(rows.begin(), rows.begin() + static_cast<long>(count), rows.end(),
                   [](const NoiseRow& a, const NoiseRow& b) {
                     return a.by[NoiseRow::kNoise] < b.by[NoiseRow::kNoise];
                   });
  rows.resize(count);
  return rows;
}

}  // namespace

NoiseFit fit_noise(const ProjectedLikelihood& likelihood, const ModelPoint& point) {
  const WhitenedRecord& record = likelihood.record();
  std::size_t knots = 2;
  for (std::size_t bins = record.bins; bins >= 4 * kLeastBins; bins /= 2) ++knots;
  std::vector<NoiseRow> rows = rows_of(likelihood, point, knots);
  const double share = independent_share(record), top = record.omega[record.bins - 1] / (2.0 * pi);
  if (rows.size() < 8 * kLump) return {{{{top, {}}}}, true};
  const NoiseModel model(rows, knots);
  const double price = std::log(std::max(share * static_cast<double>(rows.size()), 2.0));
  double least = std::numeric_limits<double>::infinity();
  NoiseForm best;
  Eigen::VectorXd levels = model.white(), best_factors;
  model.fit({1, 0}, levels);
  Eigen::VectorXd factors = levels;
  for (const NoiseForm& form :
       {NoiseForm{1, 0}, NoiseForm{1, 1}, NoiseForm{knots, 0}, NoiseForm{knots, knots}}) {
    if (form.coherence == 0) factors = levels;
    const double criterion = share * model.fit(form, factors) + price * form.parameters();
    if (!(criterion < least)) continue;
    least = criterion;
    best = form;
    best_factors = factors;
  }
  if (model.probability_of_excess(best, best_factors, share) > kNoiseAlone &&
      model.probability_of_lump(best_factors, share) > kNoiseAlone) {
    return {model.spectrum(best, best_factors, top), false};
  }
  const NoiseModel quiet(least_signal(std::move(rows)), knots);
  quiet.fit({1, 0}, levels);
  return {quiet.spectrum({1, 0}, levels, top), true};
}

}  // namespace modcal
