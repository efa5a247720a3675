#include "libcalib/identifiability/local_misfit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace modcal {
namespace {

using std::numbers::pi;

void add(double power, MisfitBand& band) {
  band.chi2 += power;
  ++band.bins;
}

void finish(std::vector<MisfitBand>& bands) {
  for (MisfitBand& band : bands) band.chi2 /= static_cast<double>(band.bins);
}

}  // namespace

double MisfitBand::deviation() const { return 1.0 / std::sqrt(static_cast<double>(bins)); }

LocalMisfit local_misfit(const ProjectedLikelihood& likelihood, const ModelPoint& point) {
  std::vector<double> residuals;
  likelihood.evaluate(point, {}, {.residuals = &residuals});
  const WhitenedRecord& record = likelihood.record();
  LocalMisfit misfit;
  for (std::size_t n = 0; n < point.basis.size(); ++n) {
    misfit.modes.push_back({.frequency = point.basis.frequency(n)});
  }
  const double width = std::max(0.25 * point.basis.frequency(0), 8.0 * record.spacing / (2.0 * pi));
  std::size_t mode = 0;
  for (std::size_t k = 0; k < record.bins; ++k) {
    const double power =
        residuals[2 * k] * residuals[2 * k] + residuals[2 * k + 1] * residuals[2 * k + 1];
    const double frequency = record.omega[k] / (2.0 * pi);
    const auto distance = [&](std::size_t n) {
      return std::abs(misfit.modes[n].frequency - frequency);
    };
    while (mode + 1 < misfit.modes.size() && distance(mode + 1) < distance(mode)) ++mode;
    add(power, misfit.modes[mode]);
    const auto band = static_cast<std::size_t>(frequency / width);
    while (misfit.bands.size() <= band) {
      misfit.bands.push_back({.frequency = (misfit.bands.size() + 0.5) * width});
    }
    add(power, misfit.bands[band]);
  }
  finish(misfit.modes);
  finish(misfit.bands);
  // What the last one holds of the band tells nothing.
  if (misfit.bands.back().bins < 8) misfit.bands.pop_back();
  return misfit;
}

}  // namespace modcal
