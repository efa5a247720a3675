// Inversion of one record of the paper's case (51 200 samples, 50 modes) with the transfer
// functions prepared: transform, whole curve over the parameter, choice, inverse transforms.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <vector>

#include "libinverse/joint/force_prior.hpp"
#include "libinverse/joint/joint_inversion.hpp"
#include "libinverse/spectral/choices/rules.hpp"
#include "libinverse/spectral/one_sided/one_sided_inversion.hpp"
#include "libsim/base/random.hpp"
#include "libsim/model/damping.hpp"

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

// Both reactions: noise levels, weighting, transforms, 100-point curve of evidence, inverse
// transform, as JointEstimator does it with everything prepared.
struct JointCase {
  explicit JointCase(std::size_t samples)
      : basis(violin_g_basis()),
        sensors(basis, 0.03, samples, kRate, {}, {}),
        inversion(basis, 0.03, samples, kRate,
                  {.sigma = 2.0 * kRate / static_cast<double>(samples)}),
        left(draw(samples, 1)),
        right(draw(samples, 2)) {}

  static ModalBasis violin_g_basis() {
    StringModel string;
    string.length = 0.33;
    string.linear_density = 3.1e-3;
    string.fundamental = 196.0;
    return make_modal_basis(string);
  }
  // A slowly wandering reaction with 5 % of white noise.
  static std::vector<double> draw(std::size_t samples, std::uint64_t seed) {
    std::vector<double> noise(samples);
    fill_standard_normal(StreamKey(seed), noise);
    double value = 0.0;
    for (double& sample : noise) {
      value = 0.98 * value + sample;
      sample = 0.2 * value + 0.05 * sample;
    }
    return noise;
  }
  void invert(const ForcePrior& prior) {
    const ReactionPair pair = {left, right};
    noise = sensors.estimate(pair, workspace.noise);
    inversion.invert(pair, noise, {.prior = prior, .offset = OffsetRule::kNone}, workspace, result);
  }

  ModalBasis basis;
  SensorNoise sensors;
  JointInversion inversion;
  std::vector<double> left, right;
  SensorNoiseLevel noise;
  JointWorkspace workspace;
  JointResult result;
};

void invert_jointly(benchmark::State& state, std::string_view prior_name) {
  JointCase the_case(static_cast<std::size_t>(state.range(0)));
  const auto prior = Choice<ForcePrior>(prior_name).make();
  for (auto _ : state) {
    the_case.invert(*prior);
    benchmark::DoNotOptimize(the_case.result);
  }
}
BENCHMARK_CAPTURE(invert_jointly, jumps, "jumps")
    ->Arg(51200)
    ->Arg(1000000)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(invert_jointly, learned, "learned")
    ->Arg(51200)
    ->Arg(1000000)
    ->Unit(benchmark::kMillisecond);

double median_milliseconds(JointCase& the_case, const ForcePrior& prior) {
  std::vector<double> times(50);
  for (double& time : times) {
    const std::clock_t start = std::clock();
    the_case.invert(prior);
    time = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  }
  std::nth_element(times.begin(), times.begin() + 25, times.end());
  return times[25];
}

// samples, rate, σ, noise levels, λ; H_1, H_2, prior's shape; R_1, R_2, force; median processor
// time of an inversion [ms]: all doubles.
int write_case(const char* path, std::size_t samples) {
  JointCase the_case(samples);
  const JumpPrior prior{JumpPrior::Options{}};
  the_case.invert(prior);
  FrequencyGrid grid = FrequencyGrid::of_record(samples, kRate);
  grid.sigma = the_case.inversion.sigma();
  std::vector<double> shape(grid.bins);
  prior.shape({.bins = grid.bins, .samples = samples, .sample_rate = kRate}, shape);
  std::FILE* file = std::fopen(path, "wb");
  if (!file) return 1;
  const auto write = [file](const double* values, std::size_t count) {
    std::fwrite(values, sizeof(double), count, file);
  };
  const double head[] = {static_cast<double>(samples),
                         kRate,
                         grid.sigma,
                         the_case.noise.rms[0],
                         the_case.noise.rms[1],
                         the_case.result.identified.choice.parameter()};
  write(head, std::size(head));
  for (const End end : {End::kLeft, End::kRight}) {
    const auto transfer = reaction_transfer(the_case.basis, 0.03, end, grid);
    write(reinterpret_cast<const double*>(transfer.data()), 2 * transfer.size());
  }
  write(shape.data(), shape.size());
  write(the_case.left.data(), samples);
  write(the_case.right.data(), samples);
  write(the_case.result.identified.force.data(), samples);
  const double time = median_milliseconds(the_case, prior);
  write(&time, 1);
  return std::fclose(file);
}

}  // namespace
}  // namespace modcal

int main(int argc, char** argv) {
  constexpr const char* kFlag = "--write_case=";
  for (int i = 1; i < argc; ++i) {
    if (std::strncmp(argv[i], kFlag, std::strlen(kFlag)) == 0) {
      return modcal::write_case(argv[i] + std::strlen(kFlag), modcal::kSamples);
    }
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
