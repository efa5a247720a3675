#include "experiments/cli/runner.hpp"

#include <tbb/global_control.h>

#include <cstdio>

#include "experiments/cli/command.hpp"
#include "libsim/base/utf8.hpp"
#include "libsim/records/record_file.hpp"

namespace modcal {
namespace {

std::optional<tbb::global_control> limit_threads(int threads) {
  if (threads <= 0) return std::nullopt;
  return std::optional<tbb::global_control>(std::in_place,
                                            tbb::global_control::max_allowed_parallelism,
                                            static_cast<std::size_t>(threads));
}

std::string title_of(const LoadedExperiment& loaded) {
  return loaded.title.empty() ? loaded.kind : loaded.title;
}

std::filesystem::path folder_of(const LoadedExperiment& loaded, const RunSettings& settings) {
  const std::filesystem::path folder =
      settings.folder.empty() ? loaded.document.folder() : settings.folder;
  return folder.empty() ? "." : folder;
}

// Calls work(context) with the progress shown and Ctrl-C polled.
template <typename Work>
auto with_context(const LoadedExperiment& loaded, const std::filesystem::path& folder,
                  const std::string& command, SharedWork& shared, const Work& work) {
  Progress progress(title_of(loaded));
  return work(StudyContext{.work = shared,
                           .folder = folder,
                           .command = command,
                           .progress = [&progress](double share) { progress.report(share); },
                           .stop = interrupt_token()});
}

void write_signal_file(const OutputDirectory& out, const SignalFile& file) {
  const std::filesystem::path path = out.note(file.name);
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

// Counts of a list, "312 of 560 tasks done, 2 failed"; empty where the experiment is no list.
std::string status_text(const LoadedExperiment& loaded, const StudyResult& result) {
  const auto* list = dynamic_cast<const TaskExperiment*>(loaded.experiment.get());
  if (list == nullptr) return {};
  const std::size_t all = list->task_count();
  std::string text = fmt::format("{} of {} tasks done", all - result.pending_tasks, all);
  if (result.failed_tasks > 0) text += fmt::format(", {} failed", result.failed_tasks);
  return text;
}

// Every default written out; reads back to the same experiment from the folder that is named.
std::string resolved_text(const LoadedExperiment& loaded, const std::filesystem::path& folder) {
  return fmt::format("# {} with every default written out. Relative paths start at {}.\n{}",
                     loaded.document.file, folder.string(), loaded.resolved());
}

void record_run(const LoadedExperiment& loaded, const RunSettings& settings,
                const std::filesystem::path& folder, const OutputDirectory& out) {
  out.write_text("resolved.yaml", resolved_text(loaded, folder));
  nlohmann::ordered_json provenance = provenance_json(settings.command);
  const std::string absolute = std::filesystem::absolute(folder / "").lexically_normal().string();
  MODCAL_REQUIRE(first_not_utf8(absolute) == std::string::npos,
                 "the folder {} has a name that is not UTF-8 text: rename it", absolute);
  provenance["folder"] = absolute;
  provenance["seeds"] = seeds_json(loaded);
  out.write_text("provenance.json", json_text(provenance));
}

ExitCode exit_code_of(const StudyResult& result) {
  if (result.status == report::Status::kFailed) return ExitCode::kNothingMeasured;
  return result.failed_tasks > 0 ? ExitCode::kSomeTasksFailed : ExitCode::kOk;
}

void finish_report(report::Report report, const RunSettings& settings, const OutputDirectory& out) {
  report.command = settings.command;
  report.provenance = provenance_lines(settings.command);
  const report::WrittenReport written = report::write_report(report, out.path());
  if (!written.warning.empty()) complain("warning: {}\n", written.warning);
  complain("report: {}\n", written.page.string());
}

[[noreturn]] void say_interrupted(const RunSettings& settings, bool has_store) {
  complain("\ninterrupted; {} with:\n  {}{}\n",
           has_store ? "what is finished is kept, go on" : "run again", settings.command,
           settings.shard.is_whole() ? "" : " --shard " + settings.shard.text());
  throw Interrupted();
}

void print_summary(const StudyResult& result, const RunSettings& settings, double seconds) {
  if (!settings.json) {
    say_text(result.summary);
    return;
  }
  const nlohmann::ordered_json summary = {{"out", settings.out.string()},
                                          {"seconds", seconds},
                                          {"failed_tasks", result.failed_tasks},
                                          {"missed", result.missed},
                                          {"summary", result.summary}};
  print_json(summary);
}

// Goes on where the store ends. A shard's result says how many tasks are left; nobody reads more.
StudyResult run_list(const TaskExperiment& list, const StudyContext& context, RunStore& store,
                     const Shard& shard) {
  for (const JournalDamage& damage : store.finished().damages()) {
    complain("warning: {}\n", message_of(damage));
  }
  return list.sum_up(run_tasks(list, context, &store, shard), context);
}

PilotRun run_some_tasks(const TaskExperiment& list, const StudyContext& context, RunStore& store) {
  constexpr std::size_t kMost = 20;
  constexpr double kSeconds = 10.0;
  std::vector<std::size_t> pending;
  for (std::size_t task = 0; task < list.task_count(); ++task) {
    const std::string key = store.finished().key_of(list.fingerprint(task, context.folder));
    if (!store.finished().find(key).is_known()) pending.push_back(task);
  }
  MODCAL_REQUIRE(!pending.empty(), "all {} tasks are done: nothing is left to share out",
                 list.task_count());
  PilotRun pilot;
  const std::size_t count = std::min(kMost, pending.size());
  double seconds = 0.0;
  while (pilot.run < count && (pilot.run == 0 || seconds < kSeconds)) {
    context.throw_if_interrupted();
    const std::size_t task = pending[pilot.run * pending.size() / count];
    const Stopwatch clock;
    std::string outcome = list.run_task(task, context);
    const double taken = clock.seconds();
    store.append({store.finished().key_of(list.fingerprint(task, context.folder)), task, taken,
                  std::move(outcome)});
    seconds += taken;
    ++pilot.run;
  }
  pilot.pending = pending.size() - pilot.run;
  pilot.seconds_per_task = seconds / static_cast<double>(pilot.run);
  return pilot;
}

}  // namespace

ExitCode present(const LoadedExperiment& loaded, StudyResult result, const RunSettings& settings,
                 double seconds) {
  result.state_command(settings.command);
  const OutputDirectory out(settings.out);
  write_files(out, result);
  print_summary(result, settings, seconds);
  report::Report report;
  report.title = title_of(loaded);
  report.description = loaded.description;
  report.status = result.status;
  report.status_text = status_text(loaded, result);
  report.sections.push_back({"Results", std::move(result.blocks)});
  if (dynamic_cast<const TaskExperiment*>(loaded.experiment.get()) != nullptr) {
    report.replay = "modcal replay " + shell_word(settings.out.string());
  }
  finish_report(std::move(report), settings, out);
  out.require_in_place();
  const ExitCode code = exit_code_of(result);
  return code == ExitCode::kOk && !result.missed.empty() ? ExitCode::kAcceptanceMissed : code;
}

PilotRun run_pilot(const LoadedExperiment& loaded, const RunSettings& settings) {
  const auto* list = dynamic_cast<const TaskExperiment*>(loaded.experiment.get());
  MODCAL_REQUIRE(list != nullptr, "kind {} is no list of tasks: there is nothing to share out",
                 loaded.kind);
  const OutputDirectory out(settings.out);
  RunStore store(out.path(), Shard{}, program_identity());
  const std::filesystem::path folder = folder_of(loaded, settings);
  record_run(loaded, settings, folder, out);
  SharedWork work;
  return with_context(loaded, folder, settings.command, work, [&](const StudyContext& context) {
    return run_some_tasks(*list, context, store);
  });
}

ExitCode run_one(const LoadedExperiment& loaded, const RunSettings& settings) {
  const Stopwatch clock;
  const OutputDirectory out(settings.out);
  const auto* list = dynamic_cast<const TaskExperiment*>(loaded.experiment.get());
  MODCAL_REQUIRE(list != nullptr || settings.shard.is_whole(),
                 "kind {} is no list of tasks and cannot be run in shards; leave out --shard",
                 loaded.kind);
  std::optional<RunStore> store;
  if (list != nullptr) store.emplace(out.path(), settings.shard, program_identity());
  const std::filesystem::path folder = folder_of(loaded, settings);
  SharedWork work(interrupt_token());
  // After the token and before the work: an interrupted run says what it was and how to go on.
  record_run(loaded, settings, folder, out);
  const auto limit = limit_threads(settings.threads);
  StudyResult result;
  try {
    result = with_context(loaded, folder, settings.command, work, [&](const StudyContext& context) {
      return list != nullptr ? run_list(*list, context, *store, settings.shard)
                             : loaded.experiment->run(context);
    });
  } catch (const Interrupted&) {
    say_interrupted(settings, store.has_value());
  }
  // Work that does not poll ends by itself; what the user wanted to stop is not written either.
  if (interrupted()) say_interrupted(settings, store.has_value());
  const double seconds = clock.seconds();
  complain("{:.2f} s\n", seconds);
  if (settings.shard.is_whole()) {
    // What was found is written, even where what was written before is gone.
    const ExitCode code = present(loaded, std::move(result), settings, seconds);
    out.require_in_place();
    return code;
  }
  out.require_in_place();
  say("shard {}: {} of {} tasks of the whole list are done; report with:\n  modcal report {}\n",
      settings.shard.text(), list->task_count() - result.pending_tasks, list->task_count(),
      settings.out.string());
  return result.failed_tasks > 0 ? ExitCode::kSomeTasksFailed : ExitCode::kOk;
}

ExitCode run_together(const std::vector<LoadedExperiment>& experiments,
                      const RunSettings& settings) {
  const Stopwatch clock;
  const OutputDirectory out(settings.out);
  const auto limit = limit_threads(settings.threads);
  SharedWork work(interrupt_token());
  report::Report report;
  report.title = settings.title;
  ExitCode worst = ExitCode::kOk;
  bool missed = false;
  for (const LoadedExperiment& loaded : experiments) {
    if (interrupted()) say_interrupted(settings, false);
    const std::string name = stem_of(loaded.document.file);
    const OutputDirectory folder(out.path() / name);
    StudyResult result;
    try {
      const std::string command = fmt::format("modcal run {}", loaded.document.file);
      result = with_context(
          loaded, loaded.document.folder(), command, work,
          [&](const StudyContext& context) { return loaded.experiment->run(context); });
      result.state_command(command);
    } catch (const Interrupted&) {
      say_interrupted(settings, false);
    }
    folder.write_text("resolved.yaml", resolved_text(loaded, folder_of(loaded, settings)));
    write_files(folder, result);
    say("== {}: {}\n{}", name, loaded.title, result.summary);
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
  out.write_text("provenance.json", json_text(provenance_json(settings.command)));
  finish_report(std::move(report), settings, out);
  out.require_in_place();
  complain("{:.2f} s\n", clock.seconds());
  return worst == ExitCode::kOk && missed ? ExitCode::kAcceptanceMissed : worst;
}

}  // namespace modcal
