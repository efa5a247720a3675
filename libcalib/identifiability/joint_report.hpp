// What a fit of one record or several says of the string, of each record and of every mode.
#pragma once

#include <optional>
#include <span>
#include <vector>

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

/// Where the fit of one record ended; all must outlive this.
struct RecordFit {
  const StringUnknowns& unknowns;
  const Eigen::VectorXd& theta;
  const ModelPoint& model;            ///< at θ
  double damping;                     ///< factor of the ratios at `model`
  const Eigen::MatrixXd& covariance;  ///< of θ
};

/// Fills what record r, the strokes first, has of its own: contact, sensors and damping; of the
/// first also what all share of these, and the posterior.
void report_record(const RecordFit& record, std::size_t r, bool stroke, ContinuationResult& fit);

/// The law at θ of the first record; without χ² and what is stated.
LawEstimate law_estimate(const RecordFit& record);

/// What unknown amplitudes of causes may change, Σ suspicion · (change)(change)ᵀ: a cause that
/// moves an unknown by several deviations before it is named is not told apart from them, and the
/// covariance of the unknowns holds it. What the causes that single strokes are suspected of may
/// change in the fit of all: of what records share the mean of their changes.
Eigen::MatrixXd covariance_of_causes(std::span<const ContinuationResult> single,
                                     const AllRecords& all);

/// How much higher a stroke is tuned than the first.
struct TuningDifference {
  std::size_t stroke = 0;  ///< from 0
  double relative = 0.0;   ///< mean of ln f_n/f_n(first) over the modes that both identify
  double deviation = 0.0;  ///< of it
};

/// The farthest apart in deviations of strokes that were fitted by themselves, where it is by more
/// than chance, 3 of its deviations; each mode counts by what the data tell of it in both.
std::optional<TuningDifference> tuned_apart(const std::vector<ContinuationResult>& single);

}  // namespace modcal
