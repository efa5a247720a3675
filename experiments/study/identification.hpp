// How close an identified signal comes to the true one.
#pragma once

#include <deque>

#include "experiments/study/observation.hpp"
#include "libinverse/invert.hpp"
#include "libsim/base/result_visitor.hpp"

namespace modcal {

/// Windows over which an identified force is compared with the true one.
struct ScoreOptions {
  std::vector<double> windows;    ///< starts [s]; none: the record but for its ends
  double periods = 2.0;           ///< length in periods of the fundamental
  std::vector<double> whole;      ///< start and stop of the long window [s]; none: no long window
  std::int64_t oversampling = 1;  ///< of the truth behind the anti-aliased figures; 1: none
  void visit(OptionVisitor& visitor);
};

struct WindowScore {
  double start = 0.0;                                                    ///< [s]
  double stop = std::numeric_limits<double>::quiet_NaN();                ///< [s]
  double correlation = std::numeric_limits<double>::quiet_NaN();         ///< R of eq. 16
  double relative_rms_error = std::numeric_limits<double>::quiet_NaN();  ///< static parts removed
  /// R of both forces below the cut, neither folded back by sampling (the true one low-passed
  /// before it was sampled): one re-sticking jump on the wrong side of a sample weighs no more than
  /// it lasts.
  double anti_aliased = std::numeric_limits<double>::quiet_NaN();
  /// Share of the samples whose 95 % band holds the true force, static parts removed and, where the
  /// estimate has a band limit, below that; NaN: the estimate has no band [1].
  double coverage = std::numeric_limits<double>::quiet_NaN();

  void visit(ResultVisitor& visitor) const;
  /// "0.78 s to 0.79 s: R = 0.9876, relative rms error 0.1234, 95.1 % within the 95 % band".
  std::string text() const;
};

struct ForceScores {
  std::vector<WindowScore> scores;  ///< window by window
  WindowScore whole;                ///< over the long window; NaN where none is asked for
};

/// What an identified force is held against.
struct ScoreReference {
  const Signal& truth;
  const std::optional<Signal>& anti_aliased;  ///< the truth low-passed at its full rate
  double anti_alias_cut = 0.0;                ///< [Hz]
  double fundamental = 0.0;                   ///< f₀ [Hz]
};

/// An identified force with its band.
struct ScoredForce {
  std::span<const double> samples;  ///< [N]
  /// Where sampling has not folded it back, for the anti-aliased score; empty: the samples, of
  /// which nothing was above half the rate [N].
  std::span<const double> unaliased = {};
  double deviation = std::numeric_limits<double>::quiet_NaN();   ///< of every sample; NaN: none [N]
  std::span<const double> deviations = {};                       ///< where they differ [N]
  double band_limit = std::numeric_limits<double>::quiet_NaN();  ///< of the deviation [Hz]

  explicit ScoredForce(std::span<const double> force) : samples(force) {}
  explicit ScoredForce(const Estimate& estimate);
};

/// Scores over every window of `periods`/`fundamental` seconds and over the long one. Where no
/// windows are stated: over the record but for kUnscoredPeriods periods at either end, in which no
/// wave has gone from the contact to both ends and back (a record that has not three times as many
/// periods: all of it). Throws InvalidInput where a window leaves the record or the long one is not
/// two rising instants inside it.
ForceScores score_force(const ScoredForce& identified, const ScoreReference& reference,
                        const ScoreOptions& options);
inline constexpr double kUnscoredPeriods = 2.0;

/// The part below `cut` [Hz] of a signal, sampled at every `step`-th instant.
std::vector<double> low_passed(std::span<const double> samples, double sample_rate, double cut,
                               std::size_t step = 1);

// Identified force and motion at the contact, scored where a reference is known.

/// A signal of a bowed string: its name in figures and files, and where it stands.
struct Quantity {
  std::string_view name;
  std::string_view unit;
  bool OutputRequest::*wanted;
  Signal Simulation::*simulated;
  std::vector<double> InversionResult::*identified;  ///< null: measured, not identified
  double Estimate::*deviation = nullptr;             ///< of every sample
  std::vector<double> Estimate::*deviations =
      nullptr;  ///< of each, where they differ; null: none do
  std::vector<double> Estimate::*unaliased = nullptr;       ///< what sampling has not folded back
  std::optional<Signal> Observation::*reference = nullptr;  ///< the same, measured

  /// Standard deviation at sample j; NaN: not known.
  double deviation_at(const Estimate& estimate, std::size_t j) const {
    const bool differs = deviations != nullptr && !(estimate.*deviations).empty();
    return differs ? (estimate.*deviations)[j] : estimate.*deviation;
  }
};
inline constexpr Quantity kQuantities[] = {
    {"y", "m", &OutputRequest::displacement, &Simulation::displacement,
     &InversionResult::displacement, &Estimate::displacement_deviation, nullptr, nullptr,
     &Observation::reference_displacement},
    {"v", "m/s", &OutputRequest::velocity, &Simulation::velocity, &InversionResult::velocity,
     &Estimate::velocity_deviation, &Estimate::velocity_deviations, nullptr,
     &Observation::reference_velocity},
    {"f_c", "N", &OutputRequest::force, &Simulation::force, &InversionResult::force,
     &Estimate::force_deviation, &Estimate::force_deviations, &Estimate::unaliased_force,
     &Observation::reference},
    {"R1", "N", &OutputRequest::left_reaction, &Simulation::left_reaction, nullptr},
    {"R2", "N", &OutputRequest::right_reaction, &Simulation::right_reaction, nullptr},
};
/// The one of this name.
const Quantity& quantity_of(std::string_view name);

/// A signal of the motion that was measured beside, in one window.
struct MotionScore {
  std::string_view quantity;  ///< y or v
  WindowScore score;
};

/// What the band of an estimate is of: "f_c_joint_deviation is that of the force below 15.99 kHz:
/// …"; empty where it has no limit.
std::string band_note(const Estimate& estimate);

/// One estimate of a record with its scores; empty without a reference.
struct SideIdentification : ForceScores {
  Estimate estimate;
  std::vector<MotionScore> motion = {};
};

/// Estimators prepared for one model and record length, shared by the cells of a sweep that assume
/// the same model. Keeps the last few: a sweep over model errors has as many models as cells.
class InversionCache {
 public:
  using Prepared = std::shared_ptr<const PreparedEstimator>;
  Prepared get(const AssumedModel& model, const Observation& observation,
               const InversionOptions& options, const InversionRecipe& recipe);

 private:
  std::mutex mutex_;
  // The model's numbers and the estimator's options, bit for bit.
  std::deque<std::pair<std::string, Prepared>> prepared_;
};

/// Scores of an identified force of the observation; none where `score` is null or the observation
/// has no reference.
ForceScores scores_of(const Observation& observation, const ScoredForce& force,
                      const ScoreOptions* score);
/// The same of the motion at the contact, where it was measured.
std::vector<MotionScore> motion_scores(const Observation& observation, const Estimate& estimate,
                                       const ScoreOptions& score);
/// Fills both of one estimate.
void score_side(const Observation& observation, const ScoreOptions& score,
                SideIdentification& side);

/// Inverts the reactions of the observation with the model. `score` null: no scores; `cache` null:
/// the estimator is prepared for this call alone.
std::vector<SideIdentification> identify(const Observation& observation, const AssumedModel& model,
                                         const InversionOptions& options,
                                         const InversionOutputs& outputs, const ScoreOptions* score,
                                         InversionCache* cache = nullptr);

}  // namespace modcal
