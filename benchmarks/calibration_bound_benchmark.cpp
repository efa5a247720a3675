// Calibration to the bound on one second of the paper's string with 1 % noise, from ±2 % in every
// frequency and 1.5 mm in x_c: the law alone, and every frequency. Its parts: one evaluation of the
// likelihood of the whole record with the law's columns and with every frequency's.
#include <benchmark/benchmark.h>

#include <cmath>

#include "libcalib/likelihood/continuation.hpp"
#include "libcalib/likelihood/string_unknowns.hpp"
#include "libsim/base/random.hpp"
#include "libsim/dynamics/simulators/modal_event.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

constexpr double kRate = 51200.0;
constexpr double kNoise = 0.01;

struct Case {
  ModelPoint truth, start;
  CalibrationData data;
  ContinuationOptions options;
};

std::vector<double> with_noise(std::vector<double> samples, double deviation, std::uint64_t draw) {
  std::vector<double> noise(samples.size());
  fill_standard_normal(StreamKey(1).with("measurement noise").with(draw), noise);
  for (std::size_t j = 0; j < noise.size(); ++j) samples[j] += deviation * noise[j];
  remove_mean(samples);
  return samples;
}

Case make_case() {
  Scene scene;
  scene.string.length = 0.33;
  scene.string.linear_density = 3.1e-3;
  scene.string.fundamental = 196.0;
  scene.bow.position = 0.03;
  const Simulation run =
      ModalEvent({}).simulate(scene, kRate, {.left_reaction = true, .right_reaction = true});
  Case result{.truth = {make_modal_basis(scene.string), scene.bow.position}};
  result.options.left_noise = kNoise * standard_deviation(run.left_reaction.samples);
  result.options.right_noise = kNoise * standard_deviation(run.right_reaction.samples);
  result.data = CalibrationData::of_records(
      with_noise(run.left_reaction.samples, result.options.left_noise, 0),
      with_noise(run.right_reaction.samples, result.options.right_noise, 1), kRate);
  result.start = result.truth;
  std::vector<double> draw(result.truth.basis.size());
  fill_uniform(StreamKey(1).with("start"), draw);
  for (std::size_t n = 0; n < draw.size(); ++n) {
    result.start.basis.omega[n] *= 1.0 + 0.02 * (2.0 * draw[n] - 1.0);
  }
  result.start.contact += 1.5e-3;
  return result;
}

const Case& the_case() {
  static const Case value = make_case();
  return value;
}

void calibrate_case(benchmark::State& state, bool frequencies) {
  const Case& the = the_case();
  ContinuationOptions options = the.options;
  options.frequencies = frequencies;
  ContinuationResult result;
  for (auto _ : state) {
    result = calibrate_by_continuation(the.start, the.data, options);
    benchmark::DoNotOptimize(result);
  }
  state.counters["right"] = result.right ? 1.0 : 0.0;
  state.counters["contact_error_m"] = result.model.contact - the.truth.contact;
  state.counters["evaluations"] = static_cast<double>(result.evaluations);
}

void law(benchmark::State& state) { calibrate_case(state, false); }
void all_frequencies(benchmark::State& state) { calibrate_case(state, true); }

void evaluate(benchmark::State& state, const StringUnknowns& unknowns) {
  const Case& the = the_case();
  const NoisyRecords records =
      NoisyRecords::of_data(the.data, {the.options.left_noise, the.options.right_noise});
  const double highest = likelihood_band(the.truth, NAN, kRate);
  const ProjectedLikelihood whole(WhitenedRecord::of(records, 0.0, highest));
  const LikelihoodColumns columns = unknowns.columns(unknowns.start());
  for (auto _ : state) benchmark::DoNotOptimize(whole.evaluate(the.truth, columns));
}

void evaluate_law(benchmark::State& state) {
  evaluate(state, StringUnknowns::law(the_case().truth, 196.0, 0.0));
}
void evaluate_frequencies(benchmark::State& state) {
  evaluate(state, StringUnknowns::frequencies(the_case().truth));
}

BENCHMARK(law)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(all_frequencies)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(evaluate_law)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(evaluate_frequencies)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace modcal

BENCHMARK_MAIN();
