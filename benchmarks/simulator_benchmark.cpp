// Time of the simulators: nanoseconds a step of the fixed-step schemes beside the floor that their
// multiply-adds set on this machine; milliseconds a simulated second of the
// event-driven one.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "benchmarks/vector_throughput.hpp"
#include "libsim/dynamics/event/modal_event.hpp"
#include "libsim/dynamics/fixed_step/fixed_step.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal {
namespace {

constexpr double kRate = 51200.0;

Scene scene_with(std::int64_t modes, double duration) {
  Scene scene = paper_scene();
  scene.string.modes = modes;
  scene.duration = duration;
  return scene;
}

// Floor of a fixed step: four multiply-adds a vector of modes (two advance it, two are the sum that
// the contact asks for; its two additions have units of their own), as fast as the machine does
// independent ones. The four loads, the state being in registers, run beside them.
double floor_ns(std::size_t modes) {
  static const VectorThroughput throughput = measure_vector_throughput();
  const std::size_t vectors = (modes + throughput.lanes - 1) / throughput.lanes;
  return 4.0 * static_cast<double>(vectors) * throughput.multiply_add_ns;
}

// Nanoseconds of one step, and how many times the floor that is.
template <typename Scheme>
void fixed_step(benchmark::State& state) {
  const Scene scene = scene_with(state.range(0), 1.0);
  const Scheme scheme({.time_step = 1e-6});
  std::size_t steps = 0, modes = 0;
  const std::clock_t start = std::clock();
  for (auto _ : state) {
    const Simulation run = scheme.simulate(scene, kRate, OutputRequest::all());
    benchmark::DoNotOptimize(run.force.samples.data());
    steps += run.steps;
    modes = run.modes_moved;
  }
  const double ns =
      1e9 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / static_cast<double>(steps);
  state.counters["ns_per_step"] = ns;
  state.counters["floor_ns"] = floor_ns(modes);
  state.counters["times_floor"] = ns / floor_ns(modes);
}
BENCHMARK_TEMPLATE(fixed_step, ModalExact)
    ->Arg(20)
    ->Arg(50)
    ->Arg(200)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_TEMPLATE(fixed_step, NewmarkExplicit)
    ->Arg(20)
    ->Arg(50)
    ->Arg(200)
    ->Unit(benchmark::kMillisecond);

// Floor of a simulated second of the event-driven integrator: the multiply-adds that its sums over
// the modes need, as fast as the machine does independent ones. A sample of the held string takes
// five sums of two a vector and a quarter of an update; a sliding step of s nodes s − 1 sums, an
// update of 4 + 2s and four observed sums; a switch 25 sums of a power series and four a vector and
// mode for the change of coordinates. Friction, switches' roots and stored samples come on top.
double event_floor_ms(const Scene& scene, std::int64_t nodes) {
  const double fma = floor_ns(1) / 4.0;
  OutputRequest outputs = OutputRequest::all();
  outputs.switches_from = 0.0;
  const Simulation run = ModalEvent({.nodes = nodes}).simulate(scene, kRate, outputs);
  double held = 0.0, since = 0.0;
  bool sticking = false;
  for (const Switch& change : run.switches) {
    if (sticking) held += change.time - since;
    sticking = change.attaches;
    since = change.time;
  }
  const double vectors = floor_ns(run.modes_moved) / floor_ns(1);
  const double held_samples = held * kRate;
  const double sliding_steps = static_cast<double>(run.steps) - held_samples;
  const double sum = 2.0 * vectors, s = static_cast<double>(nodes);
  const double held_cost = 5.0 * sum + vectors;
  const double sliding_cost = (s - 1.0) * sum + (4.0 + 2.0 * s) * vectors + 4.0 * sum;
  const double switch_cost = 25.0 * sum + 4.0 * static_cast<double>(run.modes_moved) * vectors;
  return 1e-6 * fma *
         (held_samples * held_cost + sliding_steps * sliding_cost +
          static_cast<double>(run.switches.size()) * switch_cost);
}

// One iteration is one simulated second of the paper's case, all five outputs at 51.2 kHz.
void event_second(benchmark::State& state) {
  const Scene scene = scene_with(50, 1.0);
  const ModalEvent scheme({.nodes = state.range(0)});
  const std::clock_t start = std::clock();
  for (auto _ : state) {
    const Simulation run = scheme.simulate(scene, kRate, OutputRequest::all());
    benchmark::DoNotOptimize(run.force.samples.data());
  }
  const double ms = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC /
                    static_cast<double>(state.iterations());
  const double floor = event_floor_ms(scene, state.range(0));
  state.counters["floor_ms"] = floor;
  state.counters["times_floor"] = ms / floor;
}
BENCHMARK(event_second)->DenseRange(2, 5)->Unit(benchmark::kMillisecond);

// Set-up alone: closed loop, tables, one sample.
void event_set_up(benchmark::State& state) {
  const Scene scene = scene_with(state.range(0), 1.5 / kRate);
  const ModalEvent scheme({});
  for (auto _ : state) {
    benchmark::DoNotOptimize(scheme.simulate(scene, kRate, OutputRequest::all()).steps);
  }
}
BENCHMARK(event_set_up)->Arg(50)->Arg(200)->Arg(800)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace modcal

BENCHMARK_MAIN();
