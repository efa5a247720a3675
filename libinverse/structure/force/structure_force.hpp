// The force at a contact of a structure from the responses of K sensors.
#pragma once

#include <cstdint>
#include <optional>

#include "libinverse/structure/blind_fit.hpp"

namespace modcal {

/// What is supposed about the force before the responses are looked at.
enum class ForceShape {
  kAuto,     ///< the one of larger evidence; a smooth one where the window is too long for pulses
  kImpacts,  ///< pulses of the table's shape, few of all instants
  kSmooth,   ///< a stationary force of a smooth spectrum
};

struct StructureForceOptions {
  ForceShape shape = ForceShape::kAuto;
  bool non_negative = false;  ///< pulses of one sign
  /// The force acts from t = 0 until then [s]; NaN: as acting_part() finds.
  double window = std::numeric_limits<double>::quiet_NaN();
  /// Contour [1/s]; NaN: 2 over the window, what the force does later weighs little then, or that
  /// of measured functions, if that is more.
  double sigma = std::numeric_limits<double>::quiet_NaN();
  /// The record begins at rest. One sensor then needs no state before it; several tell it.
  bool rests = false;
  double quiet = 0.0;      ///< so long no response leaves its level at first [s]
  std::size_t draws = 12;  ///< models drawn from the table's deviations for the band
  std::uint64_t seed = 1;
  /// The structure may have changed since its table was made: the modes are refined first.
  std::optional<StructureChange> change;
  /// Where that is not stated and the sensors contradict the table (kChanged), one of the size that
  /// the responses tell is allowed for.
  bool may_have_changed = true;
};

struct StructureForce {
  ForceShape shape = ForceShape::kSmooth;
  std::size_t forces = 1;         ///< that act at once, at as many contacts
  double sigma = 0.0;             ///< of the contour [1/s]
  double window = 0.0;            ///< until when it acts [s]
  double weak_until = 0.0;        ///< ActingPart
  std::vector<double> force;      ///< f_j [N], from t = 0 to the window's end
  std::vector<double> deviation;  ///< of each [N]
  std::vector<double> by_model;   ///< share of the table's errors in it [N]
  double background = 0.0;        ///< of impacts: share of the force's power that adds to them
  /// ln p(data) over that without force; NaN: not tried.
  double evidence_impacts = std::numeric_limits<double>::quiet_NaN();
  double evidence_smooth = 0.0;
  /// Instants of a pulse in the window where `auto` did not try them: too many (kMostInstants), or
  /// many (kFewInstants) of a smooth force without peaks; 0: tried.
  double untried = 0.0;
  double told = 0.0;  ///< power in the responses that a force explains, over that of noise alone
  double rise = 0.0;  ///< rise_towards_zero() of the force's power; NaN: not told
  /// log_odds_of_push() of impacts; NaN: a smooth force, or not told.
  double push_odds = std::numeric_limits<double>::quiet_NaN();
  bool from_zero = false;  ///< the band begins at 0 Hz
  bool rang = false;       ///< when the record began, by what the responses tell
  double misfit =
      0.0;  ///< what the sensors contradict each other by, over what is expected; NaN: they cannot
  std::vector<double> sensor_misfit;        ///< rms of what each leaves over what is expected, K
  std::vector<double> sensor_left;          ///< the same over its response, K; both empty: K = 1
  std::vector<SensorPrediction> predicted;  ///< of each from the others, K; empty: K = 1
  std::optional<BlindFit> refined;          ///< where a change was allowed for
  /// The sensor without which the others agree, as they did not by far: nothing above has it.
  std::optional<std::size_t> left_out;
};

/// The part of a record in which its force acts.
struct ActingPart {
  std::size_t first = 0;  ///< sample with which it begins
  double duration = 0.0;  ///< [s]
  /// So long in the record the force stays weak behind the part [s]; 0: it was not looked for.
  double weak_until = 0.0;

  StructureRecord of(const StructureRecord& record) const;
};

/// The window that is stated. Else what is quiet at the beginning is left out, and the part ends a
/// quarter of its length, and half a period of the table's mean spacing of modes, after the last
/// instant at which a smooth force is above kLoud of its peak, or with two deviations above twice
/// that: a model that is off is off by more the longer it rings. Found from all of the record, and
/// again from the part so long as that makes it shorter. Of what acts in the last tenth of the
/// record too little is seen: all of the record is taken where a response is kLate times as large
/// there as in the tenth before.
ActingPart acting_part(const StructureTable& table, const StructureRecord& record,
                       const StructureForceOptions& options);

/// F = Σ_k conj(H_k) Y_k/V_k ÷ (Σ_k |H_k|²/V_k + 1/P) in every bin of a contour, or, for impacts,
/// F = G Σ_j p_j exp(−s t_j), p_j ~ N(0, a_j) with the a_j of largest evidence (automatic relevance
/// determination in time; Tipping, 2001, MacKay's update), on a smooth background of 1e-6, 1e-4 or
/// 1e-2 of the power. V_k is the table's scatter,
/// ε_k² |F|² Σ_n |H_kn|² and noise, times what the sensors contradict each other by. The band holds
/// the posterior, the table's errors (models drawn, solved again) and, from three sensors on, the
/// jackknife over them, the larger of both. Where the responses tell that the structure rang when
/// the record began, that is fitted and taken out first (InitialState); measured functions do not
/// know of it. One sensor of four or more without which the others agree (odd_one_out()) is left
/// out where they contradict each other by kContradiction. Throws InvalidInput for a record whose
/// sensors are not those of the table.
StructureForce structure_force(const StructureTable& table, const StructureRecord& record,
                               const StructureForceOptions& options);

/// Leaves every table the band that all have in common. Throws InvalidInput where there is none.
void share_band(std::vector<StructureTable>& tables);

/// Forces at several contacts at once, a table for each, of the same structure and sensors, of
/// which there are more than contacts: structure_force() of each beside the others, as Gaussian
/// forces of the powers that the responses tell of them, found in turn from what each of them alone
/// would explain on. The window is what is stated, or all that is not quiet, and the structure that
/// of its tables. Throws InvalidInput for tables of other sensors, whose bands have nothing in
/// common, and too few sensors.
std::vector<StructureForce> structure_forces(std::vector<StructureTable> tables,
                                             const StructureRecord& record,
                                             const StructureForceOptions& options);

}  // namespace modcal
