// Inversion of one record of the paper's case (51 200 samples, 50 modes) with the transfer
// functions prepared: transform, whole curve over the parameter, choice, inverse transforms.
#include <benchmark/benchmark.h>

#include "libinverse/minimal_product.hpp"
#include "libinverse/one_sided_inversion.hpp"
#include "libsim/base/random.hpp"
#include "libsim/model/constant_damping.hpp"

namespace modcal {
namespace {

constexpr double kRate = 51200.0;
constexpr std::size_t kSamples = 51200;

OneSidedInversion violin_g() {
  StringModel string;
  string.length = 0.33;
  string.linear_density = 3.1e-3;
  string.fundamental = 196.0;
  return {make_modal_basis(string), 0.03, End::kLeft, kSamples, kRate};
}

std::vector<double> white_noise() {
  std::vector<double> samples(kSamples);
  fill_standard_normal(StreamKey(1), samples);
  return samples;
}

void run(benchmark::State& state, std::string_view regularizer_name, InversionOutputs outputs) {
  const OneSidedInversion inversion = violin_g();
  const std::vector<double> reaction = white_noise();
  const auto regularizer = Choice<Regularizer>(regularizer_name).make();
  const MinimalProduct choice{MinimalProduct::Options{}};
  InversionWorkspace workspace;
  InversionResult result;
  for (auto _ : state) {
    inversion.invert(reaction, {*regularizer, choice, outputs}, workspace, result);
    benchmark::DoNotOptimize(result);
  }
}

void invert_force(benchmark::State& state, std::string_view regularizer) {
  run(state, regularizer, {});
}
BENCHMARK_CAPTURE(invert_force, none, "none")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(invert_force, water_level, "water_level")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(invert_force, water_level_clip, "water_level_clip")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(invert_force, tikhonov, "tikhonov")->Unit(benchmark::kMillisecond);

void invert_force_and_motion(benchmark::State& state) {
  run(state, "water_level", {.force = true, .displacement = true, .velocity = true});
}
BENCHMARK(invert_force_and_motion)->Unit(benchmark::kMillisecond);

void transform_pair(benchmark::State& state) {
  const RealFft fft(kSamples);
  std::vector<double> samples = white_noise();
  std::vector<Complex> spectrum(fft.bins());
  for (auto _ : state) {
    fft.forward(samples, spectrum);
    fft.inverse(spectrum, samples);
  }
}
BENCHMARK(transform_pair)->Unit(benchmark::kMillisecond);

void prepare(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(violin_g());
}
BENCHMARK(prepare)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace modcal

BENCHMARK_MAIN();
