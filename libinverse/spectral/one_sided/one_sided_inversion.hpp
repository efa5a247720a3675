// The contact force from the reaction at one end of the string.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "libinverse/spectral/choices/parameter_choice.hpp"
#include "libinverse/spectral/regularizers/regularizer.hpp"
#include "libsim/model/transfer.hpp"
#include "libsim/signal/fft.hpp"

namespace modcal {

/// What an inversion computes. Each of the three signals costs an inverse transform.
struct InversionOutputs {
  bool force = true;
  bool displacement = false;
  bool velocity = false;
  bool force_spectrum = false;
};

/// How to invert. The plug-ins must outlive the call.
struct InversionMethod {
  const Regularizer& regularizer;
  const ParameterChoice& choice;
  InversionOutputs outputs = {};
  /// Standard deviation of the noise of one sample [N], where a parameter choice asks for it.
  double noise_rms = std::numeric_limits<double>::quiet_NaN();
};

/// Identified motion at the contact; what was not asked for is empty.
struct InversionResult {
  ChosenParameter choice;            ///< norms are sample norms: ‖r‖² = Σ_j r_j² [N], [N/s]
  std::size_t bins = 0;              ///< bins of the record besides k = 0
  std::size_t blind_bins = 0;        ///< of these, bins with H = 0: F = 0 there, whatever the force
  std::vector<double> force;         ///< f_c(t_j) [N], K samples of zero mean
  std::vector<double> displacement;  ///< y(x_c, t_j) [m]
  std::vector<double> velocity;      ///< v(x_c, t_j) [m/s]
  std::vector<Complex>
      force_spectrum;  ///< F_k, K/2 + 1, in the convention of libsim/signal/fft.hpp
};

/// Arrays that a call needs besides its results, to be kept from call to call; one per thread.
struct InversionWorkspace {
  std::vector<Complex> force;
  std::vector<Complex> contact;
  std::vector<double> power;
  std::vector<double> factors;
};

/// Identification of force, displacement and velocity at the contact from one end's reaction:
/// F = φ R/H_r, Y = H_d F, V = iω H_d F (Debut, Delaune and Antunes, 2010, eqs. 10–13), φ the
/// regularizer's filter factors with |H_r| for singular values. Prepared once per model and record
/// length; const and safe to use from several threads.
///
/// The transform wraps: what rings on past the end of the record is taken for its beginning.
/// Bin 0: sensors give no static level, so the mean of the record is not used and F_0 = 0. Bin K/2
/// of an even length: sampled, it is the real cosine (−1)^j, of which only the real parts of the
/// transfer functions are seen; the bin is inverted with these.
class OneSidedInversion {
 public:
  /// `contact` x_c in [0, L] [m], `samples` ≥ 1, `sample_rate` > 0 [Hz]. Throws InvalidInput
  /// outside these ranges.
  OneSidedInversion(const ModalBasis& basis, double contact, End end, std::size_t samples,
                    double sample_rate);
  /// With transfer functions given as numbers: force to reaction [N/N] and force to displacement
  /// [m/N], each K/2 + 1 bins of FrequencyGrid::of_record(samples, sample_rate). Throws
  /// InvalidInput for other lengths and values that are not finite.
  OneSidedInversion(std::vector<Complex> reaction_transfer, std::vector<Complex> receptance,
                    std::size_t samples, double sample_rate);

  std::size_t samples() const { return fft_.length(); }
  double sample_rate() const { return sample_rate_; }
  /// |H_r| and its order: bin k = 1 … K/2 is component k − 1.
  const SpectralOperator& problem() const { return problem_; }

  /// reaction: K samples [N]. Throws InvalidInput for another length, for a sample that is not
  /// finite (with its index) and for data whose square overflows.
  InversionResult invert(std::span<const double> reaction, const InversionMethod& method) const;
  /// The same into a result and a workspace that are kept from call to call: no new arrays.
  void invert(std::span<const double> reaction, const InversionMethod& method,
              InversionWorkspace& workspace, InversionResult& result) const;

 private:
  OneSidedInversion(std::vector<std::vector<Complex>> transfer, std::size_t samples,
                    double sample_rate);
  void require_record(std::span<const double> reaction) const;
  SpectralData data_of(std::span<const Complex> spectrum, std::vector<double>& power) const;
  void apply_filter(const Regularizer& regularizer, double parameter,
                    InversionWorkspace& workspace) const;
  void write_contact_signal(std::span<const Complex> transfer, InversionWorkspace& workspace,
                            std::vector<double>& signal) const;
  void write_outputs(const InversionOutputs& outputs, InversionWorkspace& workspace,
                     InversionResult& result) const;

  RealFft fft_;
  double sample_rate_;
  std::vector<Complex> receptance_;
  std::vector<Complex> mobility_;
  std::vector<Complex> inverse_;  // 1/H_r, 0 where H_r = 0
  SpectralOperator problem_;
  std::vector<double> power_scale_;  // multiplicity/K of the components, sorted
};

}  // namespace modcal
