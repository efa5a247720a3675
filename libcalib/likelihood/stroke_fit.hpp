// Fits of one stroke: on damped records, on the whole one, and on the whole one with weights.
#pragma once

#include <optional>

#include "libcalib/likelihood/continuation_attempt.hpp"
#include "libcalib/likelihood/newton_fit.hpp"

namespace modcal {

/// The likelihoods of a stroke's record and how often they were evaluated.
class StrokeFit {
 public:
  /// input must outlive this; evaluations: those spent before.
  StrokeFit(const AttemptInput& input, std::size_t evaluations)
      : input_(input), evaluations_(evaluations) {}

  std::size_t evaluations() const { return evaluations_; }
  /// Called by all that takes the time of an evaluation.
  void poll() const {
    if (input_.poll) input_.poll();
  }
  /// σ [1/s] of a string of 196 Hz, in proportion to f_0 on others.
  void scale_damping(double fundamental) { unit_ = fundamental / 196.0; }
  ProjectedLikelihood damped(double sigma) const;
  /// σ = 0, the end state projected out; made once.
  const ProjectedLikelihood& whole();
  /// The same with the weights prepared last.
  const ProjectedLikelihood& weighted() const { return *weighted_; }

  NewtonFit fit(const ProjectedLikelihood& likelihood, const StringUnknowns& unknowns,
                const Eigen::VectorXd& theta, const NewtonOptions& options);
  double cost(const ProjectedLikelihood& likelihood, const ModelPoint& point);
  /// Reduced χ² of the whole record; taken: residuals that the fit took.
  double reduced_chi2(const ModelPoint& point, double taken);

  /// Weights of the bins and N̄ under them, at θ.
  Eigen::MatrixXd prepare_weights(const StringUnknowns& unknowns, const Eigen::VectorXd& theta);
  Eigen::MatrixXd noise_at(const StringUnknowns& unknowns, const Eigen::VectorXd& theta) const;
  /// The weighted record at θ, with what its covariance takes.
  LikelihoodPoint weighted_point(const StringUnknowns& unknowns, const Eigen::VectorXd& theta);
  Eigen::MatrixXd covariance_at(const StringUnknowns& unknowns, const Eigen::VectorXd& theta,
                                const NewtonOptions& options);

 private:
  const AttemptInput& input_;
  std::optional<ProjectedLikelihood> whole_, weighted_;
  double unit_ = 1.0;
  std::size_t evaluations_;
};

/// Takes the place of the prior among the options.
void set_prior(QuadraticPrior prior, NewtonOptions& options);

}  // namespace modcal
