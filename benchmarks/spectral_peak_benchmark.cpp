// The paper's full refinement of the modal frequencies: 10 loops x 50 modes x 50 candidates x 2
// sides over bands of ±4 %, on one second of the bowed string at 51.2 kHz, started from frequencies
// off by up to 2 %. The same with settled modes left out, on records with so many percent of noise,
// against the whole search on the same records. With --write_case=FILE the data and the frequencies
// found go to a file that peers/spectral_peak_search.py reads.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <cstring>
#include <string_view>

#include "libcalib/calibration.hpp"
#include "libcalib/optimizers/systematic_search.hpp"
#include "libsim/base/random.hpp"
#include "libsim/dynamics/fixed_step/fixed_step.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

constexpr double kRate = 51200.0;

struct Case {
  ModelPoint truth;
  ModelPoint initial;
  std::vector<double> left, right;
  CalibrationData data;
};

void add_noise(std::vector<double>& samples, double share, std::string_view end) {
  std::vector<double> noise(samples.size());
  fill_standard_normal(StreamKey(1).with("measurement noise").with(end), noise);
  const double deviation = share * standard_deviation(samples);
  for (std::size_t j = 0; j < noise.size(); ++j) samples[j] += deviation * noise[j];
  remove_mean(samples);
}

// Every frequency off by up to 2 %.
ModelPoint with_errors(const ModelPoint& truth, std::uint64_t seed) {
  std::vector<double> draw(truth.basis.size()), frequencies;
  fill_uniform(StreamKey(seed).with("frequency errors"), draw);
  for (std::size_t n = 0; n < draw.size(); ++n) {
    frequencies.push_back(truth.basis.frequency(n) * (1.0 + 0.02 * (2.0 * draw[n] - 1.0)));
  }
  return {with_frequencies(truth.basis, frequencies), truth.contact};
}

Case make_case(double noise) {
  Scene scene;
  scene.string.length = 0.33;
  scene.string.linear_density = 3.1e-3;
  scene.string.fundamental = 196.0;
  scene.bow.position = 0.03;
  const Simulation run =
      ModalExact(ModalExact::Options{})
          .simulate(scene, kRate, {.left_reaction = true, .right_reaction = true});
  Case result{.truth = {make_modal_basis(scene.string), scene.bow.position},
              .left = run.left_reaction.samples,
              .right = run.right_reaction.samples};
  add_noise(result.left, noise, "left");
  add_noise(result.right, noise, "right");
  result.initial = with_errors(result.truth, 1);
  result.data = CalibrationData::of_records(result.left, result.right, kRate);
  return result;
}

const Case& the_case() {
  static const Case value = make_case(0.0);
  return value;
}

// All 50 frequencies, blind modes included: the work the paper describes.
CalibrationOptions all_modes(bool skip_settled = false) {
  CalibrationOptions options = calibration_of_the_paper();
  options.optimizer =
      Choice<Optimizer>::of<ModeByMode>("mode_by_mode", {.skip_settled = skip_settled});
  options.excitation_threshold = 0.0;
  return options;
}

double median_error(const CalibrationResult& result, const ModelPoint& truth) {
  std::vector<double> errors;
  for (std::size_t n = 0; n < result.modes.size(); ++n) {
    if (std::abs(result.modes[n].shape) < 0.1) continue;
    errors.push_back(std::abs(result.modes[n].frequency / truth.basis.frequency(n) - 1.0));
  }
  return quantile(errors, 0.5);
}

void refine_frequencies(benchmark::State& state) {
  const Case& the = the_case();
  const CalibrationOptions options = all_modes();
  CalibrationResult result;
  for (auto _ : state) {
    result = calibrate(the.initial, the.data, options);
    benchmark::DoNotOptimize(result);
  }
  state.counters["median_error"] = median_error(result, the.truth);
  state.counters["evaluations"] = static_cast<double>(result.search.evaluations);
}

// What 20 starts leave out, and where they end without and with it: median errors of the excited
// modes, share of them that end on another candidate, and share that end more than a step apart.
void compare(const Case& the, benchmark::State& state) {
  constexpr std::uint64_t kStarts = 20;
  double made = 0.0, all = 0.0, modes = 0.0, other = 0.0, farther = 0.0;
  double whole_error = 0.0, error = 0.0;
  for (std::uint64_t seed = 1; seed <= kStarts; ++seed) {
    const ModelPoint initial = with_errors(the.truth, seed);
    const CalibrationResult whole = calibrate(initial, the.data, all_modes());
    const CalibrationResult result = calibrate(initial, the.data, all_modes(true));
    whole_error += median_error(whole, the.truth) / kStarts;
    error += median_error(result, the.truth) / kStarts;
    all += static_cast<double>(whole.search.evaluations);
    made += static_cast<double>(result.search.evaluations);
    for (std::size_t n = 0; n < whole.modes.size(); ++n) {
      if (std::abs(whole.modes[n].shape) < 0.1) continue;
      const double steps =
          std::abs(result.modes[n].frequency / whole.modes[n].frequency - 1.0) / (0.06 / 49.0);
      modes += 1.0;
      // Half a step is the least by which two candidates of the last two loops differ.
      other += steps > 0.01 ? 1.0 : 0.0;
      farther += steps > 1.01 ? 1.0 : 0.0;
    }
  }
  state.counters["searched"] = made / all;
  state.counters["other"] = other / modes;
  state.counters["farther"] = farther / modes;
  state.counters["median_error"] = error;
  state.counters["median_error_whole"] = whole_error;
}

// Arguments: percent of noise; whether settled modes are left out.
void refine_noisy(benchmark::State& state) {
  const Case the = make_case(1e-2 * static_cast<double>(state.range(0)));
  const CalibrationOptions options = all_modes(state.range(1) != 0);
  for (auto _ : state) benchmark::DoNotOptimize(calibrate(the.initial, the.data, options));
  if (state.range(1) != 0) compare(the, state);
}

BENCHMARK(refine_frequencies)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(refine_noisy)
    ->ArgNames({"noise", "skip"})
    ->ArgsProduct({{0, 1, 5, 10}, {0, 1}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

// Raw doubles: K, f_s, N, x_c, L, T, m, zeta; initial f, found f (N each); R1, R2 (K each).
void write_case(const char* path) {
  const Case& the = the_case();
  const CalibrationResult result = calibrate(the.initial, the.data, all_modes());
  const ModalBasis& basis = the.initial.basis;
  std::vector<double> numbers = {static_cast<double>(the.left.size()),
                                 kRate,
                                 static_cast<double>(basis.size()),
                                 the.initial.contact,
                                 basis.length,
                                 basis.tension,
                                 basis.mass[0],
                                 basis.zeta[0]};
  for (const auto& mode : result.modes) numbers.push_back(mode.initial_frequency);
  for (const auto& mode : result.modes) numbers.push_back(mode.frequency);
  numbers.insert(numbers.end(), the.left.begin(), the.left.end());
  numbers.insert(numbers.end(), the.right.begin(), the.right.end());
  std::FILE* file = std::fopen(path, "wb");
  const bool ok = file != nullptr && std::fwrite(numbers.data(), sizeof(double), numbers.size(),
                                                 file) == numbers.size();
  if (file == nullptr || std::fclose(file) != 0 || !ok) {
    std::perror(path);
    std::exit(1);
  }
}

}  // namespace
}  // namespace modcal

int main(int argc, char** argv) {
  constexpr std::string_view kWrite = "--write_case=";
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]).starts_with(kWrite)) {
      modcal::write_case(argv[i] + kWrite.size());
      return 0;
    }
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
