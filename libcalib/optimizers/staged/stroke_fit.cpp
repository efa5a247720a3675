#include "libcalib/optimizers/staged/stroke_fit.hpp"

#include <fmt/format.h>

#include <utility>

#include "libcalib/likelihood/bin_weights.hpp"
#include "libcalib/likelihood/tuning.hpp"

namespace modcal {

void set_prior(QuadraticPrior prior, NewtonOptions& options) {
  options.prior = std::move(prior.precision);
  options.prior_mean = std::move(prior.mean);
}

ProjectedLikelihood StrokeFit::damped(double sigma) const {
  poll();
  if (!input_.moving) {
    return ProjectedLikelihood(WhitenedRecord::of(input_.records, sigma * unit_, input_.highest));
  }
  NoisyRecords first = input_.records;
  first.signals.clear();
  const double samples = 8.0 / (sigma * unit_) * first.sample_rate;
  for (std::vector<double>& reaction : first.reactions) {
    if (samples < static_cast<double>(reaction.size())) {
      reaction.resize(static_cast<std::size_t>(samples));
    }
  }
  return ProjectedLikelihood(WhitenedRecord::of(first, 0.0, input_.highest));
}

std::string StrokeFit::damped_name(std::string_view unknowns, double sigma) const {
  if (input_.moving) return fmt::format("{}, first {:.3g} s", unknowns, 8.0 / (sigma * unit_));
  return fmt::format("{}, sigma = {:.3g} 1/s", unknowns, sigma * unit_);
}

const ProjectedLikelihood& StrokeFit::whole() {
  if (whole_) return *whole_;
  poll();
  whole_.emplace(WhitenedRecord::of(input_.records, 0.0, input_.highest));
  return *whole_;
}

UnknownBounds StrokeFit::bounds_of(const StringUnknowns& unknowns) const {
  ModelPoint initial = input_.initial;
  initial.sensors = input_.options.unknowns.sensors();
  return unknown_bounds(unknowns, initial, input_.options.ranges);
}

void StrokeFit::count() {
  if (input_.within) input_.within->spend(1);
  ++evaluations_;
}

bool StrokeFit::admits(const StringUnknowns& unknowns, const Eigen::VectorXd& theta) const {
  return unknowns.admits(theta) && bounds_of(unknowns).hold(theta);
}

NewtonFit StrokeFit::fit(const ProjectedLikelihood& likelihood, const StringUnknowns& unknowns,
                         const Eigen::VectorXd& theta, const NewtonOptions& options) {
  FitTarget target = fit_target(likelihood, unknowns);
  UnknownBounds bounds = bounds_of(unknowns);
  target.lower = std::move(bounds.lower);
  target.upper = std::move(bounds.upper);
  NewtonFit result = newton_fit(target, theta, options, input_.within);
  evaluations_ += result.evaluations;
  return result;
}

NewtonFit StrokeFit::fit_stage(std::string name, const ProjectedLikelihood& likelihood,
                               const StringUnknowns& unknowns, const Eigen::VectorXd& theta,
                               const NewtonOptions& options) {
  NewtonFit found = fit(likelihood, unknowns, theta, options);
  end_stage(std::move(name), likelihood, unknowns, found);
  return found;
}

void StrokeFit::end_stage(std::string name, const ProjectedLikelihood& likelihood,
                          const StringUnknowns& unknowns, const NewtonFit& found) {
  const auto free_count = static_cast<std::size_t>(unknowns.size() - unknowns.held_count());
  const ModelPoint model = unknowns.model(found.theta);
  const double freedom = likelihood.degrees_of_freedom(free_count, model);
  const double chi2 = 2.0 * found.point.cost / freedom;
  end_stage(std::move(name), found.objective, chi2);
  if (input_.options.reached) input_.options.reached(model, chi2);
}

void StrokeFit::end_stage(std::string name, double objective, double chi2) {
  stages_.push_back({std::move(name), evaluations_, objective, chi2});
}

double StrokeFit::cost(const ProjectedLikelihood& likelihood, const ModelPoint& point) {
  count();
  return likelihood.cost(point);
}

double StrokeFit::reduced_chi2(const StringUnknowns& unknowns, const Eigen::VectorXd& theta,
                               const LikelihoodPoint& point, const NewtonOptions& options) {
  count();
  const ModelPoint model = unknowns.model(theta);
  const LikelihoodPoint at = whole().evaluate(model, unknowns.columns(theta));
  return 2.0 * at.cost /
         (whole().degrees_of_freedom(0, model) - taken_by_fit(point, options, at.information));
}

Eigen::MatrixXd StrokeFit::prepare_weights(const StringUnknowns& unknowns,
                                           const Eigen::VectorXd& theta) {
  const ModelPoint point = unknowns.model(theta);
  weighted_ = whole();
  poll();
  weighted_->set_weights(information_weights(whole(), point, unknowns.columns(theta)));
  return noise_at(unknowns, theta);
}

Eigen::MatrixXd StrokeFit::noise_at(const StringUnknowns& unknowns,
                                    const Eigen::VectorXd& theta) const {
  poll();
  return weighted_->noise_information(unknowns.model(theta), unknowns.columns(theta),
                                      kNoiseRepeats);
}

LikelihoodPoint StrokeFit::weighted_point(const StringUnknowns& unknowns,
                                          const Eigen::VectorXd& theta) {
  count();
  return weighted_->evaluate(unknowns.model(theta), unknowns.columns(theta),
                             {.twice_weighted = true});
}

}  // namespace modcal
