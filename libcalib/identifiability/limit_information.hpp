// What all records of a string tell of its unknowns, before any noise is drawn.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "libcalib/identifiability/expected_limit.hpp"
#include "libcalib/likelihood/all_records.hpp"
#include "libcalib/likelihood/parameter_forms.hpp"

namespace modcal {

/// The records of a LimitCase, whitened, at the truth. Unknowns are those of AllRecords: the ones
/// given, then what every further record has for itself. What is fixed has no covariance.
class LimitInformation {
 public:
  /// `question` must outlive this.
  explicit LimitInformation(const LimitCase& question);

  const LimitCase& question() const { return question_; }
  const StatedPriors& priors() const { return priors_; }
  /// Re J⊥ᴴJ⊥, summed over the records.
  Eigen::MatrixXd information(const StringUnknowns& unknowns) const;
  /// Precision of `priors`; scatter: of the frequencies about the law, or null.
  Eigen::MatrixXd prior(const StringUnknowns& unknowns, const StatedPriors& priors,
                        const LawScatter* scatter) const;
  /// (2 information + prior)⁻¹.
  Eigen::MatrixXd covariance(const StringUnknowns& unknowns, const Eigen::MatrixXd& information,
                             const Eigen::MatrixXd& prior) const;
  /// Covariance under the weights that a calibration would give the bins if it knew what each can
  /// tell, noise in the slopes counted.
  Eigen::MatrixXd attainable(const StringUnknowns& unknowns, const Eigen::MatrixXd& prior) const;
  /// Every parameter save the frequencies.
  std::vector<ParameterForm> forms(const StringUnknowns& unknowns) const;

 private:
  AllRecords placed(const StringUnknowns& unknowns) const;
  ModelPoint point_of(std::size_t record) const;
  template <typename Evaluate>
  LikelihoodPoint sum(const StringUnknowns& unknowns, const Evaluate& evaluate) const;

  const LimitCase& question_;
  StatedPriors priors_;
  std::vector<ProjectedLikelihood> strokes_;
  std::vector<std::shared_ptr<const RecordLikelihood>> records_;  // the strokes, then the plucks
};

}  // namespace modcal
