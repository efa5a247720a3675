#include "experiments/cli/runner.hpp"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <chrono>
#include <cstdio>
#include <optional>

#include "experiments/cli/interrupt.hpp"
#include "experiments/cli/output_directory.hpp"
#include "experiments/cli/progress.hpp"
#include "experiments/cli/provenance.hpp"
#include "experiments/records/csv_writer.hpp"
#include "experiments/records/wav_writer.hpp"
#include "experiments/report/write_report.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

std::optional<tbb::global_control> limit_threads(int threads) {
  if (threads <= 0) return std::nullopt;
  return std::optional<tbb::global_control>(std::in_place,
                                            tbb::global_control::max_allowed_parallelism,
                                            static_cast<std::size_t>(threads));
}

StudyResult run_experiment(const LoadedExperiment& loaded, const std::string& command,
                           SharedWork& work) {
  Progress progress(loaded.title.empty() ? loaded.kind : loaded.title);
  const StudyContext context{.work = work,
                             .folder = loaded.document.folder(),
                             .command = command,
                             .progress = [&progress](double share) { progress.report(share); },
                             .interrupted = [] { return interrupted(); }};
  return loaded.experiment->run(context);
}

void write_signal_file(const OutputDirectory& out, const SignalFile& file) {
  const std::filesystem::path path = out.path() / file.name;
  if (path.extension() == ".wav") {
    write_wav(path, file.signals, {.samples = WavSamples::kDouble, .full_scale = file.full_scale});
  } else {
    write_csv(path, file.signals, {.provenance = {version_text()}});
  }
}

void write_files(const OutputDirectory& out, const StudyResult& result) {
  for (const auto& [name, content] : result.files) out.write_text(name, content);
  for (const SignalFile& file : result.signal_files) write_signal_file(out, file);
}

// Every default written out; reads back to the same experiment from the folder that is named.
std::string resolved_text(const LoadedExperiment& loaded) {
  const std::filesystem::path folder = loaded.document.folder();
  return fmt::format("# {} with every default written out. Relative paths start at {}.\n{}",
                     loaded.document.file, folder.empty() ? "." : folder.string(),
                     loaded.resolved());
}

ExitCode exit_code_of(const StudyResult& result) {
  if (result.status == report::Status::kFailed) return ExitCode::kNothingMeasured;
  return result.failed_tasks > 0 ? ExitCode::kSomeTasksFailed : ExitCode::kOk;
}

void finish_report(report::Report report, const RunSettings& settings, const OutputDirectory& out) {
  report.command = settings.command;
  report.provenance = provenance_lines(settings.command);
  const report::WrittenReport written = report::write_report(report, out.path());
  if (!written.warning.empty()) fmt::print(stderr, "warning: {}\n", written.warning);
  fmt::print(stderr, "report: {}\n", written.page.string());
}

[[noreturn]] void say_interrupted(const RunSettings& settings) {
  fmt::print(stderr, "\ninterrupted; run again with:\n  {}\n", settings.command);
  throw Interrupted();
}

void print_summary(const StudyResult& result, const RunSettings& settings, double seconds) {
  if (!settings.json) {
    fmt::print("{}", result.summary);
    return;
  }
  const nlohmann::ordered_json summary = {{"out", settings.out.string()},
                                          {"seconds", seconds},
                                          {"failed_tasks", result.failed_tasks},
                                          {"missed", result.missed},
                                          {"summary", result.summary}};
  fmt::print("{}\n", summary.dump(2));
}

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

ExitCode run_one(const LoadedExperiment& loaded, const RunSettings& settings) {
  const auto start = std::chrono::steady_clock::now();
  const OutputDirectory out(settings.out);
  // Before the work, so that an interrupted run says what it was.
  out.write_text("resolved.yaml", resolved_text(loaded));
  nlohmann::ordered_json provenance = provenance_json(settings.command);
  provenance["seeds"] = seeds_json(loaded);
  out.write_text("provenance.json", provenance.dump(2) + "\n");
  const auto limit = limit_threads(settings.threads);
  SharedWork work;
  StudyResult result;
  try {
    result = run_experiment(loaded, settings.command, work);
  } catch (const Interrupted&) {
    say_interrupted(settings);
  }
  // Work that does not poll ends by itself; what the user wanted to stop is not written either.
  if (interrupted()) say_interrupted(settings);
  write_files(out, result);
  print_summary(result, settings, seconds_since(start));
  report::Report report;
  report.title = loaded.title.empty() ? loaded.kind : loaded.title;
  report.description = loaded.description;
  report.status = result.status;
  report.sections.push_back({"Results", result.blocks});
  finish_report(std::move(report), settings, out);
  fmt::print(stderr, "{:.2f} s\n", seconds_since(start));
  const ExitCode code = exit_code_of(result);
  return code == ExitCode::kOk && !result.missed.empty() ? ExitCode::kAcceptanceMissed : code;
}

ExitCode run_together(const std::vector<LoadedExperiment>& experiments,
                      const RunSettings& settings) {
  const auto start = std::chrono::steady_clock::now();
  const OutputDirectory out(settings.out);
  const auto limit = limit_threads(settings.threads);
  SharedWork work;
  report::Report report;
  report.title = settings.title;
  ExitCode worst = ExitCode::kOk;
  bool missed = false;
  for (const LoadedExperiment& loaded : experiments) {
    if (interrupted()) say_interrupted(settings);
    const std::string name = std::filesystem::path(loaded.document.file).stem().string();
    const OutputDirectory folder(out.path() / name);
    StudyResult result;
    try {
      result = run_experiment(loaded, fmt::format("modcal run {}", loaded.document.file), work);
    } catch (const Interrupted&) {
      say_interrupted(settings);
    }
    folder.write_text("resolved.yaml", resolved_text(loaded));
    write_files(folder, result);
    fmt::print("== {}: {}\n{}", name, loaded.title, result.summary);
    for (report::Block& block : result.blocks) {
      // Ids are unique in one report: each table carries the name of its experiment.
      if (auto* table = std::get_if<report::Table>(&block)) {
        if (table->id != name) table->id = name + "_" + table->id;
      }
    }
    report.sections.push_back(
        {fmt::format("{}: {}", name, loaded.title), std::move(result.blocks)});
    if (result.status != report::Status::kOk) report.status = report::Status::kSomeFailed;
    worst = std::max(worst, exit_code_of(result));
    missed = missed || !result.missed.empty();
  }
  out.write_text("provenance.json", provenance_json(settings.command).dump(2) + "\n");
  finish_report(std::move(report), settings, out);
  fmt::print(stderr, "{:.2f} s\n", seconds_since(start));
  return worst == ExitCode::kOk && missed ? ExitCode::kAcceptanceMissed : worst;
}

}  // namespace modcal
