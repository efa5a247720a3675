// The unknowns of a likelihood fit: the law's, or every frequency apart.
#pragma once

#include <Eigen/Core>

#include "libcalib/likelihood/projected_likelihood.hpp"

namespace modcal {

/// θ = (ln f_0, B | δ_1 … δ_N, x_c, ln of one damping factor) about a reference model, all zero
/// there save B: with the law ω_n = 2πn f_0 √(1 + B n²), else ω_n = ω_n(reference) exp(δ_n).
class StringUnknowns {
 public:
  /// Law with f_0 [Hz] and B [1]; contact and damping of the reference.
  static StringUnknowns law(const ModelPoint& reference, double fundamental, double inharmonicity);
  static StringUnknowns frequencies(const ModelPoint& reference);
  StringUnknowns with_fixed_damping() const;

  bool is_law() const { return law_; }
  Eigen::Index size() const { return contact() + (damping_ ? 2 : 1); }
  Eigen::Index contact() const { return law_ ? 2 : static_cast<Eigen::Index>(modes()); }
  Eigen::Index damping() const { return contact() + 1; }
  bool damping_is_free() const { return damping_; }
  std::size_t modes() const { return reference_.basis.size(); }
  Eigen::VectorXd start() const;
  /// f_0 at θ, with the law [Hz].
  double fundamental(const Eigen::VectorXd& theta) const;
  /// False where the law, the contact or the damping leaves what a string can be.
  bool admits(const Eigen::VectorXd& theta) const;
  ModelPoint model(const Eigen::VectorXd& theta) const;
  LikelihoodColumns columns(const Eigen::VectorXd& theta) const;

 private:
  ModelPoint reference_;
  double fundamental_ = 0.0;
  double inharmonicity_ = 0.0;
  bool law_ = false;
  bool damping_ = true;
};

/// Precision of δ under δ_n = law's change + N(0, τ_n²), the law's change (ln f_0, B) unknown:
/// W − WL(LᵀWL)⁻¹LᵀW with W = diag(τ_n⁻²), L_n = (1, ½n²/(1 + B n²)).
Eigen::MatrixXd law_prior(const Eigen::VectorXd& widths, double inharmonicity);

}  // namespace modcal
