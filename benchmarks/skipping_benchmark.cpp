// What simulations save by leaving out what their scene does not need: processor time of a second
// of the record with each skip and without it. Run: skipping_benchmark
#include <fmt/format.h>

#include "libsim/dynamics/plan.hpp"
#include "libsim/dynamics/simulators/modal_event.hpp"
#include "libsim/dynamics/simulators/modal_exact.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal {
namespace {

void print(const char* what, const Scene& scene, const Simulator& simulator,
           const OutputRequest& outputs) {
  const SimulationPlan plan = plan_simulation(scene, simulator, 51200.0, outputs, 10.0);
  fmt::print("{}: {:.2f} ms a second, measured on {:.2g} s\n", what, 1e3 * plan.seconds_per_second,
             plan.piece);
  for (const Skip& skip : plan.skips) {
    fmt::print("  without skipping {}: {:.2f} ms ({:+.1f} %), {}\n", skip.what,
               1e3 * (plan.seconds_per_second + skip.saved_seconds),
               100.0 * skip.saved_seconds / plan.seconds_per_second, skip.note);
  }
}

void run() {
  const Scene paper = paper_scene();  // the bow at L/11
  Scene third = paper;
  third.bow.position = paper.string.length / 3.0;
  const OutputRequest reactions{.left_reaction = true, .right_reaction = true};
  const OutputRequest velocity{.velocity = true};
  print("modal_event, bow at L/11, reactions", paper, ModalEvent({}), reactions);
  print("modal_event, bow at L/3, velocity", third, ModalEvent({}), velocity);
  print("modal_event, four steps a sample, all outputs", paper,
        ModalEvent({.max_step = 0.25 / 51200.0}), OutputRequest::all());
  print("modal_exact, bow at L/11, reactions", paper, ModalExact({.time_step = 1e-6}), reactions);
  print("modal_exact, bow at L/3, velocity", third, ModalExact({.time_step = 1e-6}), velocity);
}

}  // namespace
}  // namespace modcal

int main() { modcal::run(); }
