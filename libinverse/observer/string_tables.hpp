// The string as the observer steps it: exact propagators of two lengths of step.
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "libsim/base/aligned_vector.hpp"
#include "libsim/dynamics/scene/simulation.hpp"
#include "libsim/model/modal_basis.hpp"

namespace modcal::observer {

/// One length of step h of all modes, Z(h) = r Z + a f_old + d f_new with the force linear over the
/// step (first-order hold), Z as in libsim/dynamics/contact_modes.hpp.
struct StepTable {
  double step = 0.0;       ///< h [s]
  PlanarVector propagate;  ///< r = e^{λh}
  PlanarVector undo;       ///< 1/r
  PlanarVector older;      ///< a
  PlanarVector newer;      ///< d
  PlanarVector deferred;   ///< D = r d + a
  /// Answer of the contact to a, d, D: velocity [m/(N s)] and displacement [m/N].
  MotionSample older_response, newer_response, deferred_response;
};

/// Steps per sample of the string: `coarse` ones, and `fine` ones in those that hold a switch.
struct Substeps {
  std::size_t coarse = 10;
  std::size_t fine = 8;
};

struct StringTables {
  StepTable coarse, fine;
  Substeps substeps;
  std::vector<std::size_t> mode;  ///< index in the modal basis of every mode kept
  std::vector<double> shape;      ///< φ_n(x_c) of the modes kept
  AlignedVector quadrature;       ///< v = Σ Re Z − quadrature Im Z
  AlignedVector compliance;       ///< y = Σ compliance Im Z
  AlignedVector gain[2];          ///< R_r = Σ gain_r Im Z
  double effective_mass = 0.0;    ///< 1/Σ φ²/m [kg]

  /// Length of the arrays, padding included.
  std::size_t size() const { return compliance.size(); }
};

/// Tables of the modes that the contact at x_c [m] reaches. Throws InvalidInput where it reaches
/// none.
StringTables make_string_tables(const ModalBasis& basis, double contact, double sample_rate,
                                Substeps substeps);

}  // namespace modcal::observer
