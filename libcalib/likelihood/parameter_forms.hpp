// Parameters that have names as linear forms of the unknowns of all records.
#pragma once

#include <string>
#include <vector>

#include "libcalib/likelihood/all_records.hpp"
#include "libcalib/parameters/named_covariance.hpp"

namespace modcal {

/// A parameter as a linear form of the unknowns of all records, in the unit of its name.
struct ParameterForm {
  std::string parameter;
  Eigen::VectorXd slope;
  double deviation(const Eigen::MatrixXd& covariance) const;
};

/// Where parameters are linear in the unknowns: each record's model and factor of its damping
/// ratios, strokes first, then plucks, which have no contact; f_0 [Hz] with the law.
struct FormPoint {
  std::vector<ModelPoint> models;
  std::vector<double> damping;
  double fundamental = 0.0;
  std::size_t strokes = 1;
};

/// Every parameter save the frequencies: f0, B, x_c, damping, those of further records,
/// damping_power, gain, delay, corner, zeta_n; nothing of what is held.
std::vector<ParameterForm> parameter_forms(const AllRecords& all, const FormPoint& at);

/// Covariance of these and, first, of every f_n [Hz] that is free; where every ζ_n is free, of them
/// in the place of their factor. covariance: of the unknowns of `all`.
NamedCovariance named_covariance(const AllRecords& all, const FormPoint& at,
                                 const Eigen::MatrixXd& covariance);

/// The same for one record, at θ of its unknowns; damping: factor of all ζ_n there.
NamedCovariance named_covariance(const StringUnknowns& unknowns, const Eigen::VectorXd& theta,
                                 double damping, const Eigen::MatrixXd& covariance);

}  // namespace modcal
