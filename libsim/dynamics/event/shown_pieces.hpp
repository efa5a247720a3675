// What a witness is shown of a step that the string was held on, or slid.
#pragma once

#include <cstddef>
#include <span>

#include "libsim/dynamics/event/force_witness.hpp"
#include "libsim/dynamics/event/sliding/sliding.hpp"
#include "libsim/dynamics/event/sticking.hpp"

namespace modcal::event {

/// The force on the held string from τ on for `time` [s]; `before`: its state at τ.
inline void show_held(Sticking& sticking, const PlanarVector& before, double tau, double time,
                      ForceWitness& witness) {
  const double least = 1e-15 * time;
  for (double from = 0.0; time - from > least;) {
    const auto piece = sticking.force_piece(before, tau, from, time - from);
    witness.saw({.phase = ContactPhase::kSticking,
                 .duration = piece.time,
                 .force = piece.force,
                 .drive = sticking.drive().from(tau + from)});
    from += piece.time;
  }
}

/// The force of the last step that slid, at whose start the bow's drive was `drive`.
template <typename Friction>
void show_slid(Sliding<Friction>& sliding, const BowDrive& drive, ForceWitness& witness) {
  const auto step = sliding.last_step();
  witness.saw({.phase = ContactPhase::kSliding,
               .duration = step.duration,
               .force = std::span(step.force).first(step.powers),
               .drive = drive,
               .side = sliding.side(),
               .rise = sliding.friction().rise_powers()});
}

}  // namespace modcal::event
