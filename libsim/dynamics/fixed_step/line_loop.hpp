// General fixed-step loop: several contact points, a bow of any motion, friction with a state. What
// the steady point contact needs is in step_loop.hpp, which stays as fast as that case allows.
//
// One step is Z_{k+1} = r Z_k + Σ_j (φ_j/m)(d₀ f_j,old + d₁ f_j,new) as there, with the forces of
// all points solved for together (implicit) or known (explicit).
#pragma once

#include "libsim/dynamics/fixed_step/step_loop.hpp"
#include "libsim/dynamics/scene/contact_modes.hpp"

namespace modcal {

/// The contact of any bow: `friction` and `parameters` belong to all points together, which share
/// them alike.
struct GeneralContact {
  ContactParameters parameters;
  const FrictionLaw& friction;
  const BowMotion& bow;
};

/// Runs all steps, sample 0 included. Displacement and velocity are the means over the points, the
/// force is their sum.
LoopCounts run_line_loop(const FixedStepRun& run, const GeneralContact& contact,
                         const LineModes& modes, const SchemeWeights& weights);

/// Largest response of the velocity of a point to the newest force, shared by the points alike or
/// with any signs [m/(N s)]: no pattern of the points answers more.
double contact_response(const LineModes& modes, const SchemeWeights& weights);

}  // namespace modcal
