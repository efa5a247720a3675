// Calibration to the bound on one second of the paper's string with 1 % noise, from ±2 % in every
// frequency and 1.5 mm in x_c: the law alone, and every frequency. Its parts: one evaluation of the
// likelihood of the whole record with the law's columns and with every frequency's.
#include <benchmark/benchmark.h>

#include <cmath>

#include "benchmarks/noisy_stroke.hpp"
#include "libcalib/likelihood/string_unknowns.hpp"

namespace modcal {
namespace {

const NoisyStroke& the_case() {
  static const NoisyStroke value = make_noisy_stroke();
  return value;
}

void calibrate_case(benchmark::State& state, bool frequencies) {
  const NoisyStroke& the = the_case();
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
  const NoisyStroke& the = the_case();
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
