#include "experiments/cli/runner.hpp"

#include <tbb/global_control.h>

#include <algorithm>
#include <cstdio>
#include <set>

#include "experiments/cli/command.hpp"
#include "experiments/cli/write_results.hpp"
#include "libsim/base/stop_scope.hpp"

namespace modcal {
namespace {

std::optional<tbb::global_control> limit_threads(int threads) {
  if (threads <= 0) return std::nullopt;
  return std::optional<tbb::global_control>(std::in_place,
                                            tbb::global_control::max_allowed_parallelism,
                                            static_cast<std::size_t>(threads));
}

// Calls work(context) with the progress shown and Ctrl-C polled.
template <typename Work>
auto with_context(const LoadedExperiment& loaded, const std::filesystem::path& folder,
                  const std::string& command, SharedWork& shared, const Work& work) {
  const bool is_list = dynamic_cast<const TaskExperiment*>(loaded.experiment.get()) != nullptr;
  Progress progress(title_of(loaded), is_list ? Progress::Of::kList : Progress::Of::kOne);
  const StopToken stop = interrupt_token();
  const StopScope listening(stop);
  return work(StudyContext{.work = shared,
                           .folder = folder,
                           .command = command,
                           .progress = [&progress](double share) { progress.report(share); },
                           .stop = stop});
}

[[noreturn]] void say_interrupted(const RunSettings& settings, bool has_store) {
  hint_text(fmt::format("\ninterrupted; {} with:\n  {}{}\n",
                        has_store ? "what is finished is kept, go on" : "run again",
                        settings.command,
                        settings.shard.is_whole() ? "" : " --shard " + settings.shard.text()));
  throw Interrupted();
}

// Goes on where the store ends. A shard's result says how many tasks are left; nobody reads more.
StudyResult run_list(const TaskExperiment& list, const StudyContext& context, RunStore& store,
                     const Shard& shard) {
  for (const JournalDamage& damage : store.finished().damages()) {
    warn("{}", message_of(damage));
  }
  return list.sum_up(run_tasks(list, context, &store, shard), context);
}

// Of the files that the results of a list have whatever its tasks give.
std::vector<std::string> names_of_list(const TaskExperiment& list,
                                       const std::filesystem::path& folder) {
  SharedWork none;
  report::Report report;
  StudyResult empty =
      list.sum_up(TaskOutcomes(list.task_count()), {.work = none, .folder = folder});
  std::vector<std::string> names = names_of(empty);
  report.sections.push_back({.blocks = std::move(empty.blocks)});
  for (std::string& name : report::file_names(report)) names.push_back(std::move(name));
  return names;
}

// Whether what stands in the folder is of these settings and this program.
bool is_same_run(const LoadedExperiment& loaded, const OutputDirectory& out) {
  return out.program() == program_identity() && out.holds_resolved(loaded.resolved());
}

// Settings whose results do not stand yet.
void begin_run(const LoadedExperiment& loaded, const RunSettings& settings, OutputDirectory& out) {
  if (!is_same_run(loaded, out)) out.make_way();
  record_run(loaded, settings, out);
}

// The folder with one of each name below it: what is in the way is found before anything is run.
OutputDirectory begin_together(const std::vector<std::string>& names, const RunSettings& settings) {
  OutputDirectory out(settings.out);
  for (const std::string& name : names) OutputDirectory(settings.out / name);
  if (!out.has_provenance()) out.write_provenance(provenance_json(settings.command));
  out.announce_folders(names);
  return out;
}

// Ids are unique in one report: tables and figures carry the name of their experiment.
void add_section(const std::string& name, const std::string& title, StudyResult& result,
                 report::Report& report) {
  const auto name_it = [&name](std::string& id) {
    if (id != name && !id.starts_with(name + "_")) id = name + "_" + id;
  };
  for (report::Block& block : result.blocks) {
    if (auto* table = std::get_if<report::Table>(&block)) name_it(table->id);
    if (auto* figure = std::get_if<report::Figure>(&block)) name_it(figure->id);
  }
  if (!result.answer.empty()) result.add_first(report::Text{result.answer});
  result.move_to(report, fmt::format("{}: {}", name, title), fmt::format("Details of {}", name));
}

// Of one experiment among several, for --json.
nlohmann::ordered_json answer_of_one(const std::string& name, const OutputDirectory& folder,
                                     const StudyResult& result) {
  nlohmann::ordered_json answer = {{"name", name}, {"out", folder.path().string()}};
  answer.update(findings_json(result));
  for (const std::string& text : result.warnings) note_warning(fmt::format("{}: {}", name, text));
  return answer;
}

PilotRun run_some_tasks(const TaskExperiment& list, const StudyContext& context, RunStore& store) {
  constexpr std::size_t kMost = 20;
  constexpr double kSeconds = 10.0;
  std::vector<std::size_t> pending;
  for (std::size_t task = 0; task < list.task_count(); ++task) {
    const std::string key = store.finished().key_of(list.fingerprint(task, context.folder));
    if (!store.finished().find(key).is_known()) pending.push_back(task);
  }
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
  std::set<std::size_t> done;
  for (std::size_t i = 0; i < pilot.run; ++i) done.insert(pending[i * pending.size() / count]);
  std::ranges::copy_if(pending, std::back_inserter(pilot.pending),
                       [&done](std::size_t task) { return !done.contains(task); });
  if (pilot.run > 0) pilot.seconds_per_task = seconds / static_cast<double>(pilot.run);
  return pilot;
}

}  // namespace

PilotRun run_pilot(const LoadedExperiment& loaded, const RunSettings& settings) {
  const auto* list = dynamic_cast<const TaskExperiment*>(loaded.experiment.get());
  MODCAL_REQUIRE(list != nullptr, "kind {} is no list of tasks: there is nothing to share out",
                 loaded.kind);
  OutputDirectory out(settings.out);
  const std::filesystem::path folder = folder_of(loaded, settings);
  out.require_own(names_of_list(*list, folder));
  RunStore store(out.path(), Shard{}, program_identity());
  const FolderLock working(out.path(), Shard{});
  begin_run(loaded, settings, out);
  SharedWork work;
  PilotRun pilot = with_context(
      loaded, folder, settings.command, work,
      [&](const StudyContext& context) { return run_some_tasks(*list, context, store); });
  MODCAL_REQUIRE(
      !pilot.pending.empty(),
      "all {} tasks are done: nothing is left to share out; report with:\n  modcal report {}",
      list->task_count(), shell_word(settings.out.string()));
  return pilot;
}

ExitCode run_one(const LoadedExperiment& loaded, const RunSettings& settings) {
  const Stopwatch clock;
  OutputDirectory out(settings.out);
  const auto* list = dynamic_cast<const TaskExperiment*>(loaded.experiment.get());
  MODCAL_REQUIRE(list != nullptr || settings.shard.is_whole(),
                 "kind {} is no list of tasks and cannot be run in shards; leave out --shard",
                 loaded.kind);
  std::optional<RunStore> store;
  const std::filesystem::path folder = folder_of(loaded, settings);
  if (list != nullptr) {
    out.require_own(names_of_list(*list, folder));
    store.emplace(out.path(), settings.shard, program_identity());
  }
  const FolderLock working(out.path(), settings.shard);
  SharedWork work(interrupt_token());
  Beside beside;
  beside.database = list != nullptr && is_same_run(loaded, out);
  // The journal of a list needs its settings at once. Other results keep theirs until they are
  // replaced.
  beside.settings = list != nullptr || !std::filesystem::exists(out.path() / report::kPageFile);
  // After the token and before the work: an interrupted run says what it was and how to go on.
  if (beside.settings) begin_run(loaded, settings, out);
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
  remark("{:.2f} s\n", seconds);
  if (settings.shard.is_whole()) {
    // What was found is written, even where what was written before is gone.
    const std::exception_ptr lost = out.what_is_lost();
    const ExitCode code = write_results(loaded, std::move(result), settings, seconds, beside);
    if (lost) std::rethrow_exception(lost);
    return code;
  }
  out.require_in_place();
  add_to_json("done", list->task_count() - result.pending_tasks);
  add_to_json("tasks", list->task_count());
  say("shard {}: {} of {} tasks of the whole list are done; report with:\n  modcal report {}\n",
      settings.shard.text(), list->task_count() - result.pending_tasks, list->task_count(),
      shell_word(settings.out.string()));
  print_failures(loaded, result, settings);
  return result.failed_tasks > 0 ? ExitCode::kSomeTasksFailed : ExitCode::kOk;
}

ExitCode run_together(const std::vector<LoadedExperiment>& experiments,
                      const RunSettings& settings) {
  const Stopwatch clock;
  std::vector<std::string> names;
  for (const LoadedExperiment& one : experiments) names.push_back(stem_of(one.document.file));
  const FolderLock working(OutputDirectory(settings.out).path(), settings.shard);
  const OutputDirectory before = begin_together(names, settings);
  const auto limit = limit_threads(settings.threads);
  SharedWork work(interrupt_token());
  report::Report report;
  report.title = settings.title;
  ExitCode worst = ExitCode::kOk;
  bool missed = false, apart = false;
  auto found = nlohmann::ordered_json::array();
  for (const LoadedExperiment& loaded : experiments) {
    if (interrupted()) say_interrupted(settings, false);
    const std::string name = stem_of(loaded.document.file);
    const std::string command = fmt::format("modcal run {}", shell_word(loaded.document.file));
    StudyResult result;
    try {
      result = with_context(
          loaded, loaded.document.folder(), command, work,
          [&](const StudyContext& context) { return loaded.experiment->run(context); });
      result.state_command(command);
    } catch (const Interrupted&) {
      say_interrupted(settings, false);
    }
    add_answer(loaded, result);
    OutputDirectory folder = free_folder(settings.out / name, names_of(result));
    const FolderLock own(folder.path(), settings.shard);
    apart = apart || folder.path() != settings.out / name;
    record_run(loaded, {.command = command, .folder = settings.folder}, folder);
    folder.announce(names_of(result));
    write_files(folder, result);
    folder.remove_earlier();
    say("== {}: {}\n{}", name, loaded.title, result.summary);
    found.push_back(answer_of_one(name, folder, result));
    add_section(name, loaded.title, result, report);
    if (result.status != report::Status::kOk) report.status = report::Status::kSomeFailed;
    worst = std::max(worst, exit_code_of(result));
    missed = missed || !result.missed.empty();
  }
  OutputDirectory out = free_folder(settings.out, report::file_names(report));
  apart = apart || out.path() != settings.out;
  out.write_provenance(provenance_json(settings.command));
  out.announce(report::file_names(report));
  if (out.path() == settings.out) out.announce_folders(names);
  finish_report(std::move(report), settings, out);
  out.remove_earlier();
  out.require_in_place();
  before.require_in_place();
  add_to_json("out", out.path().string());
  add_to_json("experiments", found);
  remark("{:.2f} s\n", clock.seconds());
  if (apart) return ExitCode::kInvalidInput;
  return worst == ExitCode::kOk && missed ? ExitCode::kAcceptanceMissed : worst;
}

}  // namespace modcal
