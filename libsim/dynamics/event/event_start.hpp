// What a run of the event-driven loop starts with.
#pragma once

#include <optional>
#include <vector>

#include "libsim/dynamics/event/modes/bow_path.hpp"
#include "libsim/dynamics/event/event_loop.hpp"
#include "libsim/dynamics/event/sticking.hpp"

namespace modcal::event {

/// The string held by the bow; none where the bow cannot carry any force: it is not there, without
/// contact and switches. Throws InvalidInput as run_event_loop() does.
std::optional<Sticking> held_string(const EventLoop& loop, const ContactModes& modes);

/// The bow's motion, a steady one as well.
std::vector<BowKnot> bow_knots(const EventLoop& loop);

}  // namespace modcal::event
