// What every bin of a record tells of the force, the sensors weighted by how far they may be off.
#pragma once

#include <limits>
#include <optional>
#include <span>

#include "libinverse/structure/structure_record.hpp"
#include "libinverse/structure/structure_table.hpp"

namespace modcal {

/// F of a bin has the likelihood exp(−told |F|² + 2 Re conj(score) F).
struct BinEvidence {
  std::vector<double> told;    ///< hᴴ S⁻¹ h, of one force alone Σ_k |H_k|²/V_k [1/N²]
  std::vector<Complex> score;  ///< hᴴ S⁻¹ y, of one force alone Σ_k conj(H_k) Y_k/V_k [1/N]
};

/// A force at another contact, which acts beside the one that is asked for.
struct OtherForce {
  Transfers transfers;                           ///< H_q from that contact, K
  std::vector<std::vector<double>> of_transfer;  ///< E|δH_q|², K; as BinVariances has it
  std::vector<double> power;                     ///< P_q = E|F_q|² of every bin [N²]
};

/// Variances of the sensors' bins about a force.
struct BinVariances {
  std::vector<std::vector<double>> of;  ///< V_k, K
  /// What acts elsewhere moves all sensors at once: y is off by S = diag V + Σ_q P_q h_q h_qᴴ.
  std::vector<OtherForce> others;
  /// E|δH_k|², K; empty: H is known. A bin tells (|H_k|² − E|δH_k|²)/|H_k|² of what it would, and
  /// kLeastKnown at the least: of what is no larger than its error nothing is H.
  std::vector<std::vector<double>> of_transfer;
  double misfit = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> by_sensor;  ///< rms of what each leaves over what is expected
  std::vector<double> left;       ///< rms of what each leaves over that of its response
};

/// H of the table's model at the bins.
Transfers transfers_of(const ModalModel& model, const ContourSpectra& spectra);
Transfers transfers_of(const StructureTable& table, const ContourSpectra& spectra);

/// V_k = |F|² E|δH_k|² + noise, E|δH_k|² = ε_k² Σ_n |H_kn|² of modes or that of measured functions,
/// |F|² the power that the responses tell, smoothed, times the
/// mean square by which the sensors contradict each other about the bin (more sensors than forces).
/// Of other forces P_q E|δH_qk|² adds to it.
BinVariances variances_of(const StructureTable& table, const ContourSpectra& spectra,
                          const Transfers& transfers, std::vector<OtherForce> others = {});

/// What a table's H may be off by, E|δH_k|² of every bin, K.
std::vector<std::vector<double>> transfer_variances(const StructureTable& table,
                                                    const ContourSpectra& spectra);

/// Without the sensor `left_out`, if there is such a one.
BinEvidence evidence_of(const ContourSpectra& spectra, const Transfers& transfers,
                        const BinVariances& variances, std::size_t left_out);

/// E|F|² that the bins within kReach of each may hide: a force that is not seen is not 0 without an
/// error bar. The noise of F̂ over the root of how many they are.
std::vector<double> hidden_power(const BinEvidence& evidence, const ContourSpectra& spectra);

/// One response predicted from the others.
struct SensorPrediction {
  double error = 0.0;     ///< rms of what is off over that of the response, over the bins [1]
  double coverage = 0.0;  ///< of real and imaginary parts within 95 % of what is expected
  /// Mean square of what the others leave without it, over what is expected of them, per degree of
  /// freedom: about 1, and far below where this sensor alone contradicts the others. NaN: none
  /// left.
  double others = std::numeric_limits<double>::quiet_NaN();
};

/// Power in the responses that a force explains, mean over the bins, over that of noise alone.
double power_told(const BinEvidence& evidence);

/// H_k F of the force that the other sensors tell, with the variance |H_k|²/told + V_k, for every
/// sensor in turn; empty: no more sensors than forces.
std::vector<SensorPrediction> predictions_of(const ContourSpectra& spectra,
                                             const Transfers& transfers,
                                             const BinVariances& variances);

/// Mean square of what the sensors leave of their responses, per degree of freedom; 0: there is
/// none.
double contradiction_of(std::span<const double> left, std::size_t forces = 1);

/// The one sensor without which the others agree (kAgreement); none: K < 3.
std::optional<std::size_t> odd_one_out(std::span<const SensorPrediction> predicted);

/// That one where the sensors contradict each other by kContradiction; none of three, as two that
/// agree by chance are no majority.
std::optional<std::size_t> odd_of_many(const ContourSpectra& spectra, const Transfers& transfers,
                                       const BinVariances& variances);

inline constexpr std::size_t kNoSensor = static_cast<std::size_t>(-1);

}  // namespace modcal
