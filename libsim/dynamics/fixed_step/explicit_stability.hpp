// Time steps that an explicit contact can take.
#pragma once

namespace modcal {

/// A contact as an explicit scheme sees it.
struct ExplicitContact {
  double stiffness = 0.0;  ///< K_a [N/m]
  double damping = 0.0;    ///< C_a [N s/m]
  double fall = 0.0;       ///< largest fall of the sliding force with the speed, max |g'| [N s/m]
  double response = 0.0;   ///< b, of the velocity to the newest force [m/(N s)]
};

/// Throws InvalidInput where the force of the steps before, which is all that an explicit scheme
/// knows, would feed energy into the contact: the lag turns spring and damper of adherence, and the
/// fall of the sliding force with the speed, into an excitation.
///
/// The string answers a force within a step h as a mass M = h/(2b). With v_{k+1} = v_k + b (f_k +
/// f_{k−1}), y by the trapezoidal rule and f = −K_a y − C_a v, c = b C_a and k = b K_a h/2, the
/// held mass obeys
///   λ³ + (c + k − 2) λ² + (1 + 2k) λ + k − c = 0,
/// whose roots lie inside the unit circle where |k − c| < 1 and c (1 − c) > k (2 − c) (Jury, 1964);
/// at critical damping that is h √(K_a/M) < 3 − √5. Sliding, b |g'| < 1/2 is asked for.
void require_stable_contact(const ExplicitContact& contact, double time_step);

}  // namespace modcal
