// What simulations save by leaving out what their scene does not need: processor time of a second
// of the record with each skip and without it. What an evaluation of the joint likelihood saves on
// modes far from a block of bins, and on columns where the slope is all that is needed.
// Run: skipping_benchmark
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <ctime>

#include "benchmarks/noisy_stroke.hpp"
#include "libcalib/likelihood/likelihood_evaluation.hpp"
#include "libcalib/likelihood/string_unknowns.hpp"
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

// Median processor time [ms].
template <typename Work>
double milliseconds(const Work& work) {
  std::vector<double> taken;
  for (int i = 0; i < 41; ++i) {
    const std::clock_t begin = std::clock();
    work();
    taken.push_back(1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  }
  return quantile(taken, 0.5);
}

void print_likelihood() {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  const NoisyStroke the = make_noisy_stroke();
  const WhitenedRecord whole =
      WhitenedRecord::of(NoisyRecords::of_data(the.data, the.truth.basis,
                                               {the.options.left_noise, the.options.right_noise}),
                         0.0, likelihood_band(the.truth, the.options.highest_frequency, kRate));
  const auto print_case = [&](const char* what, const StringUnknowns& unknowns) {
    const LikelihoodColumns columns = unknowns.columns(unknowns.start());
    const auto columns_by = [&](bool interpolate) {
      return milliseconds(
          [&] { LikelihoodEvaluation(whole, the.truth, interpolate).differentiate(columns, {}); });
    };
    const auto slope_by = [&](bool interpolate) {
      return milliseconds(
          [&] { LikelihoodEvaluation(whole, the.truth, interpolate).slope(columns); });
    };
    fmt::print(
        "likelihood of one second, {}: information {:.2f} ms, slope alone {:.2f} ms\n"
        "  with every mode in every bin: {:.2f} ms, {:.2f} ms\n",
        what, columns_by(true), slope_by(true), columns_by(false), slope_by(false));
  };
  print_case("the law's unknowns", StringUnknowns::law(the.truth, 196.0, 0.0));
  print_case("every frequency", StringUnknowns::frequencies(the.truth));
}

void run() {
  print_likelihood();
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
