// What a fit of several records says of the string, of each record and of every mode.
#pragma once

#include "libcalib/identifiability/continuation_result.hpp"
#include "libcalib/identifiability/law_followers.hpp"
#include "libcalib/likelihood/all_records.hpp"

namespace modcal {

/// Where the fit of all records ended; all must outlive this.
struct JointEstimate {
  const AllRecords& all;
  const ModelPoint& initial;
  const ContinuationOptions& options;
  const StatedPriors& priors;
  const Eigen::VectorXd& theta;
  const Eigen::VectorXd& seen;  ///< of δ, under the wide prior; where frequencies are free
  const LawFollowers& followers;
};

/// Fills model, contacts, verdicts, values of the records and covariance of `fit`; of a law that is
/// fitted, its estimate too.
void report_joint_fit(const JointEstimate& estimate, const Eigen::MatrixXd& covariance,
                      ContinuationResult& fit);

/// What the causes that single strokes are suspected of may change in the fit of all: of what
/// records share the mean of their changes.
Eigen::MatrixXd covariance_of_causes(const std::vector<ContinuationResult>& single,
                                     const AllRecords& all);

}  // namespace modcal
