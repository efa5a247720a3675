// How the time of the event-driven integrator grows: with the number of modes (20 ms of sound, five
// outputs at 51.2 kHz) and with the length of the record (50 modes). Prints processor times and the
// exponents of power laws fitted to them.
//
//     event_scaling
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <vector>

#include "libsim/dynamics/simulators/modal_event.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal {
namespace {

constexpr double kRate = 51200.0;

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

// Best of three.
double processor_seconds(const Scene& scene, std::size_t* switches = nullptr) {
  double best = HUGE_VAL;
  for (int repeat = 0; repeat < 3; ++repeat) {
    const std::clock_t start = std::clock();
    const Simulation run = ModalEvent({}).simulate(scene, kRate, OutputRequest::all());
    const double took = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    best = std::min(best, took);
    if (run.diverged_at) fmt::print("  stopped: {}\n", run.explanation);
    if (switches != nullptr) *switches = run.attachments + run.releases;
  }
  return best;
}

Scene scene_with(std::int64_t modes, double duration) {
  Scene scene = paper_scene();
  scene.string.modes = modes;
  scene.duration = duration;
  return scene;
}

void over_modes() {
  fmt::print("modes,set-up [ms],20 ms of sound without it [ms],switches\n");
  std::vector<Point> set_up, sound, per_switch;
  for (const std::int64_t modes : {50, 100, 200, 500, 1000, 2000}) {
    std::size_t switches = 0;
    const double before = processor_seconds(scene_with(modes, 2.0 / kRate));
    const double whole = processor_seconds(scene_with(modes, 0.02), &switches);
    set_up.push_back({static_cast<double>(modes), before});
    sound.push_back({static_cast<double>(modes), whole - before});
    per_switch.push_back({sound.back().x, sound.back().seconds / static_cast<double>(switches)});
    fmt::print("{},{:.2f},{:.2f},{}\n", modes, 1e3 * before, 1e3 * (whole - before), switches);
    std::fflush(stdout);
  }
  fmt::print("fitted: set-up ~ N^{:.2f}, sound ~ N^{:.2f}, a switch of it ~ N^{:.2f}\n",
             exponent(set_up), exponent(sound), exponent(per_switch));
}

void over_durations() {
  fmt::print("duration [s],processor time [ms],ms per simulated second\n");
  std::vector<Point> points;
  for (const double duration : {1.0, 2.0, 5.0, 10.0, 20.0, 60.0}) {
    const double seconds = processor_seconds(scene_with(50, duration));
    points.push_back({duration, seconds});
    fmt::print("{:g},{:.1f},{:.2f}\n", duration, 1e3 * seconds, 1e3 * seconds / duration);
    std::fflush(stdout);
  }
  fmt::print("fitted: time ~ T^{:.3f}\n", exponent(points));
}

}  // namespace
}  // namespace modcal

int main() {
  modcal::over_modes();
  modcal::over_durations();
}
