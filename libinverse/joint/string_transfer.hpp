// Transfer functions of the string from the contact, with what modes alone leave out, and its
// states at both ends of a record, as unknowns beside the force.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "libinverse/record.hpp"
#include "libsim/model/transfer.hpp"

namespace modcal {

struct StringTransfer {
  std::vector<Complex> reaction[2];  ///< by End [N/N]
  std::vector<Complex> receptance;   ///< [m/N]
};

/// H_1, H_2 and the receptance at s_k of the grid; x_c in [0, L] [m]. Throws InvalidInput outside.
StringTransfer string_transfer(const ModalBasis& basis, double contact, const FrequencyGrid& grid,
                               const StringSupport& support, const SensorPair& sensors);

/// A record cut out of a motion is its periodic continuation's response plus one free decay a mode,
/// q_n(t) = Re(c_n exp(λ_n t)), which makes up for what the wrap takes for the past: 2N real
/// unknowns shared by both reactions. Their sampled transforms are geometric sums with the
/// string's own poles, exact at any length of the record.
class TransientFit {
 public:
  TransientFit() = default;
  TransientFit(const ModalBasis& basis, const FrequencyGrid& grid, double sample_rate, bool bending,
               const SensorPair& sensors);

  struct Workspace {
    Eigen::MatrixXd normal;
    Eigen::VectorXd right;
    Eigen::MatrixXd rows;
    Eigen::VectorXd data;
  };

  /// What is known of the record at bin k = 1 … : transfer functions, noise variances of a bin
  /// (0: side missing), prior variance of F_k.
  struct Setting {
    std::array<std::span<const Complex>, 2> transfer;
    std::array<double, 2> noise_variance;
    std::span<const double> prior;
  };

  /// Least squares with the covariance of noise and force, then takes the decays out of the
  /// spectra (Golub and Pereyra, 1973: the force is eliminated bin by bin).
  void subtract(const Setting& setting, std::array<std::span<Complex>, 2> spectra,
                Workspace& workspace) const;

 private:
  void fill_rows(const Setting& setting, std::size_t k,
                 const std::array<std::span<Complex>, 2>& spectra, Eigen::Index row,
                 Workspace& workspace) const;
  std::array<Complex, 2> decay_of(std::size_t n, Complex shift) const;
  Complex reading(std::size_t side, std::size_t k) const;

  FrequencyGrid grid_;
  double sample_rate_ = 0.0;
  SensorPair sensors_;
  std::vector<Complex> poles_;    ///< exp(λ_n/f_s)
  std::vector<double> gains_[2];  ///< g_rn, scaled to at most 1
};

}  // namespace modcal
