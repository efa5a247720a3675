// Fits of one stroke: on damped records, on the whole one, and on the whole one with weights.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libcalib/likelihood/unknown_bounds.hpp"
#include "libcalib/optimizers/staged/continuation_attempt.hpp"
#include "libcalib/optimizers/staged/newton_fit.hpp"

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
    if (input_.within) input_.within->poll();
  }
  /// σ [1/s] of a string of 196 Hz, in proportion to f_0 on others.
  void scale_damping(double fundamental) { unit_ = fundamental / 196.0; }
  /// "law, sigma = 200 1/s"; of a record that begins in mid-stroke "law, first 0.04 s".
  std::string damped_name(std::string_view unknowns, double sigma) const;
  /// The record damped and cut to 8/σ; of one that begins in mid-stroke its first 8/σ as they are.
  ProjectedLikelihood damped(double sigma) const;
  /// σ = 0, the end state projected out; made once.
  const ProjectedLikelihood& whole();
  /// The noise levels have changed.
  void renew() { whole_.reset(); }
  /// The same with the weights prepared last.
  const ProjectedLikelihood& weighted() const { return *weighted_; }

  /// Whether the parameters may go there.
  bool admits(const StringUnknowns& unknowns, const Eigen::VectorXd& theta) const;

  NewtonFit fit(const ProjectedLikelihood& likelihood, const StringUnknowns& unknowns,
                const Eigen::VectorXd& theta, const NewtonOptions& options);
  /// The same as a stage of its own, on a record without weights.
  NewtonFit fit_stage(std::string name, const ProjectedLikelihood& likelihood,
                      const StringUnknowns& unknowns, const Eigen::VectorXd& theta,
                      const NewtonOptions& options);
  /// Ends a stage with this fit on a record without weights.
  void end_stage(std::string name, const ProjectedLikelihood& likelihood,
                 const StringUnknowns& unknowns, const NewtonFit& found);
  /// Ends a stage with weights; chi2: of the whole record, NaN where it was not asked for.
  void end_stage(std::string name, double objective, double chi2);
  const std::vector<FitStage>& stages() const { return stages_; }
  double cost(const ProjectedLikelihood& likelihood, const ModelPoint& point);
  /// Reduced χ² of the whole record at θ, where a fit with weights ended; point, options: its own.
  double reduced_chi2(const StringUnknowns& unknowns, const Eigen::VectorXd& theta,
                      const LikelihoodPoint& point, const NewtonOptions& options);

  /// Weights of the bins and N̄ under them, at θ.
  Eigen::MatrixXd prepare_weights(const StringUnknowns& unknowns, const Eigen::VectorXd& theta);
  Eigen::MatrixXd noise_at(const StringUnknowns& unknowns, const Eigen::VectorXd& theta) const;
  /// The weighted record at θ, with what its covariance takes.
  LikelihoodPoint weighted_point(const StringUnknowns& unknowns, const Eigen::VectorXd& theta);

 private:
  void count();
  UnknownBounds bounds_of(const StringUnknowns& unknowns) const;
  const AttemptInput& input_;
  std::optional<ProjectedLikelihood> whole_, weighted_;
  double unit_ = 1.0;
  std::size_t evaluations_;
  std::vector<FitStage> stages_;
};

/// Takes the place of the prior among the options.
void set_prior(QuadraticPrior prior, NewtonOptions& options);

}  // namespace modcal
