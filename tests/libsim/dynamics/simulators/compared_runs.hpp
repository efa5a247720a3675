// Event-driven runs and how they compare with each other and with the fixed-step scheme.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libsim/dynamics/event/modal_event.hpp"
#include "libsim/dynamics/fixed_step/fixed_step.hpp"

namespace modcal {

inline Simulation event_run(const Scene& scene, const ModalEvent::Options& options, double rate) {
  return ModalEvent(options).simulate(scene, rate, OutputRequest::all());
}

/// Relative L2 distance over the samples that both have.
inline double relative_error(const Signal& a, const Signal& b) {
  double error = 0.0, power = 0.0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    error += std::pow(a.samples[i] - b.samples[i], 2);
    power += std::pow(b.samples[i], 2);
  }
  return std::sqrt(error / power);
}

/// Of all five signals.
inline double worst_error(const Simulation& a, const Simulation& b) {
  return std::max({relative_error(a.displacement, b.displacement),
                   relative_error(a.velocity, b.velocity), relative_error(a.force, b.force),
                   relative_error(a.left_reaction, b.left_reaction),
                   relative_error(a.right_reaction, b.right_reaction)});
}

/// Expects the event-driven run to be what modal_exact approaches. Its switches stand on its grid,
/// late by a part of a step that differs from switch to switch, half a step in the mean: an error
/// of first order, A h. A comes from the fixed-step runs alone, as the largest ‖y_h − y_f‖/(h − f)
/// for h = 8 f, 4 f, 2 f. No switch is later than a whole step, twice the mean: the finest run lies
/// within 2 A f of the solution.
inline void expect_the_fixed_step_limit(const Scene& scene, double rate) {
  constexpr double kFinest = 1e-8;
  const Simulation event = event_run(scene, {}, rate);
  ASSERT_FALSE(event.diverged_at) << event.explanation;
  EXPECT_GT(event.attachments, 0u);
  const auto fixed = [&](double step) {
    return ModalExact({.time_step = step}).simulate(scene, rate, OutputRequest::all());
  };
  const Simulation finest = fixed(kFinest);
  EXPECT_EQ(finest.attachments, event.attachments);
  double growth = 0.0;
  for (const double factor : {8.0, 4.0, 2.0}) {
    growth = std::max(growth, worst_error(fixed(factor * kFinest), finest) / (factor - 1.0));
  }
  EXPECT_LT(worst_error(finest, event), 2.0 * growth);
  EXPECT_LT(growth, 2e-3);  // so that the bound says something
}

}  // namespace modcal
