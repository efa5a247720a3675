// Calibration to the bound on one second of the paper's string with 1 % noise, from ±2 % in every
// frequency and 1.5 mm in x_c: the law alone, and every frequency, on so many threads. Its parts on
// one thread: evaluations of the likelihood of the whole record with the law's columns and with
// every frequency's, slopes alone; floor_ms: their arithmetic at the rate of products of columns in
// the first cache.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "benchmarks/noisy_stroke.hpp"
#include "libcalib/likelihood/likelihood_evaluation.hpp"
#include "libcalib/likelihood/projected_likelihood.hpp"
#include "libcalib/parameters/string_unknowns.hpp"
#include "libsim/base/kernels/column_products.hpp"

namespace modcal {
namespace {

const NoisyStroke& the_case() {
  static const NoisyStroke value = make_noisy_stroke();
  return value;
}

void calibrate_case(benchmark::State& state, bool frequencies) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(state.range(0)));
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

// Products of columns a second that the first cache can feed: what the processor does at best.
double multiply_adds_per_second() {
  constexpr std::size_t kColumns = 4, kRepeats = 20000;
  const AlignedVector columns(kColumns * kColumnLength, 1.0);
  double products[kColumns * kColumns] = {};
  double best = 0.0;
  for (int i = 0; i < 5; ++i) {
    const std::clock_t begin = std::clock();  // others may use the processor too
    for (std::size_t r = 0; r < kRepeats; ++r) {
      add_products(columns.data(), kColumns, columns.data(), kColumns, false, products, kColumns);
    }
    const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    best = std::max(best,
                    static_cast<double>(kColumns * kColumns * kColumnLength * kRepeats) / seconds);
  }
  benchmark::DoNotOptimize(products);
  return best;
}

// Times at which modes are evaluated in one pass over the record: bins of near modes, nodes of far
// ones, and what goes between bins and nodes.
struct Work {
  double places = 0.0, blocks_with_nodes = 0.0;
};
Work work_of(const WhitenedRecord& record, const ModelPoint& point, bool interpolate) {
  const std::vector<LikelihoodMode> modes = likelihood_modes(point, record.sample_rate);
  const ModeSplits splits(record, modes, interpolate);
  Work work;
  for (std::size_t b = 0; b < record.blocks(); ++b) {
    const ModeSplit split = splits.of(b);
    for (std::size_t p = 0; p < 2; ++p) {
      work.places += static_cast<double>(split.near[p].size() * WhitenedRecord::kBlock +
                                         split.far[p].size() * WhitenedRecord::kNodes);
    }
    work.blocks_with_nodes += split.has_far() ? 1.0 : 0.0;
  }
  return work;
}

enum class What { kColumns, kSlopes };

// Arithmetic of a mode in a place (additions and multiplications apart where they cannot be one),
// and fields that go between bins and nodes: transfer functions 14 and 4 fields, the decays' Gram
// matrix 38 and 4, products with the residual 20 and 4, their sums 22 and 4; then slopes 50 and 8,
// or the law's four columns 78 and 32 and their products with the decays 32 and 16.
double floor_seconds(const Work& work, What what) {
  static const double rate = multiply_adds_per_second();
  const double operations = 94.0 + (what == What::kSlopes ? 50.0 : 110.0);
  const double fields = 16.0 + (what == What::kSlopes ? 8.0 : 48.0);
  return (work.places * operations +
          work.blocks_with_nodes * fields *
              static_cast<double>(WhitenedRecord::kNodes * WhitenedRecord::kBlock)) /
         rate;
}

void evaluate(benchmark::State& state, const StringUnknowns& unknowns, What what,
              bool interpolate) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  const NoisyStroke& the = the_case();
  const NoisyRecords records = NoisyRecords::of_data(
      the.data, the.truth.basis, {the.options.left_noise, the.options.right_noise});
  const double highest = likelihood_band(the.truth, NAN, kRate);
  const WhitenedRecord whole = WhitenedRecord::of(records, 0.0, highest);
  const LikelihoodColumns columns = unknowns.columns(unknowns.start());
  for (auto _ : state) {
    LikelihoodEvaluation evaluation(whole, the.truth, interpolate);
    benchmark::DoNotOptimize(what == What::kSlopes ? evaluation.slope(columns)
                                                   : evaluation.differentiate(columns, {}));
  }
  if (what == What::kColumns && !unknowns.is_law()) return;
  const Work work = work_of(whole, the.truth, interpolate);
  state.counters["modes_a_bin"] = work.places / static_cast<double>(whole.bins);
  state.counters["floor_ms"] = 1e3 * floor_seconds(work, what);
}

StringUnknowns the_law() { return StringUnknowns::law(the_case().truth, 196.0, 0.0); }
StringUnknowns the_frequencies() { return StringUnknowns::frequencies(the_case().truth); }

void evaluate_law(benchmark::State& state) { evaluate(state, the_law(), What::kColumns, true); }
void evaluate_law_every_mode_everywhere(benchmark::State& state) {
  evaluate(state, the_law(), What::kColumns, false);
}
void slope_law(benchmark::State& state) { evaluate(state, the_law(), What::kSlopes, true); }
void evaluate_frequencies(benchmark::State& state) {
  evaluate(state, the_frequencies(), What::kColumns, true);
}
void slope_frequencies(benchmark::State& state) {
  evaluate(state, the_frequencies(), What::kSlopes, true);
}

BENCHMARK(law)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(all_frequencies)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(evaluate_law)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(evaluate_law_every_mode_everywhere)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(slope_law)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(evaluate_frequencies)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(slope_frequencies)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace modcal

BENCHMARK_MAIN();
