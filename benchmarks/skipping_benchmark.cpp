// What simulations save by leaving out what their scene does not need: processor time of a second
// of the record with each skip and without it. What an evaluation of the joint likelihood saves on
// modes far from a block of bins, on columns where the slope is all that is needed, and on rows of
// the information that belong to unknowns that have not moved.
// Run: skipping_benchmark
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <ctime>

#include "benchmarks/noisy_stroke.hpp"
#include "libcalib/likelihood/likelihood_evaluation.hpp"
#include "libcalib/optimizers/staged/newton_fit.hpp"
#include "libcalib/parameters/string_unknowns.hpp"
#include "libsim/dynamics/event/modal_event.hpp"
#include "libsim/dynamics/fixed_step/fixed_step.hpp"
#include "libsim/dynamics/plan.hpp"
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

double processor_ms(const auto& work) {
  const std::clock_t begin = std::clock();
  work();
  return 1e3 * static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

void print_rows() {
  const NoisyStroke the = make_noisy_stroke();
  const WhitenedRecord whole =
      WhitenedRecord::of(NoisyRecords::of_data(the.data, the.truth.basis,
                                               {the.options.left_noise, the.options.right_noise}),
                         0.0, likelihood_band(the.truth, the.options.highest_frequency, kRate));
  const StringUnknowns unknowns = StringUnknowns::frequencies(the.truth);
  const LikelihoodColumns columns = unknowns.columns(unknowns.start());
  fmt::print("rows of the information, of {}:", columns.count);
  for (const std::size_t count : {1, 2, 3, 4, 5, 6}) {
    std::vector<std::size_t> wanted;
    for (std::size_t i = 0; i < count; ++i) wanted.push_back(10 + 7 * i);
    const double taken =
        milliseconds([&] { LikelihoodEvaluation(whole, the.truth).rows(columns, wanted); });
    fmt::print(" {}: {:.2f} ms", count, taken);
  }
  fmt::print("\n");
}

// Fits of every frequency from the truth over draws of noise: with the rows of unknowns that moved,
// and with all of them. Modes in a node creep: many a fit ends by its 80 steps.
void print_fits(const char* what, double inharmonicity, double noise) {
  constexpr std::uint64_t kDraws = 5;
  double all_ms = 0.0, some_ms = 0.0, apart = 0.0;
  std::size_t whole = 0, left = 0, partial = 0;
  for (std::uint64_t seed = 1; seed <= kDraws; ++seed) {
    const NoisyStroke the = make_noisy_stroke({noise, inharmonicity, seed});
    const ProjectedLikelihood likelihood(
        WhitenedRecord::of(NoisyRecords::of_data(the.data, the.truth.basis,
                                                 {the.options.left_noise, the.options.right_noise}),
                           0.0, likelihood_band(the.truth, the.options.highest_frequency, kRate)));
    const StringUnknowns unknowns = StringUnknowns::frequencies(the.truth);
    const Eigen::VectorXd start = unknowns.start();
    const auto model = [&](const Eigen::VectorXd& theta) { return unknowns.model(theta); };
    const auto columns = [&](const Eigen::VectorXd& theta) { return unknowns.columns(theta); };
    NewtonOptions options{.steps = 80, .frequency_cap = 1e-3};
    const auto modes = static_cast<Eigen::Index>(unknowns.modes());
    options.prior = Eigen::VectorXd::Constant(modes, 1.0 / (2e-3 * 2e-3)).asDiagonal();
    const FitTarget every_row{
        .evaluate =
            [&](const auto& theta) { return likelihood.evaluate(model(theta), columns(theta)); },
        .admits = [&](const auto& theta) { return unknowns.admits(theta); },
        .capped = modes,
        .slope = [&](const auto& theta) { return likelihood.slope(model(theta), columns(theta)); }};
    NewtonFit all, some;
    all_ms += processor_ms([&] { all = newton_fit(every_row, start, options); }) / kDraws;
    some_ms +=
        processor_ms([&] { some = newton_fit(likelihood, unknowns, start, options); }) / kDraws;
    whole += all.evaluations - all.slopes;
    left += some.evaluations - some.slopes - some.partial;
    partial += some.partial;
    const LikelihoodPoint at =
        likelihood.evaluate(model(all.theta), columns(all.theta), {.twice_weighted = true});
    const Eigen::VectorXd deviation = fit_covariance(at, options).diagonal().cwiseSqrt();
    apart =
        std::max(apart, (all.theta - some.theta).cwiseQuotient(deviation).cwiseAbs().maxCoeff());
  }
  const double draws = kDraws;
  fmt::print(
      "fit of every frequency, {}, {:g} % noise: {:.1f} ms with all rows ({:.1f} times), {:.1f} ms "
      "with those that moved ({:.1f} times all, {:.1f} times some): {:.2f}; apart by {:.2g} sd\n",
      what, 100.0 * noise, all_ms, static_cast<double>(whole) / draws, some_ms,
      static_cast<double>(left) / draws, static_cast<double>(partial) / draws, some_ms / all_ms,
      apart);
}

void print_unmoved() {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  print_rows();
  for (const double noise : {1e-3, 1e-2, 1e-1}) {
    print_fits("the paper's string", 0.0, noise);
    print_fits("B = 4e-4", 4e-4, noise);
  }
}

void run() {
  print_likelihood();
  print_unmoved();
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
