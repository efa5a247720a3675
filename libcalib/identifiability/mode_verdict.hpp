// Which modes the data identify, which come from the law, and why.
#pragma once

#include <Eigen/Core>

#include "libcalib/identifiability/continuation_result.hpp"
#include "libcalib/identifiability/law_followers.hpp"
#include "libcalib/identifiability/neighbor_test.hpp"

namespace modcal {

/// Modes with |φ_n| < 0.05 at every one of the contacts.
std::vector<bool> nodes(const ModalBasis& basis, const std::vector<double>& contacts);

/// A mode that nothing excites has the information of its noise, which scatters about N̄ with few
/// degrees of freedom: less than three times N̄ is no proof of a signal, and near a node, where a
/// signal would be a surprise, less than ten. Less than a hundred is none that the mode leaves the
/// law: the fit looks for the loudest noise about it, or for what a model that is off by 1e-5
/// leaves there. (Of 1100 modes in nodes three had 13 to 65 times N̄ off the law, all of them
/// wrong.) deviation: of δ under the wide prior.
ModeSight sight_of(const Eigen::VectorXd& delta, const Eigen::VectorXd& deviation,
                   const Eigen::MatrixXd& information, const Eigen::MatrixXd& noise,
                   const std::vector<bool>& node);

/// A mode in a node that is off the law without proof is not seen: it follows the law.
void deny_surprises(LawFollowers& followers, ModeSight& sight);

/// Modes above the band [rad/s] of a record that has modes above the stated ones: their lines are
/// not in it.
void leave_out_of_band(const ModelPoint& model, double highest, ModeSight& sight);

/// A mode that has a rival minimum is not seen: its error reaches there.
void doubt_rivals(const std::vector<Neighbor>& neighbors, ModeSight& sight);

/// Widths of the prior of every mode: `width`, and for modes whose standard deviation under the
/// wide prior is that prior's (more than 0.7 of it) no more than the width estimated.
Eigen::VectorXd prior_widths(const Eigen::VectorXd& seen, double width, double estimated);

/// A mode that leaves the law has the width kDeparted and is seen as far as its information says, a
/// doubtful one kWidePrior at least: tied to where it is not, it would push the others away. Those
/// beside a mode that leaves are as wide as what moved it may have moved them, too.
void release(const LawFollowers& followers, ModeSight& sight, Eigen::VectorXd& widths);

/// All modes by the law with the covariance of (ln f_0, B).
std::vector<ModeVerdict> law_verdicts(const ModelPoint& model, double inharmonicity,
                                      const Eigen::Matrix2d& covariance);

/// deviation: sd of ln f_n; seen: the same under the wide prior alone. The standard deviation of a
/// doubtful mode reaches from where the data have it to the law.
std::vector<ModeVerdict> free_verdicts(const ModelPoint& model, const Eigen::VectorXd& deviation,
                                       const Eigen::VectorXd& seen, const LawFollowers& followers);

/// Modes that leave the law or are doubtful, by index; none where fewer than two would be left to
/// find the law by.
std::vector<std::size_t> not_following(const std::vector<ModeVerdict>& modes);

/// Raises the variances of the frequencies to the deviations that the verdicts report.
void raise_to_verdicts(const std::vector<ModeVerdict>& modes, NamedCovariance& covariance);

/// Fills how far every mode is from n f_0 √(1 + Bn²). Where `tests` suspect a cause that moves
/// modes off the law, the deviation of a mode that does not follow it holds as much of the
/// departure: near its resonance there is one more pole, which no f_n of the string is.
void report_departures(std::span<const ScoreTest> tests, ContinuationResult& result);

/// Node where |φ_n(x_c)| < 0.1, antinode where |cos(nπx_c/L)| < 0.2 (both ends then react alike,
/// whatever ω_n is), else noise.
WeakReason weak_reason(const ModelPoint& model, std::size_t index);

/// What is stated of a mode's frequency speaks for it where the data do not, or where it is held.
/// deviation: of δ_n, the first numbers; empty where frequencies follow the law.
void trust_stated_frequencies(const StatedPriors& priors, const Eigen::VectorXd& deviation,
                              std::vector<ModeVerdict>& modes);

/// A frequency that is held or has a prior scatters about the law as those do that the data see.
void widen_stated(const StatedPriors& priors, double width, Eigen::VectorXd& widths);

}  // namespace modcal
