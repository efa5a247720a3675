#include "libcalib/identifiability/misfit_causes.hpp"

#include <cmath>
#include <numbers>

#include "libcalib/identifiability/fitted_record.hpp"
#include "libcalib/identifiability/tuning.hpp"

namespace modcal {
namespace {

// The first column of one cause, with what it makes of the modes, after those of another.
void join(MisfitCause one, MisfitCause& all) {
  const Eigen::Index count = std::ssize(all.columns), before = all.modes.cols();
  all.columns.push_back(std::move(one.columns.front()));
  all.modes.conservativeResize(Eigen::NoChange, count + 1);
  all.modes.rightCols(count + 1 - before).setZero();
  all.modes.col(count) = one.modes.col(0);
  all.widths.conservativeResize(count + 1);
  all.widths[count] = one.widths[0];
}

}  // namespace

std::vector<MisfitCause> misfit_causes(const ProjectedLikelihood& likelihood,
                                       const ModelPoint& point) {
  const FittedRecord fitted(likelihood, point);
  std::vector<MisfitCause> causes;
  for (const double detuning : {1e-3, -1e-3, 3e-3, -3e-3, 1e-2, -1e-2}) {
    causes.push_back(fitted.polarization(detuning));
  }
  causes.push_back(fitted.drift());
  causes.push_back(fitted.nonlinear_sensors());
  causes.push_back(fitted.modes_above());
  causes.push_back(fitted.moving_contact());
  const double fundamental = point.basis.omega[0] / (2.0 * std::numbers::pi);
  double place = 0.5;
  while (place < kHighestBody) {
    causes.push_back(fitted.bridge(place * fundamental, kBodyDamping));
    place *= kBodyStep;
  }
  return causes;
}

std::array<double, 2> places_beside(double place) {
  const double quarter = std::pow(kBodyStep, 0.25);
  return {place / quarter, place * quarter};
}

std::vector<MisfitCause> bridges_at(const ProjectedLikelihood& likelihood, const ModelPoint& point,
                                    std::span<const double> places) {
  const FittedRecord fitted(likelihood, point);
  std::vector<MisfitCause> causes;
  for (const double place : places) {
    MisfitCause cause = fitted.bridge(place, kBodyDamping);
    for (const double near : places_beside(place)) join(fitted.bridge(near, kBodyDamping), cause);
    causes.push_back(std::move(cause));
  }
  return causes;
}

std::vector<MisfitCause> resonances_about(const ProjectedLikelihood& likelihood,
                                          const ModelPoint& point, double place) {
  const FittedRecord fitted(likelihood, point);
  std::vector<MisfitCause> causes;
  for (int quarter = -3; quarter <= 3; ++quarter) {
    const double near = place * std::pow(kBodyStep, 0.25 * quarter);
    if (quarter != 0) causes.push_back(fitted.bridge(near, kBodyDamping));
    for (const bool right : {false, true}) {
      causes.push_back(fitted.resonance(right, near, kBodyDamping));
    }
  }
  return causes;
}

}  // namespace modcal
