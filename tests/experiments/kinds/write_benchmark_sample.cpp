// write_benchmark_sample DIR SEEDS writes the report of a made-up benchmark of 39 methods and 8
// noise levels, SEEDS draws each, with players: for the browser's test and for a look at it.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <numbers>

#include "experiments/kinds/benchmark/benchmark.hpp"
#include "experiments/report/report.hpp"
#include "libsim/base/random.hpp"

namespace modcal {
namespace {

constexpr std::size_t kSearches = 13;

BenchmarkOutcome outcome_of(std::size_t method, std::size_t condition, double normal) {
  const double quality = 1.0 + static_cast<double>(method % kSearches);
  BenchmarkOutcome outcome{.stop = StopReason::kSmallStep};
  if (method == 38) return {.failure = "needs residuals"};
  outcome.frequency_bound = condition == 0 ? std::nan("") : 1e-6 * static_cast<double>(condition);
  outcome.frequency_error =
      1e-5 * quality * (1.0 + static_cast<double>(condition)) * std::exp(normal);
  outcome.frequency_rms_error = 1.5 * outcome.frequency_error;
  outcome.contact_error = 1e-5;
  outcome.correlation = 0.7;
  outcome.evaluations = static_cast<std::int64_t>(100.0 * quality * std::exp(0.5 * normal));
  outcome.success = outcome.frequency_error < 5e-4;
  outcome.value = 1.0;
  outcome.truth_value = 0.9;
  for (int i = 0; i < 40; ++i) outcome.trace.emplace_back(1 + 3 * i * i, 1.0 + 10.0 / (1 + i));
  return outcome;
}

BenchmarkGrid grid_of(std::size_t seeds) {
  BenchmarkGrid grid;
  for (const char* objective : {"force_mismatch", "spectral_peak", "contact_location"}) {
    for (std::size_t i = 0; i < kSearches; ++i) {
      grid.searches.push_back("search " + std::to_string(i + 1));
      grid.objectives.push_back(objective);
      grid.methods.push_back(grid.searches.back() + ", " + objective);
    }
  }
  for (const int percent : {0, 1, 2, 3, 4, 5, 8, 10}) {
    grid.conditions.push_back("noise " + std::to_string(percent) + " %");
    grid.noise_levels.push_back(0.01 * percent);
  }
  std::vector<double> normal(seeds);
  std::size_t number = 0;
  for (std::size_t method = 0; method < grid.methods.size(); ++method) {
    for (std::size_t condition = 0; condition < grid.conditions.size(); ++condition) {
      fill_standard_normal(StreamKey(1).with(method).with(condition), normal);
      for (std::size_t seed = 0; seed < seeds; ++seed) {
        BenchmarkTask task{.task = number++,
                           .method = method,
                           .condition = condition,
                           .replicate = std::to_string(seed),
                           .seconds = 1e-3 * std::exp(0.1 * normal[seed]),
                           .outcome = outcome_of(method, condition, normal[seed])};
        if (seed > 0) task.outcome.trace = {};
        grid.tasks.push_back(std::move(task));
      }
    }
  }
  return grid;
}

report::Audio sound() {
  report::Audio audio{
      .id = "sound", .title = "Listen", .caption = "Made up.", .sample_rate = 16000.0};
  for (const double frequency : {196.0, 392.0}) {
    report::Track track{.label = std::to_string(static_cast<int>(frequency)) + " Hz"};
    for (int i = 0; i < 8000; ++i) {
      track.samples.push_back(std::sin(2.0 * std::numbers::pi * frequency * i / 16000.0));
    }
    audio.tracks.push_back(std::move(track));
  }
  return audio;
}

report::Report report_of(const BenchmarkGrid& grid) {
  const std::vector<BenchmarkCell> cells = benchmark_cells(grid);
  report::Report report{.title = "Made-up benchmark", .command = "modcal run made-up.yaml"};
  report.replay = "modcal replay out/made-up";
  report::Section section{.title = "Results"};
  std::string text;
  for (const std::string& sentence : recommendations(grid, cells)) text += sentence + "\n\n";
  section.blocks.emplace_back(report::Text{text});
  section.blocks.emplace_back(success_map(grid, cells));
  section.blocks.emplace_back(bound_map(grid, cells));
  for (report::Figure figure :
       {error_figure(grid, cells), data_profile(grid), performance_profile(grid),
        work_precision_figure(grid, cells), waterfall_figure(grid), trace_figure(grid)}) {
    section.blocks.emplace_back(std::move(figure));
  }
  section.blocks.emplace_back(benchmark_table(grid, cells));
  section.blocks.emplace_back(sound());
  report.sections.push_back(std::move(section));
  return report;
}

}  // namespace
}  // namespace modcal

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: write_benchmark_sample DIR SEEDS\n", stderr);
    return 2;
  }
  try {
    const auto seeds = static_cast<std::size_t>(std::strtoul(argv[2], nullptr, 10));
    const modcal::BenchmarkGrid grid = modcal::grid_of(seeds);
    const auto written =
        modcal::report::write_report(modcal::report_of(grid), argv[1], {.vector_figures = false});
    std::printf("%zu tasks: %s\n", grid.tasks.size(), written.page.c_str());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
