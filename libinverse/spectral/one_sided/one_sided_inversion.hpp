// The contact force from the reaction at one end of the string.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "libinverse/estimator.hpp"
#include "libinverse/spectral/problem/spectral_system.hpp"
#include "libsim/model/transfer.hpp"
#include "libsim/signal/fft.hpp"

namespace modcal {

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

/// Each reaction gives a force of its own (Debut, Delaune and Antunes, 2010, section 4), with the
/// regularizer and the parameter choice of the method.
class OneSidedEstimator final : public Estimator {
 public:
  struct Options {
    void visit(OptionVisitor& /*visitor*/) {}
  };
  explicit OneSidedEstimator(const Options& /*options*/) {}
  bool filters() const override { return true; }
  std::vector<std::string> sides() const override { return {"1", "2"}; }

 private:
  std::shared_ptr<const PreparedEstimator> do_prepare(const EstimationModel& model) const override;
};

}  // namespace modcal
