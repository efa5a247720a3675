// Work–precision of the simulators: prints, for every scheme and time step, the relative L2 error
// of each signal over the first 50 ms and over 1 s, transient included, against the event-driven
// integrator with 5 nodes and steps of 0.8 µs, and the processor time it took.
//
//     work_precision paper|stiff|thermal [--quick] > work_precision.csv
#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <ctime>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

#include "libsim/base/error.hpp"
#include "libsim/dynamics/event/modal_event.hpp"
#include "libsim/dynamics/fixed_step/fixed_step.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal {
namespace {

// Every time step below divides its period: no scheme takes a shorter step than the table says.
constexpr double kRate = 50000.0;
constexpr double kShort = 0.05;

double relative_error(const Signal& signal, const Signal& reference, double duration) {
  const auto count = static_cast<std::size_t>(duration * kRate);
  double error = 0.0, power = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    error += std::pow(signal.samples[i] - reference.samples[i], 2);
    power += std::pow(reference.samples[i], 2);
  }
  return std::sqrt(error / power);
}

struct Timed {
  Simulation run;
  double milliseconds = std::numeric_limits<double>::infinity();
};

Timed timed(const Simulator& simulator, const Scene& scene) {
  Timed best;
  double spent = 0.0;
  for (int repeat = 0; repeat < 5 && spent < 400.0; ++repeat) {
    const std::clock_t start = std::clock();
    best.run = simulator.simulate(scene, kRate, OutputRequest::all());
    const double took = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    best.milliseconds = std::min(best.milliseconds, took);
    spent += took;
  }
  return best;
}

void print_row(const std::string& scheme, double step, const Simulator& simulator,
               const Scene& scene, const Simulation& reference) {
  Timed result;
  try {
    result = timed(simulator, scene);
  } catch (const InvalidInput&) {  // a step too long for the scheme
    fmt::print("{},{:g},,,,,,,,,,,refused\n", scheme, step);
    return;
  }
  const Simulation& run = result.run;
  if (run.diverged_at) {
    fmt::print("{},{:g},,,,,,,,,,,{}: {}\n", scheme, step, *run.diverged_at, run.explanation);
    return;
  }
  fmt::print("{},{:g}", scheme, step);
  for (const double duration : {kShort, scene.duration}) {
    for (const auto signal : {&Simulation::displacement, &Simulation::velocity, &Simulation::force,
                              &Simulation::left_reaction, &Simulation::right_reaction}) {
      fmt::print(",{:.2e}", relative_error(run.*signal, reference.*signal, duration));
    }
  }
  fmt::print(",{},{:.2f}\n", run.attachments + run.releases, result.milliseconds / scene.duration);
  std::fflush(stdout);
}

std::optional<Scene> scene_named(std::string_view name) {
  Scene scene = paper_scene();
  if (name == "paper") return scene;
  if (name == "stiff") {
    scene.string.inharmonicity = 1.4e-4;
    return scene;
  }
  if (name == "thermal") {
    scene.friction = Choice<FrictionLaw>("thermal");
    return scene;
  }
  return std::nullopt;
}

void work_precision(const Scene& scene, bool quick) {
  const Simulation reference = ModalEvent({.nodes = 5, .max_step = quick ? 2.5e-6 : 8e-7})
                                   .simulate(scene, kRate, OutputRequest::all());
  fmt::print("scheme,time step [s]");
  for (const std::string record : {"50 ms", "1 s"}) {
    for (const char* signal : {"y", "v", "f", "R1", "R2"}) {
      fmt::print(",error of {} over {}", signal, record);
    }
  }
  fmt::print(",switches,ms per simulated second\n");
  for (const double step : {2e-5, 1e-5, 5e-6, 2e-6, 1e-6, 5e-7, 2e-7, 1e-7}) {
    if (quick && step < 1e-6) break;
    for (std::int64_t nodes = 2; nodes <= 5; ++nodes) {
      print_row(fmt::format("modal_event {} nodes", nodes), step,
                ModalEvent({.nodes = nodes, .max_step = step}), scene, reference);
    }
    print_row("modal_exact", step, ModalExact({.time_step = step}), scene, reference);
    print_row("newmark_explicit", step, NewmarkExplicit({.time_step = step}), scene, reference);
  }
}

}  // namespace
}  // namespace modcal

int main(int argc, char** argv) {
  const auto scene = argc > 1 ? modcal::scene_named(argv[1]) : std::nullopt;
  if (!scene) {
    fmt::print(stderr, "usage: work_precision paper|stiff|thermal [--quick]\n");
    return 2;
  }
  modcal::work_precision(*scene, argc > 2 && std::strcmp(argv[2], "--quick") == 0);
}
