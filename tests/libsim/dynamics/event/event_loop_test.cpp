#include "libsim/dynamics/event/event_loop.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "libsim/dynamics/event/sticking.hpp"
#include "libsim/dynamics/scene/contact_modes.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal::event::event_loop_test {
namespace {

constexpr double kStep = 1.0 / 51200.0;

ContactModes modes_of(const Scene& scene) {
  return contact_modes(make_modal_basis(scene.string), scene.bow.position, scene.initial);
}

EventLoop loop_for(const Scene& scene, const ContactModes& modes, std::size_t samples) {
  const auto friction = scene.friction.make();
  return {.contact = contact_parameters(bow_motion(scene.bow, scene.duration), *friction,
                                        modes.effective_mass()),
          .law = friction->sliding(scene.bow.normal_force),
          .grid_step = kStep,
          .samples = samples};
}

double distance(const PlanarVector& a, const PlanarVector& b) {
  double error = 0.0, size = 0.0;
  for (std::size_t n = 0; n < a.size(); ++n) {
    error += std::norm(a.at(n) - b.at(n));
    size += std::norm(b.at(n));
  }
  return std::sqrt(error / size);
}

TEST(EventLoop, GoesOnFromWhereItStopped) {
  const Scene scene = paper_scene();
  const ContactModes modes = modes_of(scene);
  for (const std::size_t first : {7u, 100u, 180u, 331u}) {
    EventState whole = initial_state(modes, scene.bow.velocity);
    const EventCounts all = run_event_loop(loop_for(scene, modes, 513), modes, whole);
    EventState parts = initial_state(modes, scene.bow.velocity);
    const EventCounts a = run_event_loop(loop_for(scene, modes, first + 1), modes, parts);
    const EventCounts b = run_event_loop(loop_for(scene, modes, 513 - first), modes, parts);
    ASSERT_FALSE(all.failure || a.failure || b.failure);
    EXPECT_EQ(all.attachments, a.attachments + b.attachments);
    EXPECT_EQ(all.releases, a.releases + b.releases);
    // Rounding of the change of coordinates at the joint (1e-15), amplified by the contact's
    // sensitivity, below 1e4 over 10 ms.
    EXPECT_LT(distance(parts.modes, whole.modes), 1e-11) << first;
  }
}

TEST(EventLoop, WorkOfTheContactIsTheEnergyOfTheUndampedString) {
  Scene scene = paper_scene();
  const ModalBasis basis = [&] {
    ModalBasis result = make_modal_basis(scene.string);
    for (double& zeta : result.zeta) zeta = 0.0;
    return result;
  }();
  const ContactModes modes = contact_modes(basis, scene.bow.position, {});
  const std::size_t samples = 20001;
  EventLoop loop = loop_for(scene, modes, samples);
  loop.grid_step = 1e-6;
  std::vector<double> force(samples), velocity(samples);
  loop.targets.force = force.data();
  loop.targets.velocity = velocity.data();
  EventState state = initial_state(modes, scene.bow.velocity);
  const EventCounts counts = run_event_loop(loop, modes, state);
  ASSERT_FALSE(counts.failure);
  ASSERT_GT(counts.attachments, 10u);
  // Energy of a mode ½ m (q̇² + ω²q²) = |Z|²/(2 φ²/m).
  double energy = 0.0, work = 0.0;
  for (std::size_t n = 0; n < modes.size(); ++n) {
    energy += std::norm(state.modes.at(n)) / (2.0 * modes.drive[n]);
  }
  for (std::size_t k = 0; k + 1 < samples; ++k) {
    work += 0.5e-6 * (force[k] * velocity[k] + force[k + 1] * velocity[k + 1]);
  }
  // The trapezoidal rule misses at most half a step of the force's jump (0.4 N) times the speed
  // there (0.1 m/s) at every switch, and its own (ω_max Δt)²/12 = 3e-4 of the reactive power, which
  // swings about zero.
  const double jumps =
      0.5e-6 * 0.4 * 0.1 * static_cast<double>(counts.attachments + counts.releases);
  EXPECT_NEAR(work, energy, jumps + 3e-4 * energy);
  EXPECT_GT(energy, 20.0 * jumps);  // the bound says something
}

TEST(EventLoop, WithoutNormalForceTheStringIsFree) {
  Scene scene = paper_scene();
  scene.bow.normal_force = 0.0;
  scene.initial.displacement.assign(50, 0.0);
  scene.initial.velocity.assign(50, 0.0);
  scene.initial.displacement[0] = 1e-3;
  scene.initial.velocity[4] = 0.1;
  const ContactModes modes = modes_of(scene);
  EventState state = initial_state(modes, scene.bow.velocity);
  const EventCounts counts = run_event_loop(loop_for(scene, modes, 1025), modes, state);
  EXPECT_EQ(counts.attachments + counts.releases, 0u);
  for (const std::size_t n : {0u, 4u}) {
    const auto expected = modes.initial[n] * std::exp(modes.pole[n] * (1024.0 * kStep));
    // 1024 products of a few roundings each.
    EXPECT_LT(std::abs(state.modes.at(n) - expected), 1024 * 4e-16 * std::abs(expected));
  }
}

// f' = −K_a v_c − C_a a_c is positive at v_c > 0 when a_c < −v_c K_a/C_a: the spring lets go at
// f = +limit, as if the string fell behind the bow, while it still runs ahead.
TEST(EventLoop, AReleaseAgainstTheSlipSlidesTheWayTheStringMoves) {
  Scene scene = paper_scene();
  scene.bow.velocity = 0.0;
  const ContactModes modes = modes_of(scene);
  EventLoop loop = loop_for(scene, modes, 2);
  loop.grid_step = 2e-7;
  loop.contact.static_limit = 1e-3;
  loop.law = ExponentialSliding{.dynamic_force = 5e-4, .force_drop = 5e-4, .decay = 5.0};
  EventState state;
  state.modes = PlanarVector(modes.size());
  double velocity = 0.0, acceleration = 0.0;
  for (std::size_t n = 0; n < modes.size(); ++n) {
    const auto share = 1.0 / static_cast<double>(modes.size());
    const std::complex<double> z{2e-4 * share, 100.0 / modes.pole[n].imag() * share};
    state.modes.set(n, z);
    velocity += z.real() - modes.quadrature[n] * z.imag();
    acceleration += (std::complex<double>(1.0, modes.quadrature[n]) * modes.pole[n] * z).real();
  }
  state.sticking = true;
  const double start = 0.99e-3;  // f at t = 0: 1e-5 N below the limit, 0.1 µs of the force's rise
  state.elongation = -(start + loop.contact.damping * velocity) / loop.contact.stiffness;
  acceleration += start / modes.effective_mass();
  ASSERT_GT(velocity, 0.0);
  ASSERT_LT(acceleration, -velocity * loop.contact.stiffness / loop.contact.damping);
  std::vector<double> force(2), v(2);
  loop.targets.force = force.data();
  loop.targets.velocity = v.data();
  const EventCounts counts = run_event_loop(loop, modes, state);
  ASSERT_FALSE(counts.failure) << *counts.failure;
  EXPECT_NEAR(force[0], start, 1e-12);
  EXPECT_EQ(counts.releases, 1u);
  EXPECT_EQ(counts.wrong_sign_releases, 1u);
  EXPECT_GT(v[1], 0.0);
  EXPECT_NEAR(force[1], -1e-3, 1e-6);  // friction against the motion: −g(v) with C v = 1e-3
}

// Stronger friction while sliding than while sticking is no friction law: at v_c = 0 the contact
// can neither hold nor slide. Caught, released at 1 nN, caught again within femtoseconds.
TEST(EventLoop, SaysSoWhenTheContactChatters) {
  const Scene scene = paper_scene();
  const ContactModes modes = modes_of(scene);
  EventLoop loop = loop_for(scene, modes, 2000);
  loop.contact.static_limit = 1e-9;
  EventState state = initial_state(modes, scene.bow.velocity);
  const EventCounts counts = run_event_loop(loop, modes, state);
  ASSERT_TRUE(counts.failure.has_value());
  EXPECT_NE(counts.failure->find("chatter"), std::string::npos) << *counts.failure;
  EXPECT_GT(counts.failed_at, 0.0);
  EXPECT_LT(counts.failed_at, 2000 * kStep);
}

// One mode and next to no friction: v_c rises to a maximum that just misses or just passes the
// bow's velocity, at 0.37 of a step.
TEST(EventLoop, TellsAGrazingContactFromAMiss) {
  Scene scene = paper_scene();
  scene.string.modes = 1;
  scene.bow.position = 0.165;
  const ContactModes modes = modes_of(scene);
  EventLoop loop = loop_for(scene, modes, 2);
  loop.law = ExponentialSliding{.dynamic_force = 1e-30, .force_drop = 0.0, .decay = 0.0};
  loop.contact.static_limit = 1e-30;
  // v = Re A e^{λt}, A = (1 + iκ) Z, has its maximum where tan(arg A + ω_d t) = Re λ/ω_d.
  const std::complex<double> pole = modes.pole[0];
  const double at_maximum = std::atan(pole.real() / pole.imag());
  const double time = 0.37 * kStep;
  const std::complex<double> amplitude = std::polar(1.0, at_maximum - pole.imag() * time);
  const double highest = std::exp(pole.real() * time) * std::cos(at_maximum);
  for (const double above : {-1e-9, -1e-12, 1e-12, 1e-9}) {
    EventState state = initial_state(modes, 0.0);
    state.side = -1.0;
    state.sticking = false;
    state.modes.set(0, amplitude / std::complex<double>(1.0, modes.quadrature[0]));
    loop.contact.bow_velocity = highest - above;
    const EventCounts counts = run_event_loop(loop, modes, state);
    ASSERT_FALSE(counts.failure);
    // v rounds to a few 1e-16. A passing string is caught on its way up and on its way down (and,
    // so close to rest, perhaps more than once each time).
    if (above < 0.0) {
      EXPECT_EQ(counts.attachments, 0u) << above;
    } else {
      EXPECT_GE(counts.attachments, 2u) << above;
    }
  }
}

// The force of the held string passes its limit for less than a microsecond between the ends of a
// step; ends and slopes alone look safe.
TEST(Sticking, DoesNotMissAnExcursionBetweenStepEnds) {
  const Scene scene = paper_scene();
  const ContactModes modes = modes_of(scene);
  const EventLoop loop = loop_for(scene, modes, 2);
  PlanarVector state(modes.size());
  double velocity = 0.0;
  for (std::size_t n = 0; n < modes.size(); ++n) {
    const auto k = static_cast<double>(n);
    state.set(n, {0.001 * std::cos(k), 0.001 * std::sin(1.7 * k)});
    velocity += state.re[n] - modes.quadrature[n] * state.im[n];
  }
  state.re[0] += 0.1 - velocity;  // moves with the bow: the force starts at 0
  const auto sticking = [&](double limit, double step) {
    auto closed = make_closed_loop(modes, loop.contact.stiffness, loop.contact.damping);
    Sticking result(std::move(*closed), StaticLimit(limit), step, {});
    result.attach({.velocity = 0.1}, state, 0.0, 0.0);
    return result;
  };
  // The first maximum of |f| after 50 µs, on a grid of 10 ns.
  Sticking free = sticking(1e9, 1e-8);
  std::vector<double> force;
  for (int k = 0; k < 100000; ++k) {
    free.advance(k * 1e-8, 1e-8, false);
    force.push_back(std::abs(free.force()));
  }
  const double before = *std::max_element(force.begin(), force.begin() + 5000);
  std::size_t peak = 5000;
  while (!(force[peak] > 1.01 * before && force[peak] > force[peak + 1])) ++peak;
  const double limit = force[peak] * (1.0 - 1e-5);
  const auto release = [&](double step) {
    Sticking held = sticking(limit, step);
    for (double tau = 0.0; tau < 1e-3;) {
      const auto result = held.advance(tau, step, false);
      tau += result.time;
      if (result.released) return tau;
    }
    return -1.0;
  };
  const double fine = release(1e-7);
  ASSERT_NEAR(fine, static_cast<double>(peak) * 1e-8, 2e-6);
  for (const double step : {1e-6, 2e-5, 2e-4, 2e-3}) {
    // The root of one function, to its rounding (1e-16 of a few N summed) over its slope there,
    // which 1e-5 below the peak is at least 1e-5 · limit/1 µs.
    EXPECT_NEAR(release(step), fine, 1e-14 / (1e-5 * limit / 1e-6)) << step;
  }
}

TEST(Sticking, ReleasesExactlyAtTheLimit) {
  const Scene scene = paper_scene();
  const ContactModes modes = modes_of(scene);
  const EventLoop loop = loop_for(scene, modes, 2);
  auto closed = make_closed_loop(modes, loop.contact.stiffness, loop.contact.damping);
  Sticking sticking(std::move(*closed), StaticLimit(0.4), kStep, {});
  sticking.attach({.velocity = 0.1}, PlanarVector(modes.size()), 0.0,
                  0.0);  // at rest, gripped by the moving bow
  double tau = 0.0;
  for (int k = 0; k < 10000; ++k) {
    const auto result = sticking.advance(tau, kStep, false);
    tau += result.time;
    if (result.released) break;
  }
  EXPECT_NEAR(sticking.force(), 0.4, 4e-15);
}

}  // namespace
}  // namespace modcal::event::event_loop_test
