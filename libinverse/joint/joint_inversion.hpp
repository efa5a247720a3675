// The contact force from the reactions at both ends at once.
#pragma once

#include <array>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "libinverse/joint/evidence_curve.hpp"
#include "libinverse/joint/force_prior.hpp"
#include "libinverse/joint/joint_kernels.hpp"
#include "libinverse/joint/sensor_noise.hpp"
#include "libinverse/joint/string_transfer.hpp"
#include "libinverse/joint/transient_fit.hpp"
#include "libinverse/spectral/one_sided/one_sided_inversion.hpp"
#include "libsim/signal/fft.hpp"

namespace modcal {

/// What is taken care of at the ends of the record.
enum class Truncation {
  kShiftedContour,  ///< at rest at t = 0; what rings on past the end is damped by exp(−σT)
  kTransient,       ///< any state at either end: two unknowns a mode
  kWrapped,         ///< nothing: the record is one period of a periodic motion
};

/// Static levels that sensors lose.
enum class OffsetRule {
  kArrival,  ///< at rest at t = 0: the mean before the first wave arrives is no reaction
  kNone,
};

/// The string and its sensors as a joint inversion supposes them.
struct JointModel {
  Truncation truncation = Truncation::kShiftedContour;
  double sigma = 0.0;  ///< real part of the contour [1/s]; 0 unless the contour is shifted
  StringSupport support = {};
  SensorPair sensors = {};
};

/// How to invert. The prior must outlive the call.
struct JointMethod {
  const ForcePrior& prior;
  OffsetRule offset = OffsetRule::kArrival;
  /// Nothing is identified above it [Hz]; NaN: no limit.
  double band_limit = std::numeric_limits<double>::quiet_NaN();
  /// Prior variances given in place of the prior's [N²], relative; empty: the prior's. Its evidence
  /// is not searched: amplitude 1.
  std::span<const double> known_variance = {};
  InversionOutputs outputs = {};
  bool variances = false;  ///< of every bin, too
};

/// Standard deviations of the force given the record, the same at every instant.
struct PosteriorDeviation {
  double force = std::numeric_limits<double>::quiet_NaN();         ///< [N]
  double displacement = std::numeric_limits<double>::quiet_NaN();  ///< [m]
  double velocity = std::numeric_limits<double>::quiet_NaN();      ///< [m/s]
};

struct JointResult {
  InversionResult identified;
  PosteriorDeviation deviation;
  /// Of every bin by the noise alone, not widened by the misfit, that of a sample being the mean
  /// over all K bins [N², (m/s)²]; where wanted.
  std::vector<double> force_variance, velocity_variance;
  /// What the misfit adds to them.
  std::vector<double> force_excess, velocity_excess;
  std::vector<double> side_misfit;  ///< of every bin, smoothed; where wanted
  /// By how much it makes the force's deviation larger that nobody says whether the ends feel the
  /// bending of the string.
  double bending_widening = 1.0;
  std::array<double, 2> offset = {0.0, 0.0};  ///< subtracted from the reactions [N]
  /// By how much what is added below the first mode, where sensors drift and hum, makes the force's
  /// deviation larger.
  double slow_widening = 1.0;
  double noise_amplitude = 0.0;  ///< √v̄, v̄ the mean variance of the sides [N]
  /// Mean over the bins of the band of |R_1 H_2 − R_2 H_1|² over what the noise puts there: 1 where
  /// the model holds, NaN with one reaction.
  double misfit = std::numeric_limits<double>::quiet_NaN();
};

/// Arrays that a call needs besides its results, to be kept from call to call; one per thread.
struct JointWorkspace {
  SensorNoise::Workspace noise;
  SideSpectra spectrum;
  std::vector<double> gain;      ///< q_k = Σ_r |H_r|²/v_r
  std::vector<double> variance;  ///< prior P_k, then posterior 1/(q_k + 1/P_k)
  std::vector<double> misfit;    ///< of the sides in every bin, smoothed
  /// By which share of what the data alone leave of F_k its variance grows by what the sensors err
  /// by; empty: the sides differ as the noise allows.
  std::vector<double> side_error;
  std::vector<double> power;  ///< |Σ_r conj(H_r) R_r/v_r|² of a unit sum of weights
  std::vector<double> terms[3];
  SideSpectra recorded;         ///< before the decays are taken out
  std::vector<double> learned;  ///< prior variance of F_k that they were fitted with
  /// Variances of force, displacement and velocity by the errors of the decays, on the scale of
  /// `variance`.
  std::array<std::vector<double>, 3> by_decays;
  std::vector<double> scratch;
  std::vector<Complex> contact;
  EvidenceCurve::Cells cells;
  TransientFit::Workspace transient;
  bool level_known = false;  ///< bin 0 tells the force's
};

/// F = Σ_r conj(H_r) R_r/v_r ÷ (Σ_r |H_r|²/v_r + 1/P) on s = σ + iω, with noise variances v_r and a
/// prior force spectrum P whose amplitude has the largest evidence. The record is weighted by
/// exp(−σt) before and exp(σt) after. With one reaction it is the Wiener estimate of that side.
///
/// The deviations are those of the posterior where the two reactions agree within the noise. Where
/// they contradict each other by far more (on the contour a record of less than 0.1 % noise, whose
/// aliases and wrapped end no noise level tells of; a model that is wrong), the variance that the
/// data leave grows by what either sensor would have to err by to part them so, and F with it. Far
/// below f_1 a contact near x = 0 is seen by R_1 alone: an error of R_1 moves F as much as it moves
/// R_1, and the cross relation by |H_2/H_1| of that. No sensor errs by more than it reads. For
/// bowed strings the 95 % band holds 93 % to 98 % of the truth at 0.1 % to 10 % of noise and more
/// of it below.
///
/// The parameter reported is λ = √(v̄/A), A the prior's amplitude: the |H| [N/N] at which a bin of
/// prior shape 1 is kept by half. Prepared once per model and record length; const and safe to use
/// from several threads. No heap allocation after the first call with a workspace and a result,
/// unless the truncation is kTransient.
class JointInversion {
 public:
  /// `contact` x_c in [0, L] [m], `samples` ≥ 1, `sample_rate` > 0 [Hz]; `points` ≥ 3 of the curve.
  JointInversion(const ModalBasis& basis, double contact, std::size_t samples, double sample_rate,
                 const JointModel& model, std::size_t points = 100);

  /// Mean misfit of the sides from which on it is worth a warning. Unknown ends leave nothing of
  /// the wrap: what is left is the model's, and always widens the deviations.
  double contradiction() const;

  std::size_t samples() const { return fft_.length(); }
  double sample_rate() const { return sample_rate_; }
  double sigma() const { return model_.sigma; }
  /// max_k |H_r(s_k)| over both sides [N/N].
  double largest_transfer() const { return largest_transfer_; }
  double fundamental() const { return fundamental_; }  ///< of the first mode [Hz]

  /// Throws InvalidInput for lengths that differ, no reaction at all, a sample that is not finite
  /// (with its index), a noise level that is negative.
  void invert(const ReactionPair& reactions, const SensorNoiseLevel& noise,
              const JointMethod& method, JointWorkspace& workspace, JointResult& result) const;

  /// The noise lowered to what the cross relation leaves in the whole band: the variances v_1, v_2
  /// of E|R_1 H_2 − R_2 H_1|² = v_1 |H_2|² + v_2 |H_1|² by their likelihood (NoiseModel), 50 Hz to
  /// 0.45 f_s, bins above eight times their expectation left out (what wraps around beside
  /// resonances). Unchanged with one reaction. Throws as invert() does.
  SensorNoiseLevel lowered_noise(const ReactionPair& reactions, SensorNoiseLevel noise,
                                 OffsetRule rule, JointWorkspace& workspace) const;

  /// What free decays without a force leave of the reactions up to the highest mode, over the
  /// noise: 1 where the string rings by itself (TransientFit). Each end has amplitudes of its own:
  /// a sensor's gain, or a force that is small, is not looked at. NaN unless the truncation is
  /// kTransient. Throws as invert() does.
  double ringing_misfit(const ReactionPair& reactions, const SensorNoiseLevel& noise,
                        std::span<const double> lines, JointWorkspace& workspace) const;

 private:
  struct SidePower {
    bool recorded = false;
    double mean = 0.0;  // of the squares [N²]
  };
  using SidePowers = std::array<SidePower, 2>;
  /// Of the two sides, in every bin.
  struct Weights {
    std::array<double, 2> inverse_variance = {0.0, 0.0};
    double mean_variance = 0.0;
    Weights(const SidePowers& powers, const SensorNoiseLevel& noise);
  };
  SidePowers require_record(const ReactionPair& reactions, const SensorNoiseLevel& noise) const;
  std::size_t samples_before_arrival(std::size_t side) const;
  double offset_of(std::span<const double> reaction, std::size_t side) const;
  void transform(const ReactionPair& reactions, OffsetRule rule, JointWorkspace& workspace,
                 JointResult& result) const;
  double allow_for_offsets(OffsetRule rule, std::span<double> misfit) const;
  void compare_sides(const Weights& weights, const JointMethod& method, JointWorkspace& workspace,
                     JointResult& result) const;
  void find_side_errors(const Weights& weights, double half, JointWorkspace& workspace) const;
  void combine(const Weights& weights, JointWorkspace& workspace) const;
  void set_prior(const JointMethod& method, JointWorkspace& workspace) const;
  void fill_cells(const Weights& weights, JointWorkspace& workspace) const;
  void choose_amplitude(const Weights& weights, const JointMethod& method,
                        JointWorkspace& workspace, JointResult& result) const;
  void limit_band(double limit, JointWorkspace& workspace) const;
  void learn_spectrum(const ForcePrior& prior, double band_limit, JointWorkspace& workspace) const;
  TransientFit::Setting setting_of(const Weights& weights, const JointWorkspace& workspace) const;
  void take_out_decays(const Weights& weights, const JointMethod& method, JointWorkspace& workspace,
                       JointResult& result) const;
  void find_errors_of_decays(const Weights& weights, const JointMethod& method,
                             JointWorkspace& workspace) const;
  void apply_posterior(const Weights& weights, const JointMethod& method, JointWorkspace& workspace,
                       JointResult& result) const;
  void widen_by_misfit(bool keep, JointWorkspace& workspace, JointResult& result) const;
  void widen_by_bending(JointWorkspace& workspace, JointResult& result) const;
  void count_bins(double kept_pairs, JointWorkspace& workspace, InversionResult& identified) const;
  double deviation_of(double sum, std::span<const Complex> transfer, std::span<const double> more,
                      const JointWorkspace& workspace) const;
  enum class ContactSignal { kForce, kDisplacement, kVelocity };
  double write_signal(ContactSignal what, bool wanted, JointWorkspace& workspace,
                      std::vector<double>& signal) const;

  InPlaceFft fft_;
  double sample_rate_;
  JointModel model_;
  SideSpectra transfer_;
  std::vector<Complex> receptance_;
  std::vector<Complex> mobility_;
  std::array<double, 2> arrival_ = {0.0, 0.0};  ///< [s]
  double largest_transfer_ = 0.0;
  double fundamental_ = 0.0, highest_ = 0.0;  // frequencies of modes [Hz]
  std::vector<double> decay_;                 ///< exp(−σ t_j), empty for σ = 0
  std::vector<double> growth_;                ///< exp(σ t_j)/K
  std::vector<double> bending_share_;  ///< |1 − H/H′|², H′ with bending; empty: it is known
  double weight_power_ = 0.0;          ///< W = Σ_j exp(−2σ t_j)
  PriorGrid grid_;
  EvidenceCurve curve_;
  TransientFit transient_;
};

/// σ = ln(1/p)/2T − ζ_1ω_1/2 kept within 1/T … 4/T: what wraps around, exp(−(σ + ζ_1ω_1)T), and the
/// noise of the late record, p exp(σT) with p the share of noise, then weigh the same.
double contour_of(const ModalBasis& basis, double duration, double noise_share);

}  // namespace modcal
