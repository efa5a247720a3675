// A bow whose velocity and force go with time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "libsim/dynamics/event/event_loop.hpp"
#include "libsim/dynamics/scene/contact_modes.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"
#include "tests/libsim/dynamics/simulators/long_double_twin.hpp"

namespace modcal::event::gesture_test {
namespace {

constexpr double kStep = 2e-5;
constexpr double kStiffness = 1e5;

// Rises, falls, lifts the bow between 5 and 5.5 ms, reverses it after 6.4 ms; no knot but the
// first on the grid of 20 µs, all of them on one of 50 ns.
const std::vector<BowKnot> kStroke = {
    {0.0, 0.02, 0.2},     {1.00005e-3, 0.2, 0.4},  {3.01315e-3, 0.12, 0.2}, {5.00005e-3, 0.1, 0.0},
    {5.50095e-3, 0.1, 0}, {6.00035e-3, 0.08, 0.3}, {7.20005e-3, -0.1, 0.4}};

struct String {
  ModalBasis basis;
  ContactModes modes;
};
String string_of(std::int64_t modes, double damping = 1e-3) {
  Scene scene = paper_scene();
  scene.string.modes = modes;
  String string{make_modal_basis(scene.string), {}};
  std::fill(string.basis.zeta.begin(), string.basis.zeta.end(), damping);
  string.modes = contact_modes(string.basis, scene.bow.position, {});
  return string;
}

// Paper's friction at 1 N: load is the normal force in N.
EventLoop loop_for(const String& string, std::size_t samples, std::vector<BowKnot> bow) {
  return {.contact = {.bow_velocity = 0.0,
                      .static_limit = 0.4,
                      .stiffness = kStiffness,
                      .damping = 2.0 * std::sqrt(kStiffness * string.modes.effective_mass())},
          .law = ExponentialSliding{.dynamic_force = 0.2, .force_drop = 0.2, .decay = 5.0},
          .bow = std::move(bow),
          .grid_step = kStep,
          .samples = samples};
}

struct Record {
  std::vector<double> y, v, f;
  EventCounts counts;
  EventState state;
};
Record record(const String& string, EventLoop loop, EventState state) {
  Record result;
  for (auto* signal : {&result.y, &result.v, &result.f}) signal->resize(loop.samples);
  loop.targets = {
      .displacement = result.y.data(), .velocity = result.v.data(), .force = result.f.data()};
  result.counts = run_event_loop(loop, string.modes, state);
  result.state = std::move(state);
  return result;
}
Record record(const String& string, const EventLoop& loop) {
  return record(string, loop, initial_state(string.modes, loop.bow.front().velocity));
}

double relative_error(const std::vector<double>& a, const std::vector<double>& b) {
  double error = 0.0, size = 0.0;
  for (std::size_t k = 0; k < b.size(); ++k) {
    error += std::pow(a[k] - b[k], 2);
    size += b[k] * b[k];
  }
  return std::sqrt(error / size);
}

// Linear interpolation of the knots, and its integral, in extended precision.
long double interpolated(double BowKnot::*value, long double t) {
  for (std::size_t i = 0; i + 1 < kStroke.size(); ++i) {
    const long double from = kStroke[i].time, to = kStroke[i + 1].time;
    if (t >= to) continue;
    return kStroke[i].*value +
           (kStroke[i + 1].*value - static_cast<long double>(kStroke[i].*value)) * (t - from) /
               (to - from);
  }
  return kStroke.back().*value;
}
long double travel(long double t) {
  long double sum = 0.0L, from = 0.0L;
  for (std::size_t i = 1; i <= kStroke.size(); ++i) {
    const long double to = i < kStroke.size() ? std::min<long double>(t, kStroke[i].time) : t;
    if (to <= from) break;
    sum += 0.5L * (to - from) *
           (interpolated(&BowKnot::velocity, from) + interpolated(&BowKnot::velocity, to));
    from = to;
  }
  return sum;
}

TEST(BowGesture, FollowsTheExtendedPrecisionTwin) {
  const String string = string_of(10);
  const EventLoop loop = loop_for(string, 451, kStroke);
  const Record run = record(string, loop);
  ASSERT_FALSE(run.counts.failure) << *run.counts.failure;
  Scene scene = paper_scene();
  LongDoubleTwin twin(
      string.basis, scene.bow.position,
      {.velocity = 1.0L,
       .dynamic_force = 0.2,
       .force_drop = 0.2,
       .decay = 5.0,
       .stiffness = kStiffness,
       .damping = loop.contact.damping,
       .velocity_factor = [](long double t) { return interpolated(&BowKnot::velocity, t); },
       .load = [](long double t) { return interpolated(&BowKnot::load, t); },
       .travel_factor = travel});
  double error_v = 0.0, error_f = 0.0, error_y = 0.0;
  for (std::size_t k = 0; k < run.v.size(); ++k) {
    error_v = std::max(error_v, std::abs(static_cast<double>(twin.velocity()) - run.v[k]));
    if (twin.load() > 0.0L) {
      error_f = std::max(error_f, std::abs(static_cast<double>(twin.force()) - run.f[k]));
    }
    error_y = std::max(error_y, std::abs(static_cast<double>(twin.displacement()) - run.y[k]));
    for (int i = 0; i < 400; ++i) twin.step(5e-8L);
  }
  EXPECT_GT(twin.switches(), 5);
  EXPECT_EQ(run.counts.attachments + run.counts.releases,
            static_cast<std::size_t>(twin.switches()));
  // The twin's own error (fourth order, 50 ns): 5e-12 of 0.3 m/s and 0.2 N; rounding is below that.
  EXPECT_LT(error_v, 2e-12);
  EXPECT_LT(error_f, 2e-12);
  EXPECT_LT(error_y, 2e-12 * 3e-4);
}

// Between the same end points a knot changes nothing but where steps end.
TEST(BowGesture, KnotsOnAStraightLineChangeNothing) {
  const String string = string_of(50);
  const std::vector<BowKnot> line = {{0.0, 0.05, 0.5}, {0.02, 0.15, 1.5}};
  std::vector<BowKnot> dotted;
  for (int i = 0; i <= 400; ++i) {
    const double share = i / 400.0;
    dotted.push_back({0.02 * share, 0.05 + 0.1 * share, 0.5 + share});
  }
  const auto run = [&](const std::vector<BowKnot>& bow) {
    EventLoop loop = loop_for(string, 1001, bow);
    loop.grid_step = kStep / 8.0;
    loop.steps_per_sample = 8;
    return record(string, loop);
  };
  const Record whole = run(line), parts = run(dotted);
  ASSERT_FALSE(whole.counts.failure || parts.counts.failure);
  EXPECT_GT(whole.counts.releases, 8u);
  EXPECT_EQ(whole.counts.releases, parts.counts.releases);
  // Steps of 2.5 µs or less: rounding (1e-15) times the contact's sensitivity, below 1e4.
  EXPECT_LT(relative_error(parts.v, whole.v), 1e-11);
  EXPECT_LT(relative_error(parts.f, whole.f), 1e-11);
}

TEST(BowGesture, GoesOnFromWhereItStopped) {
  const String string = string_of(50);
  const Record whole = record(string, loop_for(string, 401, kStroke));
  for (const std::size_t first : {20u, 151u, 262u, 330u}) {
    const Record a = record(string, loop_for(string, first + 1, kStroke));
    std::vector<BowKnot> rest = kStroke;
    for (BowKnot& knot : rest) knot.time -= static_cast<double>(first) * kStep;
    const Record b = record(string, loop_for(string, 401 - first, rest), a.state);
    ASSERT_FALSE(a.counts.failure || b.counts.failure);
    EXPECT_EQ(whole.counts.attachments, a.counts.attachments + b.counts.attachments);
    const std::vector<double> expected(whole.v.begin() + static_cast<long>(first), whole.v.end());
    EXPECT_LT(relative_error(b.v, expected), 1e-11) << first;
  }
}

TEST(BowGesture, KeepsTheOrderOfTheNodes) {
  const String string = string_of(50);
  const auto run = [&](int nodes, double step) {
    EventLoop loop = loop_for(string, 401, kStroke);
    loop.nodes = nodes;
    loop.slope_number = 0.7 * step / kStep;
    loop.grid_step = step;
    loop.steps_per_sample = static_cast<std::size_t>(std::lround(kStep / step));
    return record(string, loop);
  };
  const Record reference = run(5, kStep / 20.0);
  for (int nodes = 2; nodes <= 5; ++nodes) {
    const double step = nodes < 4 ? kStep / 8.0 : kStep;
    const Record coarse = run(nodes, step), fine = run(nodes, step / 2.0);
    EXPECT_EQ(coarse.counts.releases, reference.counts.releases);
    EXPECT_NEAR(
        std::log2(relative_error(coarse.v, reference.v) / relative_error(fine.v, reference.v)),
        2.0 * (nodes - 1), 0.3)
        << nodes << " nodes";
  }
}

// Work of the contact force = dissipation + stored energy, whatever the bow does.
TEST(BowGesture, EnergyBalances) {
  const String string = string_of(1, 0.02);
  EventLoop loop = loop_for(string, 400001, kStroke);
  loop.grid_step = 2e-8;
  const Record run = record(string, loop);
  ASSERT_FALSE(run.counts.failure);
  const ModalBasis& basis = string.basis;
  const double phi = basis.shape_at(0.03)[0], mass = basis.mass[0] / (phi * phi);
  const double w = basis.omega[0];
  double work = 0.0, lost = 0.0, gross = 0.0;
  for (std::size_t k = 0; k + 1 < run.v.size(); ++k) {
    const double before = run.f[k] * run.v[k], after = run.f[k + 1] * run.v[k + 1];
    work += 0.5 * loop.grid_step * (before + after);
    gross += loop.grid_step * std::abs(before);
    lost += loop.grid_step * 0.02 * w * mass * (run.v[k] * run.v[k] + run.v[k + 1] * run.v[k + 1]);
  }
  const double y = run.y.back(), v = run.v.back();
  const double stored = 0.5 * mass * (v * v + w * w * y * y);
  // The trapezoidal rule misses at most half a step of the jump of f v at each switch.
  const double missed = static_cast<double>(run.counts.attachments + run.counts.releases) * 0.5 *
                        loop.grid_step * 0.44 * 0.15;
  EXPECT_NEAR(work, lost + stored, missed + 1e-6 * gross);
  EXPECT_GT(lost, 10.0 * missed);
}

TEST(BowGesture, ALiftedBowLeavesTheExactDecay) {
  const String string = string_of(20);
  const double lifted = 3.00507e-3;
  const Record run = record(
      string, loop_for(string, 501, {{0.0, 0.1, 1.0}, {2.90507e-3, 0.1, 1.0}, {lifted, 0.1, 0.0}}));
  ASSERT_FALSE(run.counts.failure);
  // Two samples of all modes determine nothing, but the first free sample's state does: the state
  // of the end, carried back, gives every sample since.
  for (std::size_t k = 151; k < run.v.size(); ++k) {
    const double back = static_cast<double>(run.v.size() - 1 - k) * kStep;
    double y = 0.0, size = 0.0;
    for (std::size_t n = 0; n < string.modes.size(); ++n) {
      const auto z = run.state.modes.at(n) * std::exp(-string.modes.pole[n] * back);
      y += string.modes.compliance[n] * z.imag();
      size += string.modes.compliance[n] * std::abs(z);
    }
    ASSERT_NEAR(run.y[k], y, 350 * 4e-16 * size) << k;
    ASSERT_EQ(run.f[k], 0.0);
  }
}

// A bow that only bends a held string and comes back: no switch, and the force is the spring's.
TEST(BowGesture, ASlowBowIsFollowedQuasiStatically) {
  const String string = string_of(50, 0.2);
  const Record run = record(
      string, loop_for(string, 50001, {{0.0, 0.0, 1.0}, {0.5, 1e-4, 1.0}, {1.0, 1e-4, 1.0}}));
  EXPECT_EQ(run.counts.releases, 0u);
  // y_c = −f/K and y = S f follow the travel ½·1e-4·0.5 + … within the string's settling time
  // times its rate, (0.2·1231)⁻¹ s · 1e-4 m/s.
  double compliance = 0.0;
  for (std::size_t n = 0; n < string.modes.size(); ++n) {
    compliance += string.modes.compliance[n] * string.modes.drive[n] * string.modes.pole[n].imag() /
                  std::norm(string.modes.pole[n]);
  }
  const double travel = 0.5 * 0.5 * 1e-4 + 0.5 * 1e-4;
  const double expected = travel / (compliance + 1.0 / kStiffness);
  EXPECT_NEAR(run.f.back(), expected, 1e-4 / (0.2 * 1231.0) / compliance);
}

}  // namespace
}  // namespace modcal::event::gesture_test
