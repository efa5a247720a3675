// Nonlinear observer of the bowed string: simulates string and friction law and is corrected by the
// measured reactions at every sample. Kernel: no allocation, no I/O, no virtual call; instruction
// set chosen at run time.
//
// At sample k: ν = z_k − b − G Z, Z += K ν (the elongation of the adherence spring stays), the
// force is found again, and `coarse` steps of the exact propagator with first-order hold and the
// implicit scalar friction equation lead to sample k + 1. A step in which the string attaches or is
// released is taken again in `fine` ones; the jump of the force at an attachment is put at the
// linear crossing inside the fine step.
#pragma once

#include <cstddef>
#include <span>

#include "libinverse/observer/blended_sliding.hpp"
#include "libinverse/observer/string_tables.hpp"

namespace modcal::observer {

/// Correction per innovation of one reaction, Z += K₁ ν₁ + K₂ ν₂ [m/(N s)].
struct GainTable {
  PlanarVector left, right;
};

/// Contact parameters that stay the same over the record.
struct ContactLaw {
  BlendedSliding sliding;
  double stiffness = 0.0;  ///< K_a [N/m]
  double damping = 0.0;    ///< C_a [N s/m]
  double offset[2] = {};   ///< b, static level lost by the sensors [N]
};

/// State between two samples.
struct ObserverState {
  PlanarVector modes;
  double elongation = 0.0;   ///< y_c of the adherence spring [m]
  double force = 0.0;        ///< f_c [N]
  double side = -1.0;        ///< sgn v_c while it slides
  double temperature = 0.0;  ///< T of a thermal law [1]
  bool sticking = false;

  /// At rest on a string at rest, the bow moving in the positive direction.
  static ObserverState at_rest(std::size_t size);
};

/// Arrays over the samples of the whole record; null outputs are not written.
struct ObserverSignals {
  const double* left = nullptr;          ///< z₁ [N]
  const double* right = nullptr;         ///< z₂ [N]
  const double* force_scale = nullptr;   ///< F_N(t) over its mean [1]
  const double* bow_velocity = nullptr;  ///< v_bow(t) [m/s]
  double* left_innovation = nullptr;     ///< ν₁ [N]
  double* right_innovation = nullptr;    ///< ν₂ [N]
  double* force = nullptr;               ///< f_c [N]
  double* velocity = nullptr;            ///< v(x_c) [m/s]
  double* displacement = nullptr;        ///< y(x_c) [m]
  double* mean_force = nullptr;          ///< mean of f_c from this sample to the next [N]
};

/// Runs samples [first, last): corrected at each, then taken on to the next. On return `state` is
/// the prediction for sample `last`.
void run_observer(const StringTables& string, const ContactLaw& contact, const GainTable& gain,
                  const ObserverSignals& signals, std::size_t first, std::size_t last,
                  ObserverState& state);

}  // namespace modcal::observer
