// The string's states at both ends of a record, as unknowns beside the force.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "libinverse/joint/ringing_columns.hpp"
#include "libinverse/record.hpp"
#include "libsim/model/transfer.hpp"

namespace modcal {

/// A record cut out of a motion is its periodic continuation's response plus one free decay a mode,
/// q_n(t) = Re(c_n exp(λ_n t)), which makes up for what the wrap takes for the past: 2N real
/// unknowns shared by both reactions. Their sampled transforms are geometric sums with the
/// string's own poles, exact at any length of the record.
class TransientFit {
 public:
  TransientFit() = default;
  TransientFit(const ModalBasis& basis, double contact, const FrequencyGrid& grid,
               double sample_rate, bool bending, const SensorPair& sensors);

  struct Workspace {
    Eigen::MatrixXd normal;  ///< its lower triangle
    Eigen::VectorXd decays;  ///< Re c_1, Im c_1, … of the last fit, scaled
    PlanarVector delay;      ///< of a block of bins
    std::array<RingingFactors, 2> factors;
    AlignedVector columns;
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> products;

    Complex decay(std::size_t mode) const {
      const auto at = static_cast<Eigen::Index>(2 * mode);
      return {decays[at], decays[at + 1]};
    }
  };

  /// What is known of the record at bin k = 1 … : transfer functions, noise variances of a bin
  /// (0: side missing), prior variance of F_k.
  struct Setting {
    std::array<std::span<const Complex>, 2> transfer;
    std::array<double, 2> noise_variance;
    std::span<const double> prior;
    bool level_known = false;  ///< bin 0 holds the reactions', too
  };
  using Spectra = std::array<std::span<Complex>, 2>;

  /// Least squares with the covariance of noise and force over all bins but the static one, then
  /// takes the decays out of the spectra (Golub and Pereyra, 1973: the force is eliminated bin by
  /// bin).
  void subtract(const Setting& setting, Spectra spectra, Workspace& workspace) const;

  /// Mean over the bins 1 … `bins` − 1 of what free decays, without a force, leave of one
  /// reaction's spectrum over the noise variance: 1 where the string rings by itself. The poles are
  /// the record's own: a second decay exp((λ_n + ε) t) a mode is what λ_n being off makes of the
  /// first, and moves it (Gauss and Newton), as long as the misfit falls. What sensors add is taken
  /// out by decays of its own: a drift, and `lines` of the mains [Hz].
  double ringing_misfit(Setting setting, std::size_t side, std::span<const Complex> spectrum,
                        std::size_t bins, std::span<const double> lines,
                        Workspace& workspace) const;

  /// Adds the decays' own displacement, or velocity, at the contact to its spectrum, from bin
  /// `first` on.
  void add_motion(bool velocity, std::size_t first, std::span<Complex> spectrum,
                  const Workspace& workspace) const;

  /// What the errors of the decays do to the estimates in bin k: F_k errs by −κ_k times the error
  /// along the force, divided by its scale, and the motions by that times their transfer function,
  /// less the error of their own decay.
  struct Effect {
    std::span<const double> force;  ///< κ_k
    std::array<std::span<const Complex>, 2> motion =
        {};                     ///< receptance, mobility; empty: not asked
    double motion_scale = 1.0;  ///< that κ_k has
    /// Variances by signal: force, displacement, velocity; empty where not asked for.
    std::array<std::span<double>, 3> variance;
  };

  /// Variances of the estimates by the errors of the last fit to these spectra, from which nothing
  /// was subtracted. A played note has lines, which the smooth prior does not hold, so that the
  /// covariance is that of the jackknife, from what becomes of the decays c where the equations a_g
  /// of clusters of bins, with residuals e_g, are left out:
  ///
  ///     C = Σ_g Δ_g Δ_gᵀ,  Δ_g = (N − a_gᵀ a_g)⁻¹ a_gᵀ e_g
  ///
  /// (Bell and McCaffrey, 2002). A cluster is f_1 wide: near a zero of H_r a line of the force is
  /// told from a decay by the bins around it together. The variances are means over the record but
  /// for a fifteenth at either end: a decay is also what a blow of the force at t = 0 makes.
  void error_variances(const Setting& setting, Spectra spectra, const Effect& effect,
                       Workspace& workspace) const;

 private:
  enum Signal : std::size_t { kForce, kDisplacement, kVelocity };
  /// Both complex equations of a bin: what the two ends are multiplied by.
  struct Equations {
    std::array<Complex, 2> along, across;
  };
  Equations equations_at(const Setting& setting, std::size_t k) const;
  std::size_t fill_columns(const Setting& setting, std::size_t begin, std::size_t count,
                           const Spectra& spectra, Workspace& workspace) const;
  void multiply_columns(const Setting& setting, std::size_t first, std::size_t last,
                        const Spectra& spectra, Workspace& workspace) const;
  Eigen::MatrixXd moves_without_clusters(const Setting& setting, const Spectra& spectra,
                                         Workspace& workspace) const;
  void fill_effect(const Setting& setting, const Effect& effect, Signal signal,
                   std::ptrdiff_t first, Workspace& workspace) const;
  std::vector<RingingMode> moving(bool velocity) const;
  void add_rate(Complex rate);
  void add_sensors(std::span<const double> lines);
  TransientFit with_near_poles(double step) const;
  void move_poles(double step, const Workspace& workspace);
  double ringing_step(const Setting& setting, std::size_t side, std::span<const Complex> spectrum,
                      std::size_t bins, Workspace& workspace);
  template <typename Take>
  void add_up(std::span<const RingingMode> modes, std::size_t first, Take take) const;
  Complex reading(std::size_t side, std::size_t k) const;
  Complex delay_of(std::size_t k) const;

  FrequencyGrid grid_;
  double sample_rate_ = 0.0;
  SensorPair sensors_;
  std::vector<RingingMode> modes_;  ///< by their g_rn, scaled to at most 1
  std::vector<Complex> rates_;      ///< λ_n [1/s]
  std::vector<double> contact_;     ///< φ_n(x_c), scaled so
};

}  // namespace modcal
