// Which modes the data identify, which come from the law, and why.
#pragma once

#include <Eigen/Core>

#include "libcalib/likelihood/continuation.hpp"

namespace modcal {

/// Width of the prior about the law that only keeps a mode from wandering [1].
inline constexpr double kWidePrior = 2e-3;
/// Width that ties a mode to the law where the string follows it [1].
inline constexpr double kTied = 1e-5;

/// τ by moments from the modes seen to 5e-4: their scatter δ about the law beyond their own
/// standard deviations; not below kTied.
double estimate_law_width(const Eigen::VectorXd& delta, const Eigen::VectorXd& seen,
                          double inharmonicity);

/// Modes with |φ_n| < 0.05 at every one of the contacts.
std::vector<bool> nodes(const ModalBasis& basis, const std::vector<double>& contacts);

/// A mode that nothing excites has the information of its noise, which scatters about N̄ with few
/// degrees of freedom: less than three times N̄ is no proof of a signal, and near a node, where a
/// signal would be a surprise, less than ten. Without proof `seen` is no less than kWidePrior.
void deny_noise(const Eigen::MatrixXd& information, const Eigen::MatrixXd& noise,
                const std::vector<bool>& node, Eigen::VectorXd& seen);

/// Widths of the prior of every mode: `width`, and for modes whose standard deviation under the
/// wide prior is that prior's (more than 0.7 of it) no more than the width estimated.
Eigen::VectorXd prior_widths(const Eigen::VectorXd& seen, double width, double estimated);

/// All modes by the law with the covariance of (ln f_0, B).
std::vector<ModeVerdict> law_verdicts(const ModelPoint& model, double inharmonicity,
                                      const Eigen::Matrix2d& covariance);

/// deviation: sd of ln f_n; seen: the same under the wide prior alone.
std::vector<ModeVerdict> free_verdicts(const ModelPoint& model, const Eigen::VectorXd& deviation,
                                       const Eigen::VectorXd& seen, double law_width);

/// Node where |φ_n(x_c)| < 0.1, antinode where |cos(nπx_c/L)| < 0.2 (both ends then react alike,
/// whatever ω_n is), else noise.
WeakReason weak_reason(const ModelPoint& model, std::size_t index);

}  // namespace modcal
