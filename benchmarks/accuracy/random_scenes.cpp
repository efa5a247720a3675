// Stress of the event-driven integrator: scenes drawn at random, error over 20 ms at the default
// step against a step of 2 µs, both attachment rules. A scene whose error exceeds 1e-3 is run again
// with 1e-12 m/s more on every modal velocity: where that changes the motion by more than 1e-4 it
// has no digits to hold. Exits with 1 where a run fails or any other scene errs by more than 1e-3.
//
//     random_scenes [count = 150]
#include "tests/libsim/dynamics/random_scenes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "libsim/dynamics/event/modal_event.hpp"

namespace modcal {
namespace {

constexpr double kRate = 51200.0;

double worst_error(const Simulation& run, const Simulation& reference) {
  double worst = 0.0;
  for (const auto signal : {&Simulation::displacement, &Simulation::velocity, &Simulation::force,
                            &Simulation::left_reaction, &Simulation::right_reaction}) {
    double error = 0.0, power = 0.0;
    const auto& expected = (reference.*signal).samples;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      error += std::pow((run.*signal).samples[i] - expected[i], 2);
      power += std::pow(expected[i], 2);
    }
    worst = std::max(worst, std::sqrt(error / power));
  }
  return worst;
}

bool holds(const char* rule, int count) {
  std::vector<double> errors;
  int failures = 0, missed = 0, sensitive = 0;
  for (int seed = 1; seed <= count; ++seed) {
    Scene scene = random_scene(static_cast<std::uint64_t>(seed));
    scene.duration = 0.02;
    const auto run = [&](const ModalEvent::Options& options) {
      return ModalEvent(options).simulate(scene, kRate, OutputRequest::all());
    };
    const ModalEvent::Options fine{.max_step = 2e-6, .slope_number = 0.1, .attach = rule};
    const Simulation result = run({.attach = rule}), reference = run(fine);
    if (result.diverged_at || reference.diverged_at) {
      ++failures;
      fmt::print("{} seed {}: {}{}\n", rule, seed, result.explanation, reference.explanation);
      continue;
    }
    errors.push_back(worst_error(result, reference));
    if (!(errors.back() <= 1e-3)) {
      scene.initial.velocity.assign(static_cast<std::size_t>(scene.string.modes), 1e-12);
      scene.initial.displacement.assign(scene.initial.velocity.size(), 0.0);
      const double moved = worst_error(run(fine), reference);
      (moved > 1e-4 ? sensitive : missed) += 1;
      fmt::print("{} seed {}: error {:.1e}, {} and {} attachments; 1e-12 m/s change it by {:.1e}\n",
                 rule, seed, errors.back(), result.attachments, reference.attachments, moved);
    }
  }
  std::sort(errors.begin(), errors.end());
  fmt::print(
      "{}: {} scenes, {} failed, {} above 1e-3 and {} that have no digits; error median "
      "{:.1e}, largest {:.1e}\n",
      rule, count, failures, missed, sensitive, errors.empty() ? 0.0 : errors[errors.size() / 2],
      errors.empty() ? 0.0 : errors.back());
  return failures == 0 && missed == 0;
}

}  // namespace
}  // namespace modcal

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 150;
  const bool literal = modcal::holds("literal", count);
  const bool continuous = modcal::holds("continuous", count);
  return literal && continuous ? 0 : 1;
}
