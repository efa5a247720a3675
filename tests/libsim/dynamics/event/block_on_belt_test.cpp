// Stick–slip of one mode against its closed form.
#include "tests/libsim/dynamics/block_on_belt.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "libsim/dynamics/event/event_loop.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal::event::block_on_belt_test {
namespace {

TEST(EventLoop, OneModeIsTheBlockOnABelt) {
  Scene scene = paper_scene();
  scene.string.modes = 1;
  ModalBasis basis = make_modal_basis(scene.string);
  basis.zeta[0] = 0.0;
  const ContactModes modes = contact_modes(basis, 0.165, {});
  for (const AttachRule rule : {AttachRule::kLiteral, AttachRule::kContinuous}) {
    for (const double damping : {0.0, 0.05}) {
      const std::size_t samples = 5121;
      std::vector<double> y(samples), v(samples);
      EventState state = initial_state(modes, 0.05);
      const EventCounts counts = run_event_loop(
          {.contact =
               {.bow_velocity = 0.05, .static_limit = 0.4, .stiffness = 1e4, .damping = damping},
           .law = ExponentialSliding{.dynamic_force = 0.3},
           .attach = rule,
           .grid_step = 1.0 / 51200.0,
           .samples = samples,
           .targets = {.displacement = y.data(), .velocity = v.data()}},
          modes, state);
      ASSERT_FALSE(counts.failure) << *counts.failure;
      const double stretched = rule == AttachRule::kContinuous ? -0.3 / 1e4 : 0.0;
      BlockOnBelt block(basis.mass[0], basis.omega[0], 0.4, 0.3, 1e4, damping, 0.05, stretched);
      double error = 0.0, error_y = 0.0;
      for (std::size_t k = 0; k < samples; ++k) {
        const auto point = block.at(static_cast<double>(k) / 51200.0);
        error = std::max(error, std::abs(point.v - v[k]));
        error_y = std::max(error_y, std::abs(point.y - y[k]));
      }
      EXPECT_GE(block.switches(), 4);
      EXPECT_EQ(counts.attachments + counts.releases, static_cast<std::size_t>(block.switches()));
      // Both are exact between switches, 1e-16 a step. A release carries an error of y over as
      // one of v: (F_S − F_D)/m · K/f' · δy with f' ≥ mω²v_b of the slow drag, 40 times ω δy; the
      // next sticking forgets most of it. Two such factors are allowed on 5000 steps of rounding.
      EXPECT_LT(error, 40 * 40 * 5000 * 1e-16 * 0.1);
      EXPECT_LT(error_y, 40 * 40 * 5000 * 1e-16 * 0.1 / basis.omega[0]);
    }
  }
}

}  // namespace
}  // namespace modcal::event::block_on_belt_test
