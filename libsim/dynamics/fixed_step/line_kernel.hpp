// A step of all modes as several contact points see them. Kernel: no allocation; instruction set
// chosen at run time.
#pragma once

#include "libsim/dynamics/fixed_step/step_coefficients.hpp"

namespace modcal {

/// Most contact points. Fixed by: those that a bow may have (Bow::contact_points()).
constexpr std::size_t kMostPoints = 16;

/// One-step coefficients of every mode, padded with zeros to whole vectors. S is the part of Z that
/// does not hold the newest force: S ← r S + D u, D = r d₁ + d₀, Z = S + d₁ f, with u = Σ φ_j
/// f_j/m.
struct LineArrays {
  PlanarVector propagate, deferred;
  AlignedVector inverse_mass, quadrature, compliance;
  PlanarVector left_gain, right_gain;
  std::vector<AlignedVector> shape;
  PlanarVector state;  ///< S
};

struct PointMotions {
  double velocity[kMostPoints];
  double displacement[kMostPoints];
};

/// S is the initial Z of the modes.
LineArrays make_line_arrays(const LineModes& modes, const SchemeWeights& weights);

/// S ← r S + D Σ φ_j f_j/m and the motion of every point that the new S makes.
void advance_line(LineArrays& arrays, const double* forces, PointMotions& motion);

/// Response of points and ends to the newest forces (d₁) of all points.
struct DirectResponse {
  double velocity[kMostPoints][kMostPoints] = {};
  double displacement[kMostPoints][kMostPoints] = {};
  double left[kMostPoints] = {}, right[kMostPoints] = {};
};
DirectResponse direct_response(const LineModes& modes, const SchemeWeights& weights);

}  // namespace modcal
