#include "libcalib/identifiability/misfit_causes.hpp"

#include <cmath>
#include <numbers>

#include "libcalib/identifiability/fitted_record.hpp"
#include "libcalib/identifiability/tuning.hpp"

namespace modcal {
namespace {

// The first column of one cause, with what it makes of the modes, before those of another.
void join(MisfitCause one, MisfitCause& all) {
  all.columns.insert(all.columns.begin(), std::move(one.columns.front()));
  Eigen::MatrixXcd modes(all.modes.rows(), all.modes.cols() + 1);
  modes << one.modes.col(0), all.modes;
  all.modes = std::move(modes);
  Eigen::VectorXd widths(all.widths.size() + 1);
  widths << one.widths[0], all.widths;
  all.widths = std::move(widths);
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
  const double fundamental = point.basis.omega[0] / (2.0 * std::numbers::pi);
  for (double place = 0.5; place < kHighestBody; place *= kBodyStep) {
    causes.push_back(fitted.bridge(place * fundamental, kBodyDamping));
  }
  return causes;
}

std::vector<MisfitCause> bridges_at(const ProjectedLikelihood& likelihood, const ModelPoint& point,
                                    std::span<const double> places, bool beside) {
  const FittedRecord fitted(likelihood, point);
  std::vector<MisfitCause> causes;
  for (const double place : places) {
    MisfitCause cause = fitted.bridge(place, kBodyDamping);
    for (const double side : {-0.125, 0.125}) {
      if (beside) join(fitted.bridge(place * std::pow(kBodyStep, side), kBodyDamping), cause);
    }
    causes.push_back(std::move(cause));
  }
  return causes;
}

std::vector<MisfitCause> resonances_about(const ProjectedLikelihood& likelihood,
                                          const ModelPoint& point, double place) {
  const FittedRecord fitted(likelihood, point);
  std::vector<MisfitCause> causes;
  for (int eighth = -7; eighth <= 7; ++eighth) {
    const double near = place * std::pow(kBodyStep, 0.125 * eighth);
    if (eighth != 0) causes.push_back(fitted.bridge(near, kBodyDamping));
    for (const bool right : {false, true}) {
      causes.push_back(fitted.resonance(right, near, kBodyDamping));
    }
  }
  return causes;
}

}  // namespace modcal
