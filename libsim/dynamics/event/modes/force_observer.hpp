// Who wants to see every piece of the contact force that the event-driven integrator lets act.
#pragma once

#include <span>

#include "libsim/dynamics/event/modes/bow_path.hpp"

namespace modcal::event {

enum class ContactPhase { kFree, kSliding, kSticking };

/// A stretch of the solution: the force that drove the string on it, f(θ) = Σ_k force[k] θ^k, θ = 1
/// at its end.
struct ForcePiece {
  ContactPhase phase = ContactPhase::kFree;
  double duration = 0.0;          ///< [s]
  std::span<const double> force;  ///< [N]; none: no contact
  BowDrive drive;                 ///< τ = 0 at the start of the piece
  double side = 0.0;              ///< sgn v_c, while sliding
  std::span<const double> rise;   ///< powers of the temperature rise, while sliding [K]
};

/// Pieces follow each other without a gap from t = 0 on.
class ForceObserver {
 public:
  virtual ~ForceObserver() = default;
  virtual void piece(const ForcePiece& piece) = 0;
  /// The string sticks from here on, the spring being stretched by `elongation` [m].
  virtual void attached(double elongation) = 0;
  /// The spring is let go.
  virtual void released() = 0;
};

}  // namespace modcal::event
