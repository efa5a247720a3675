// What may be in a record that the model of string and sensors has not, to first order.
#pragma once

#include <Eigen/Core>
#include <array>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libcalib/likelihood/projected_likelihood.hpp"

namespace modcal {

/// Names of causes.
inline constexpr std::string_view kPolarization = "second polarization";
inline constexpr std::string_view kDrift = "drift of the tuning";
inline constexpr std::string_view kNonlinear = "nonlinear sensor";
inline constexpr std::string_view kModesAbove = "modes above";
inline constexpr std::string_view kContact = "contact that moves";
inline constexpr std::string_view kBridge = "bridge that moves";
inline constexpr std::string_view kResonance = "resonance of a sensor";

/// Width of an amplitude of which nothing is known before.
inline constexpr double kUnknown = std::numeric_limits<double>::infinity();

/// A cause of misfit: amplitudes of what it adds to both records, to first order.
struct MisfitCause {
  std::string name;
  std::string detail = {};  ///< which of several tried, in words; empty: there is one
  std::vector<SignalColumn> columns = {};
  double place = 0.0;  ///< of a mode of the body or a resonance [Hz]
  /// Prior sd of the amplitudes of a cause that may be in any record: the deviations hold what the
  /// record leaves untold of it. ∞: nothing is known. Empty: it is taken for absent until
  /// suspected.
  Eigen::VectorXd widths = {};
  /// What an amplitude of 1 of the first columns makes of the modes, a column each: relative change
  /// of s_n, the real part of f_n, the imaginary one added to ζ_n. The f_n and ζ_n reported are
  /// those of the string with this cause; the response of the sensors, which holds a part of it,
  /// does not count. Empty: the modes are the string's own.
  Eigen::MatrixXcd modes = {};
  /// The largest κ_n = 2(T/L) ω_n²/|s_n² + 2ζω_b s_n + ω_b²|², by an amplitude of 1: the square of
  /// how far mode n and that of the body push each other apart, over their distance. Above some
  /// tenths `modes` is too small.
  double coupling = 0.0;
};

/// What the score test of one cause says (score_tests.hpp).
struct ScoreTest {
  std::string cause, detail;
  double place = 0.0;      ///< of a mode of the body or a resonance [Hz]
  double statistic = 0.0;  ///< S, χ² of `degrees` where the cause is not there [1]
  std::size_t degrees = 0;
  double log_p = 0.0;      ///< ln of the chance of S or more by noise, in any of those tried
  double amplitude = 0.0;  ///< estimated to first order; of several their root square sum [1]; of a
                           ///< bridge 1/m [1/kg]
  Eigen::VectorXd amplitudes;   ///< all, of `columns`
  double shift = 0.0;           ///< largest change of an unknown, were it free, in its deviations
  double shift_per_root = 0.0;  ///< the same where √S is 1, by the worst amplitudes and detuning
  std::string unknown;          ///< that this is of
  Eigen::VectorXd moved;        ///< change of all unknowns θ that count, were it free
  double contradiction = 0.0;   ///< the shift of what is wrong where the cause is in the record
  double coupling = 0.0;        ///< κ of the amplitude estimated (MisfitCause)
  /// Covariance of such changes by amplitudes that the data do not tell: of every unknown the most
  /// at any place tried, by what speaks for it; empty: a cause that is taken for absent until it is
  /// suspected.
  Eigen::MatrixXd untold;
  double log_evidence = 0.0;  ///< ln of the cause's likelihood by its widths over that without it
  std::vector<SignalColumn> columns;  ///< where it is named and frees()
  /// Of a bridge that moves: a resonance of a sensor, from which S does not tell it.
  std::vector<ScoreTest> rivals;

  /// Noise does so in one of 8000 tests, of the five causes in one of 1600 records.
  bool named() const { return log_p < -9.0; }
  /// The change of all unknowns as far as the cause is suspected. The deviations hold its square.
  Eigen::VectorXd suspected() const;
  /// Named, and it moves an unknown by two deviations, out of the interval that holds 95 %: of a
  /// bridge that moves x_c alone, while κ < 0.1. f_n and ζ_n are those on this bridge, and the
  /// deviations hold what it does to them.
  bool refuses() const;
  /// √(1 − 2p), 0 where half of all records without the cause say as much.
  double suspicion() const;
  /// Moves modes off the law, and those the most beside which it is a resonance: what the modal
  /// model has not is as large there as the departure.
  bool moves_modes_off_law() const;
  /// Linear enough to be free in a further fit; a bridge that moves where κ < 0.05.
  bool frees() const;
  /// What to do about it, in words.
  std::string_view remedy() const;
};
/// A mode of the body in words: its place [Hz] and, where 1/m > 0, its mass.
std::string bridge_detail(double place, double inverse_mass);
/// The named test of the least chance; null: none is.
const ScoreTest* first_cause(const std::vector<ScoreTest>& tests);

/// Causes of one name differ in a number that is tried.
///
/// - "second polarization": every mode once more at ω_n(1 + δ), a share of it at x = 0 and one at
///   x = L; δ = ±0.1, 0.3 and 1 %;
/// - "drift of the tuning": ω_n(t) = ω_n (1 + p (t/T − 1/2)), p the drift over the record;
/// - "nonlinear sensor": p y³/⟨y²⟩ in each record, y what the fit leaves of it without noise;
/// - "modes above": p_0 and p_1 s² times the force at either end;
/// - "contact that moves": x_c(t) = x_c + Σ_j p_j φ_j(t), φ a slope over the record and sines and
///   cosines of some whole periods of it;
/// - "bridge that moves": x = L is on a mode of a body, of 1/m, at frequencies from f_1/2 to 20
/// f_1.
///
/// All take the motion or the force of the fit. Weights of `likelihood` play no part; σ = 0.
std::vector<MisfitCause> misfit_causes(const ProjectedLikelihood& likelihood,
                                       const ModelPoint& point);
/// Places of modes beside one of the body, a quarter of a step of misfit_causes() lower and higher.
std::array<double, 2> places_beside(double place);
/// "bridge that moves" at these places [Hz]; of a record that it was taken out of by what is
/// recorded at x = L. With two modes beside each, whose 1/m stand last: by these the place and the
/// damping are free to first order.
std::vector<MisfitCause> bridges_at(const ProjectedLikelihood& likelihood, const ModelPoint& point,
                                    std::span<const double> places);
/// "bridge that moves" between the places of misfit_causes() on either side of `place` [Hz], and
/// what may look like it: "resonance of a sensor", shares of what the fit leaves of either record
/// without noise, times 2ζ_b ω_b s and ω_b² over s² + 2ζ_b ω_b s + ω_b².
std::vector<MisfitCause> resonances_about(const ProjectedLikelihood& likelihood,
                                          const ModelPoint& point, double place);

}  // namespace modcal
