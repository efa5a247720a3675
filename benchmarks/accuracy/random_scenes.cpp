// Stress of the event-driven integrator: scenes drawn at random, error over 20 ms at the default
// step against a step of 2 µs, both attachment rules. Exits with 1 where a run fails, or more than
// one scene in a hundred errs by more than 1e-3.
//
//     random_scenes [count = 150]
#include "tests/libsim/dynamics/random_scenes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "libsim/dynamics/simulators/modal_event.hpp"

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
  int failures = 0, missed = 0;
  for (int seed = 1; seed <= count; ++seed) {
    Scene scene = random_scene(static_cast<std::uint64_t>(seed));
    scene.duration = 0.02;
    const auto run = [&](double step) {
      return ModalEvent({.max_step = step, .attach = rule})
          .simulate(scene, kRate, OutputRequest::all());
    };
    const Simulation result = run(1.0 / kRate), reference = run(2e-6);
    if (result.diverged_at || reference.diverged_at) {
      ++failures;
      fmt::print("{} seed {}: {}{}\n", rule, seed, result.explanation, reference.explanation);
      continue;
    }
    errors.push_back(worst_error(result, reference));
    if (!(errors.back() <= 1e-3)) {
      ++missed;
      fmt::print("{} seed {}: error {:.1e}, {} and {} attachments\n", rule, seed, errors.back(),
                 result.attachments, reference.attachments);
    }
  }
  std::sort(errors.begin(), errors.end());
  fmt::print("{}: {} scenes, {} failed, {} above 1e-3; error median {:.1e}, largest {:.1e}\n", rule,
             count, failures, missed, errors.empty() ? 0.0 : errors[errors.size() / 2],
             errors.empty() ? 0.0 : errors.back());
  return failures == 0 && missed * 100 <= count;
}

}  // namespace
}  // namespace modcal

int main(int argc, char** argv) {
  const int count = argc > 1 ? std::atoi(argv[1]) : 150;
  const bool literal = modcal::holds("literal", count);
  const bool continuous = modcal::holds("continuous", count);
  return literal && continuous ? 0 : 1;
}
