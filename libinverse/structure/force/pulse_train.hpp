// A force of pulses at the instants of a grid.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "libinverse/structure/bin_evidence.hpp"

namespace modcal {

/// F(s) = G(ω) Σ_j p_j exp(−s t_j), t_j from 0 to the window's end a third of the band's shortest
/// period apart, but not below half a sample: exact on a contour for a force that ends in the
/// window. G is the pulse of the table.
class PulseTrain {
 public:
  /// How many instants a window [s] of a record holds.
  static double instants_in(const StructureTable& table, double sample_rate, double window);

  /// Both must outlive this. Throws InvalidInput for a window of no or more than kMostInstants.
  PulseTrain(const StructureTable& table, const ContourSpectra& spectra, double window);

  std::size_t count() const { return at_.size(); }
  /// Only these of the instants from now on.
  void keep(const std::vector<Eigen::Index>& chosen);
  /// A and b of the likelihood exp(bᵀp − pᵀAp/2) that the bins have.
  std::pair<Eigen::MatrixXd, Eigen::VectorXd> normal_of(const BinEvidence& evidence) const;
  /// F of the amplitudes at every bin.
  std::vector<Complex> spectrum(const Eigen::VectorXd& amplitudes) const;
  /// Samples of the force by amplitudes [samples × count].
  Eigen::MatrixXd columns(Eigen::Index samples) const;

 private:
  const StructureTable& table_;
  const ContourSpectra& spectra_;
  double step_ = 0.0;
  std::vector<Eigen::Index> at_;  // t_j in steps
};

}  // namespace modcal
