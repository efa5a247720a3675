// Modes of a structure as a table, with what is known of their errors.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "libinverse/structure/measured_functions.hpp"

namespace modcal {

/// How a sensor's response departs from the model: of mode n by ε_k of what the mode makes, and
/// noise.
struct SensorScatter {
  double modal = 0.0;  ///< ε_k [1]
  double noise = 0.0;  ///< standard deviation of one sample, in the sensor's unit
};

/// A model with error bars, between `low` and `high` [Hz]: modes, or what was measured in their
/// place.
struct StructureTable {
  ModalModel model;                ///< without poles where functions were measured
  MeasuredFunctions measured;      ///< empty: modes
  std::vector<std::string> names;  ///< of the sensors, K
  /// Of ln f_n and ln ζ_n, of a further strike where several tell it; empty: exact.
  std::vector<double> frequency_deviations, damping_deviations;
  std::vector<SensorScatter> scatters;  ///< K
  std::vector<double> contact;          ///< φ_n²/m_n of the force [1/kg]; empty: unknown
  double low = 0.0, high = 0.0;         ///< band [Hz]
  double lag = 0.0;                     ///< of the pulse's spectrum [Hz]
  std::vector<double> pulse;            ///< |G| at 0, lag, 2 lag, … [1]; empty: not known

  std::vector<std::string> warnings;  ///< what was supposed where its files do not tell

  /// |G| of the force's pulse at a frequency [Hz]. Of one that is not known the band alone is told:
  /// 1 up to `high`, fading out over a quarter above it.
  double pulse_at(double frequency) const;
  double frequency(std::size_t n) const;  ///< [Hz]
  /// |G| of the largest pulse of a strike's force, ten periods of `high` to either side of its
  /// peak, fading out.
  void take_pulse(const StructureRecord& strike);
  StructureTable without_sensor(std::size_t k) const;
  /// Throws InvalidInput for measured functions: `what` needs modes.
  void require_modes(std::string_view what) const;
};

/// How far the structure may be from its table: standard deviations of the priors.
struct StructureChange {
  double frequency = 0.01;  ///< of ln f_n [1]
  double damping = 0.3;     ///< of ln ζ_n [1]
  /// Of each modal constant, real and imaginary part, over its size or, where that is smaller, over
  /// the rms of the mode's constants at the sensors of one kind [1]; 0: known. What changes a shape
  /// does not spare its nodes.
  double residue = 0.05;
  /// What changes frequencies by ε turns the shapes of two modes into each other by coupling · ε
  /// √(f_n f_m)/|f_n − f_m| (first order of perturbation; 1: a change in one place): constants that
  /// are not known may be off by that, too [1]; 0: each by itself.
  double coupling = 1.0;
  /// The sizes of the first three are found from the responses, from those here on.
  bool is_found = false;

  /// One whose size is found.
  static StructureChange open();
  /// A size that is found is next to the most that it may be: what differs is another structure.
  bool is_at_bound(double StructureChange::*size) const;
};

/// With imaginary parts of the constants, 0 where they are not stated.
ModalModel with_quadrature(ModalModel model);
/// θ = ln f_n, ln ζ_n, then Re d_kn and Im d_kn (BlindFit), away from a model.
ModalModel moved_by(const ModalModel& table, const Eigen::VectorXd& theta);
/// Of every θ_i of the model's modes, K sensors each.
Eigen::VectorXd deviations_of(const StructureChange& change, const ModalModel& table);

/// Σ_n |H_n(s)|² of a pair: what its modes make, each by itself.
double modal_power(const ModalModel& model, std::size_t pair, Complex s);

}  // namespace modcal
