#include "libsim/dynamics/event/event_start.hpp"

#include <utility>

#include "libsim/base/error.hpp"
#include "libsim/dynamics/event/sample_writer.hpp"

namespace modcal::event {
namespace {

constexpr double kMaxPhase = 1e4;

ClosedLoop closed_loop_for(const EventLoop& loop, const ContactModes& modes) {
  const ContactParameters& contact = loop.contact;
  auto closed = make_closed_loop(modes, contact.stiffness, contact.damping);
  MODCAL_REQUIRE(closed.has_value(),
                 "adherence of {:g} N/m and {:g} N s/m gives the held string a double root, which "
                 "its exact propagator cannot resolve; change the damping slightly",
                 contact.stiffness, contact.damping);
  MODCAL_REQUIRE(closed->largest_pole * loop.grid_step <= kMaxPhase,
                 "adherence of {:g} N/m and {:g} N s/m has a pole of {:g} 1/s: more than {:g} "
                 "radians in a step of {:g} s; shorten the step or soften the contact",
                 contact.stiffness, contact.damping, closed->largest_pole, kMaxPhase,
                 loop.grid_step);
  return std::move(*closed);
}

}  // namespace

std::optional<Sticking> held_string(const EventLoop& loop, const ContactModes& modes) {
  if (!(loop.contact.static_limit > 0.0)) return std::nullopt;
  return Sticking(
      closed_loop_for(loop, modes),
      loop.thermal ? StaticLimit(*loop.thermal) : StaticLimit(loop.contact.static_limit),
      loop.grid_step, SampleWriter(loop.targets).wanted());
}

std::vector<BowKnot> bow_knots(const EventLoop& loop) {
  if (!loop.bow.empty()) return loop.bow;
  return {{.time = 0.0, .velocity = loop.contact.bow_velocity, .load = 1.0}};
}

EventState initial_state(const ContactModes& modes, double bow_velocity) {
  EventState state;
  state.modes = PlanarVector(modes.size());
  double velocity = 0.0;
  for (std::size_t n = 0; n < modes.size(); ++n) {
    state.modes.set(n, modes.initial[n]);
    velocity += modes.initial[n].real() - modes.quadrature[n] * modes.initial[n].imag();
  }
  state.sticking = velocity == bow_velocity;
  state.side = velocity < bow_velocity ? -1.0 : 1.0;
  return state;
}

}  // namespace modcal::event
