// How the time of the simulators grows with the number of modes and with the length of the record:
// processor times and the exponents of power laws fitted to them, five outputs at 51.2 kHz.
//
//     simulator_scaling
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <string_view>
#include <vector>

#include "libsim/dynamics/event/modal_event.hpp"
#include "libsim/dynamics/fixed_step/fixed_step.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal {
namespace {

constexpr double kRate = 51200.0;
constexpr std::int64_t kModes[] = {50, 100, 200, 500, 1000, 2000};
constexpr double kSeconds[] = {1.0, 4.0, 15.0, 60.0};

Scene scene_with(std::int64_t modes, double duration) {
  Scene scene = paper_scene();
  scene.string.modes = modes;
  scene.duration = duration;
  return scene;
}

struct Point {
  double x, seconds;
};

// Least squares of log seconds over log x.
double exponent(const std::vector<Point>& points) {
  double mean_x = 0.0, mean_y = 0.0, xx = 0.0, xy = 0.0;
  const auto count = static_cast<double>(points.size());
  for (const Point& p : points) {
    mean_x += std::log(p.x) / count;
    mean_y += std::log(p.seconds) / count;
  }
  for (const Point& p : points) {
    xx += (std::log(p.x) - mean_x) * (std::log(p.x) - mean_x);
    xy += (std::log(p.x) - mean_x) * (std::log(p.seconds) - mean_y);
  }
  return xy / xx;
}

// The least of three runs: what else the machine does only adds.
double processor_seconds(const Simulator& simulator, const Scene& scene,
                         std::size_t* switches = nullptr) {
  double least = HUGE_VAL;
  for (int repeat = 0; repeat < 3; ++repeat) {
    const std::clock_t start = std::clock();
    const Simulation run = simulator.simulate(scene, kRate, OutputRequest::all());
    const double took = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    least = std::min(least, took);
    if (run.diverged_at) fmt::print("  stopped: {}\n", run.explanation);
    if (switches != nullptr) *switches = run.attachments + run.releases;
  }
  return least;
}

void print_with_exponent(std::string_view what, std::string_view unit,
                         const std::vector<Point>& points) {
  fmt::print("{}:", what);
  for (const Point& p : points) fmt::print("  {:g}{} {:.3g} ms", p.x, unit, 1e3 * p.seconds);
  fmt::print("\n  fitted exponent {:.2f}\n", exponent(points));
  std::fflush(stdout);
}

void over_duration(std::string_view name, const Simulator& simulator) {
  std::vector<Point> points;
  for (const double seconds : kSeconds) {
    points.push_back({seconds, processor_seconds(simulator, scene_with(50, seconds))});
  }
  print_with_exponent(fmt::format("{}, 50 modes, length of the record", name), " s", points);
}

// The contact of 2000 modes is so light that the explicit scheme needs steps of 0.2 us.
void over_modes(std::string_view name, const Simulator& simulator) {
  std::vector<Point> points;
  for (const std::int64_t modes : kModes) {
    const Scene scene = scene_with(modes, 0.004);
    points.push_back({static_cast<double>(modes), processor_seconds(simulator, scene)});
  }
  print_with_exponent(fmt::format("{}, 4 ms at 0.2 us, modes", name), "", points);
}

// Set-up apart: it is paid once a scene. More modes switch more often.
void event_over_modes() {
  const ModalEvent simulator({});
  std::vector<Point> set_up, sound, one_switch;
  for (const std::int64_t modes : kModes) {
    const auto x = static_cast<double>(modes);
    std::size_t switches = 0;
    const double before = processor_seconds(simulator, scene_with(modes, 2.0 / kRate));
    const double whole = processor_seconds(simulator, scene_with(modes, 0.02), &switches);
    set_up.push_back({x, before});
    sound.push_back({x, whole - before});
    one_switch.push_back({x, sound.back().seconds / static_cast<double>(switches)});
  }
  print_with_exponent("modal_event, set-up, modes", "", set_up);
  print_with_exponent("modal_event, 20 ms of sound without it, modes", "", sound);
  print_with_exponent("modal_event, a switch of it, modes", "", one_switch);
}

}  // namespace
}  // namespace modcal

int main() {
  using namespace modcal;
  over_duration("newmark_explicit", NewmarkExplicit({.time_step = 1e-6}));
  over_duration("modal_exact", ModalExact({.time_step = 1e-6}));
  over_duration("modal_event", ModalEvent({}));
  over_modes("newmark_explicit", NewmarkExplicit({.time_step = 2e-7}));
  over_modes("modal_exact", ModalExact({.time_step = 2e-7}));
  event_over_modes();
}
