// The paper's full refinement of the modal frequencies: 10 loops x 50 modes x 50 candidates x 2
// sides over bands of ±4 %, on one second of the bowed string at 51.2 kHz, started from frequencies
// off by up to 2 %. With --write_case=FILE the data and the frequencies found go to a file that
// peers/spectral_peak_search.py reads.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <cstring>
#include <string_view>

#include "libcalib/calibration.hpp"
#include "libsim/base/random.hpp"
#include "libsim/dynamics/simulators/modal_exact.hpp"
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

Case make_case() {
  Scene scene;
  scene.string.length = 0.33;
  scene.string.linear_density = 3.1e-3;
  scene.string.fundamental = 196.0;
  scene.bow.position = 0.03;
  Simulation run = ModalExact(ModalExact::Options{})
                       .simulate(scene, kRate, {.left_reaction = true, .right_reaction = true});
  remove_mean(run.left_reaction.samples);
  remove_mean(run.right_reaction.samples);
  Case result{.truth = {make_modal_basis(scene.string), scene.bow.position},
              .left = run.left_reaction.samples,
              .right = run.right_reaction.samples};
  std::vector<double> draw(result.truth.basis.size()), frequencies;
  fill_uniform(StreamKey(1).with("frequency errors"), draw);
  for (std::size_t n = 0; n < draw.size(); ++n) {
    frequencies.push_back(result.truth.basis.frequency(n) * (1.0 + 0.02 * (2.0 * draw[n] - 1.0)));
  }
  result.initial = {with_frequencies(result.truth.basis, frequencies), result.truth.contact};
  result.data = CalibrationData::of_records(result.left, result.right, kRate);
  return result;
}

const Case& the_case() {
  static const Case value = make_case();
  return value;
}

// All 50 frequencies, blind modes included: the work the paper describes.
CalibrationOptions all_modes() {
  CalibrationOptions options;
  options.parameters.frequencies = "all";
  options.excitation_threshold = 0.0;
  return options;
}

void refine_frequencies(benchmark::State& state) {
  const Case& the = the_case();
  const CalibrationOptions options = all_modes();
  CalibrationResult result;
  for (auto _ : state) {
    result = calibrate(the.initial, the.data, options);
    benchmark::DoNotOptimize(result);
  }
  std::vector<double> errors;
  for (std::size_t n = 0; n < result.modes.size(); ++n) {
    if (std::abs(result.modes[n].shape) < 0.1) continue;
    errors.push_back(std::abs(result.modes[n].frequency / the.truth.basis.frequency(n) - 1.0));
  }
  state.counters["median_error"] = quantile(errors, 0.5);
  state.counters["evaluations"] = static_cast<double>(result.search.evaluations);
}
BENCHMARK(refine_frequencies)->Unit(benchmark::kMillisecond)->UseRealTime();

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
