// Which modes follow the law of the string, how closely, and which leave it.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string_view>
#include <vector>

#include "libcalib/identifiability/tuning.hpp"

namespace modcal {

/// What the data tell of the frequencies under the wide prior alone.
struct ModeSight {
  Eigen::VectorXd delta;  ///< δ_n, relative to a model near the law
  Eigen::VectorXd seen;   ///< its standard deviation; no less than kWidePrior without proof
  Eigen::VectorXd error;  ///< the same, of modes without proof twice what their information says
  /// In a node, and not told well enough to be said to leave the law; empty: none.
  std::vector<bool> surprise = {};
};

enum class LawTie { kFollows, kDoubtful, kLeaves };
std::string_view name_of(LawTie tie);  ///< follows, doubtful, leaves

struct LawFollowers {
  double width = kWidePrior;  ///< τ, relative scatter about the law of the modes that follow it
  double prior_width = kWidePrior;  ///< the same, or what is known of it beforehand
  /// Root of the mean of τ² ≥ 0 given what the modes say of it: what a deviation of the law takes.
  double scatter = kWidePrior;
  std::vector<LawTie> ties;
  Eigen::VectorXd rest;  ///< δ_n beyond the law of those that follow it

  /// Widths of all modes about the law for the law's own sake.
  Eigen::VectorXd scatters() const;
  /// How far what makes some modes leave the law may have moved the others. An end on a mode of the
  /// body, f_b = c f_0 and m_b, yields: the string is longer by T/(4π² m_b (f_b² − f_n²)), so that
  /// beside a mode m with δ_m beyond the law, c nearer to m than to any other, no |δ_n| is above
  /// |δ_m| |c² − m²|/|c² − n²| at c = m ± ½. 0 for modes that leave.
  Eigen::VectorXd disturbances() const;
  static LawFollowers all(Eigen::Index modes, double width);
  void follow_all() { ties.assign(ties.size(), LawTie::kFollows); }
  std::size_t leaving() const;
};

/// The law (ln f_0, B) through the modes seen to 5e-4 that follow it, with τ by the moments of
/// their scatter beyond their own errors, between kTied and kWidePrior. Mode n is tested by
///
///     z_n = (δ_n − law)/√(error_n² + τ² + law's own variance),
///
/// doubtful beyond |z| = 3; it leaves where Student's t of that many followers less two, were all N
/// to follow, would have one such mode in one of 370 strings (0.27 %/N each). The first law is
/// robust: Huber's weights and τ by the median. width: τ known beforehand; NaN: estimated. Fewer
/// than eight modes seen: none is tested; fewer than four: τ = kWidePrior.
LawFollowers find_followers(const ModeSight& sight, double inharmonicity,
                            double width = std::numeric_limits<double>::quiet_NaN());

}  // namespace modcal
