// The ideal motion of a bowed string.
#pragma once

#include "libsim/dynamics/scene/scene.hpp"
#include "libsim/model/modal_basis.hpp"

namespace modcal {

/// Helmholtz motion with the bow velocity v_b [m/s] at the contact x_c [m], in the middle of its
/// stick phase: the corner is at the far end, the string is straight and turns about the near one,
/// q_n = 0, q̇_n = ±2 v_b/(β nπ) (x_c = βL: (−1)^{n+1}; x_c = L − βL: +), β ≤ 1/2 (Helmholtz, 1863;
/// Schelleng, 1973). Modes with a node at the contact are at rest: no bow there keeps them up.
ModalState helmholtz_motion(const ModalBasis& basis, double contact, double bow_velocity);

/// Distance of the contact from the nearer end over the length, β in (0, 1/2].
double relative_bow_position(double contact, double length);

/// Standard deviation over time of the contact's velocity in ideal Helmholtz motion,
/// v_b √((1 − β)/β) [m/s].
double helmholtz_velocity_rms(double relative_position, double bow_velocity);

}  // namespace modcal
