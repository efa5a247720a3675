// One search for the force of a part of a record.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "libinverse/structure/bin_evidence.hpp"
#include "libinverse/structure/force/drawn_models.hpp"
#include "libinverse/structure/force/initial_state.hpp"
#include "libinverse/structure/force/pulse_train.hpp"
#include "libinverse/structure/force/structure_force.hpp"

namespace modcal {

/// Another contact of the structure, at which a force of such power acts as well.
struct OtherContact {
  StructureTable table;
  std::vector<double> power;  ///< E|F_q|² of every bin of the part [N²]
};

/// Force signals in the window, linear in unknown amplitudes of pulses or bins.
class ForceSearch {
 public:
  ForceSearch(const StructureTable& table, const StructureRecord& record,
              const StructureForceOptions& options, double window,
              std::span<const OtherContact> others = {});

  /// odd_of_many().
  std::optional<std::size_t> odd_sensor() const;
  /// After which a smooth force stays below kLoud of its peak, below twice that with two deviations
  /// [s]. It is looked for until `seen` [s]: behind that the record's end looks like a force.
  double loud_until(double seen);
  /// Refines the modes by the part where a change is stated, or the sensors contradict the table.
  bool refine(const StructureRecord& record);
  const StructureTable& table() const { return table_; }
  /// E|F|² of every bin, as far as it is told.
  std::vector<double> power();
  /// structure_force() of this part; the search is over then.
  StructureForce run();

 private:
  double rate() const;
  /// What is stated, or, where the sensors contradict the table, one whose size is found.
  std::optional<StructureChange> change_wanted() const;
  /// What each sensor leaves, over the whole of its response.
  std::vector<double> left_of_responses() const;
  /// Those of the table; of modes that were refined H may be off by what is left unknown of them.
  BinVariances variances() const;
  /// E|δH_k|² of models drawn from what a refinement has left unknown, K.
  std::vector<std::vector<double>> spread_of_change() const;
  /// Force, variances and state depend on each other: a few rounds.
  void take_state_out();
  /// Deviations of the state of one sensor, which tells it from a force by its size alone: that of
  /// the response where the record ends. Empty: more sensors, a structure that rang before, or
  /// nothing that shows is cut off.
  Eigen::VectorXd state_widths(const InitialState& state) const;
  /// The force by other models, of the other contacts, too, what rang fitted anew and off by what
  /// is not known of it.
  Eigen::VectorXd force_by(const DrawnModels& models, std::size_t draw) const;
  BinVariances with_drawn_contacts(std::size_t draw) const;
  bool wants_pulses(const BinEvidence& evidence);
  /// Pulses on a background of a share of the force's power: the share of largest evidence. All of
  /// it and no pulse is a smooth force.
  void find_pulses(const BinEvidence& evidence);
  /// What the bins tell of another force when a background of such power may add to it.
  BinEvidence beside(const BinEvidence& evidence, const std::vector<double>& power) const;
  double evidence_of_power(const BinEvidence& evidence, const std::vector<double>& power) const;
  void find_power(const BinEvidence& evidence);
  Eigen::VectorXd force_of(const BinEvidence& evidence) const;
  Eigen::VectorXd variance_of(const BinEvidence& evidence) const;
  /// Samples in the window of what has these bins on the contour.
  Eigen::VectorXd signal_of(const std::vector<Complex>& bins) const;
  /// The force by each pulse as it is, and by the background as the bins then tell it: where they
  /// tell it well, the background makes up for what a pulse is off by.
  Eigen::MatrixXd pulses_beside_background(const BinEvidence& evidence) const;
  /// Variance of the force by models drawn from the table's deviations.
  Eigen::VectorXd by_models(const Eigen::VectorXd& best) const;
  /// Where the sensors contradict each other by more than the table says, so is it off by more.
  double contradiction() const;
  /// Jackknife over the sensors; nothing without two that the forces do not take.
  Eigen::VectorXd by_sensors() const;

  StructureTable table_;
  const StructureForceOptions& options_;
  ContourSpectra spectra_;
  // recorded_: responses with what rang before and what the end cuts off; empty: as they are
  Transfers transfers_, recorded_;
  std::vector<OtherContact> contacts_;  // the others
  std::vector<OtherForce> others_;      // as their tables have them
  double lines_outside_ = 0.0;          // power_of_lines_outside()
  double last_rms_ = 0.0;               // of the first response's last tenth
  BinVariances variances_;
  std::vector<std::vector<double>> of_change_;  // empty: nothing was refined
  Eigen::Index samples_ = 0;
  std::optional<PulseTrain> train_;
  Eigen::VectorXd widths_;
  Eigen::MatrixXd pulses_;
  std::vector<double> power_, background_;  // of the force, and of what adds to its pulses
  StructureForce result_;
};

}  // namespace modcal
