// The forces of one bin, of several contacts at once.
#pragma once

#include <Eigen/Core>

#include "libinverse/structure/bin_evidence.hpp"

namespace modcal {

/// 1/V_k, less of what H is off by (BinVariances::of_transfer).
double bin_weight(const Transfers& transfers, const BinVariances& variances, std::size_t k,
                  std::size_t m);

/// What the sensors tell of F, the others being Gaussian of their powers P_q, and of the others
/// where F is known: with A_q = h_q of every sensor, W = diag 1/V and G = Aᴴ W A + diag 1/P, told =
/// hᴴWh − hᴴWA G⁻¹ AᴴWh, score = hᴴWy − hᴴWA G⁻¹ AᴴWy, F_q = G⁻¹ AᴴW(y − hF). The arguments must
/// outlive it.
class BinForces {
 public:
  BinForces(const ContourSpectra& spectra, const Transfers& transfers,
            const BinVariances& variances, std::size_t left_out, std::size_t m);

  double told() const { return told_; }
  Complex score() const { return score_; }
  Complex force() const { return score_ / told_; }
  /// What F and the others leave of a sensor's response.
  Complex left(std::size_t k, Complex force) const;
  /// Variance of what they make of it.
  double variance(std::size_t k) const;
  /// Of the sensors' degrees of freedom what the others take: Σ_q 1 − (G⁻¹)_qq/P_q.
  double others_taken() const;

 private:
  Eigen::VectorXcd others_at(std::size_t k) const;

  const ContourSpectra& spectra_;
  const Transfers& transfers_;
  const BinVariances& variances_;
  std::size_t m_;
  double told_ = 0.0;
  Complex score_;
  Eigen::MatrixXcd covariance_;     // G⁻¹; empty: one force
  Eigen::VectorXcd given_, alone_;  // F_q = alone − given F
};

}  // namespace modcal
