// Ensembles over threads: the Schelleng map of configs/schelleng.yaml, thinned, on 1, 2, … threads.
// Prints wall time, processor time, the speed-up against one thread, and the speed-up that is left
// of it where other work takes a share of the processors: time of one thread over the processor
// time of the busiest of several. Medians of interleaved repetitions. Run: ensemble_benchmark
// [cells an axis] [repetitions]
#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/global_control.h>

#include <chrono>
#include <cstdlib>
#include <ctime>
#include <thread>

#include "libsim/dynamics/event/modal_event.hpp"
#include "libsim/dynamics/scene/simulator.hpp"
#include "libsim/dynamics/scene/string_regime.hpp"
#include "libsim/signal/statistics.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal {
namespace {

constexpr double kRate = 51200.0;

Scene cell(std::size_t index, std::size_t axis) {
  const auto share = [axis](std::size_t i) {
    return (static_cast<double>(i) + 0.5) / static_cast<double>(axis);
  };
  Scene scene = paper_scene();
  scene.duration = 0.5;
  scene.bow.position = scene.string.length * 0.02 * std::pow(15.0, share(index % axis));
  scene.bow.normal_force = 0.02 * std::pow(1500.0, share(index / axis));
  scene.initial =
      helmholtz_motion(make_modal_basis(scene.string), scene.bow.position, scene.bow.velocity);
  return scene;
}

struct Times {
  double wall = 0.0, processor = 0.0, busiest = 0.0;
};

// Processor time of the calling thread [s].
double thread_seconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// From the making of a scene to the end of its judgement, by thread.
struct Busy {
  double since = 0.0, total = 0.0;
};
using BusyThreads = tbb::enumerable_thread_specific<Busy>;

std::vector<int> make_map(std::size_t axis, const ModalEvent& simulator, BusyThreads& busy) {
  const RegimeCriteria criteria;
  const Ensemble ensemble{
      .size = axis * axis,
      .scene =
          [axis, &busy](std::size_t i) {
            busy.local().since = thread_seconds();
            return cell(i, axis);
          },
      .sample_rate = kRate,
      .outputs = {.velocity = true, .switches_from = judged_from(cell(0, axis), criteria)}};
  return reduce_ensemble<int>(
      simulator, ensemble, [&](std::size_t i, const Simulation& simulation) {
        const auto regime =
            classify(regime_features(cell(i, axis), simulation, criteria), criteria);
        Busy& mine = busy.local();
        mine.total += thread_seconds() - mine.since;
        return static_cast<int>(regime);
      });
}

// Cells that a computation with a quarter of the step and of the slope number sees in another way.
void print_agreement(std::size_t axis) {
  BusyThreads busy;
  const std::vector<int> map = make_map(axis, ModalEvent({}), busy);
  const std::vector<int> fine =
      make_map(axis, ModalEvent({.max_step = 0.25 / kRate, .slope_number = 0.175}), busy);
  std::size_t equal = 0;
  for (std::size_t i = 0; i < map.size(); ++i) equal += map[i] == fine[i] ? 1 : 0;
  fmt::print("{} of {} cells are the same with steps four times as short\n", equal, map.size());
}

Times run_map(std::size_t axis, int threads, std::vector<int>& map) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t clock = std::clock();
  BusyThreads busy;
  map = make_map(axis, ModalEvent({}), busy);
  Times times{std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
              static_cast<double>(std::clock() - clock) / CLOCKS_PER_SEC};
  for (const Busy& thread : busy) times.busiest = std::max(times.busiest, thread.total);
  return times;
}

void run(std::size_t axis, std::size_t repetitions) {
  const int most = static_cast<int>(std::max(2u, std::thread::hardware_concurrency()));
  std::vector<std::vector<double>> wall(static_cast<std::size_t>(most));
  std::vector<std::vector<double>> processor(wall.size()), busiest(wall.size());
  std::vector<int> first, map;
  for (std::size_t repetition = 0; repetition < repetitions; ++repetition) {
    for (int threads = 1; threads <= most; ++threads) {
      const Times times = run_map(axis, threads, map);
      if (first.empty()) first = map;
      if (map != first) fmt::print("the map depends on the threads\n");
      wall[static_cast<std::size_t>(threads - 1)].push_back(times.wall);
      processor[static_cast<std::size_t>(threads - 1)].push_back(times.processor);
      busiest[static_cast<std::size_t>(threads - 1)].push_back(times.busiest);
    }
  }
  fmt::print(
      "{} scenes of 0.5 s\nthreads   wall s   processor s   speed-up   by the busiest thread\n",
      axis * axis);
  for (std::size_t i = 0; i < wall.size(); ++i) {
    std::vector<double> ratios, shares;
    for (std::size_t k = 0; k < repetitions; ++k) {
      ratios.push_back(wall[0][k] / wall[i][k]);
      shares.push_back(busiest[0][k] / busiest[i][k]);
    }
    fmt::print("{:7} {:8.3f} {:13.3f} {:10.2f} {:10.2f}\n", i + 1, quantile(wall[i], 0.5),
               quantile(processor[i], 0.5), quantile(ratios, 0.5), quantile(shares, 0.5));
  }
}

}  // namespace
}  // namespace modcal

int main(int argc, char** argv) {
  const auto argument = [&](int i, std::size_t otherwise) {
    return argc > i ? static_cast<std::size_t>(std::atoi(argv[i])) : otherwise;
  };
  modcal::run(argument(1, 16), argument(2, 5));
  modcal::print_agreement(argument(1, 16));
}
