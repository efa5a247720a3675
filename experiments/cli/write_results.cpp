#include "experiments/cli/write_results.hpp"

#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "experiments/report/result.hpp"
#include "libsim/base/utf8.hpp"
#include "libsim/records/record_file.hpp"

namespace modcal {
namespace {

// Below a folder where files of others are in the way.
constexpr const char* kApart = "results";

void write_signal_file(const OutputDirectory& out, const SignalFile& file) {
  const std::filesystem::path path = out.note(file.name);
  if (path.extension() == ".wav") {
    write_wav(path, file.signals, {.samples = WavSamples::kDouble, .full_scale = file.full_scale});
  } else {
    std::vector<std::string> provenance = {version_text()};
    provenance.insert(provenance.end(), file.notes.begin(), file.notes.end());
    write_csv(path, file.signals, {.provenance = std::move(provenance)});
  }
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

// How many tasks of a list failed, which and why; empty: none.
std::string failures_text(const LoadedExperiment& loaded, const StudyResult& result) {
  const auto* list = dynamic_cast<const TaskExperiment*>(loaded.experiment.get());
  if (list == nullptr || result.failures.empty()) return {};
  constexpr std::size_t kShown = 5;
  std::string text =
      fmt::format("{} of {} tasks failed:\n", result.failed_tasks, list->task_count());
  for (std::size_t i = 0; i < std::min(kShown, result.failures.size()); ++i) {
    const TasksOfReason& failed = result.failures[i];
    text +=
        fmt::format("  task {}{}: {}\n", fmt::join(failed.first, ", "),
                    failed.count > failed.first.size() ? fmt::format(" … ({} tasks)", failed.count)
                                                       : std::string(),
                    failed.reason.substr(0, failed.reason.find('\n')));
  }
  if (result.failures.size() > kShown) {
    text += fmt::format("  and {} other reasons, see tasks.csv\n", result.failures.size() - kShown);
  }
  return text;
}

nlohmann::ordered_json failures_json(const StudyResult& result) {
  auto list = nlohmann::ordered_json::array();
  for (const TasksOfReason& failed : result.failures) {
    list.push_back({{"reason", failed.reason}, {"count", failed.count}, {"first", failed.first}});
  }
  return list;
}

void print_summary(const StudyResult& result, const RunSettings& settings, double seconds) {
  if (!answer_style().json) return say_text(result.summary);
  add_to_json("out", settings.out.string());
  add_to_json("files", names_of(result));
  add_to_json("seconds", seconds);
  const nlohmann::ordered_json found = findings_json(result);
  for (const auto& [name, value] : found.items()) add_to_json(name, value);
  for (const std::string& text : result.warnings) note_warning(text);
  add_to_json("failed_tasks", result.failed_tasks);
  if (!result.failures.empty()) add_to_json("failures", failures_json(result));
  add_to_json("missed", result.missed);
  add_to_json("summary", result.summary);
}

report::Report report_of(const LoadedExperiment& loaded, StudyResult& result,
                         const RunSettings& settings) {
  report::Report report;
  report.title = title_of(loaded);
  report.description = loaded.description;
  report.status = result.status;
  report.status_text = status_text(loaded, result);
  if (!result.answer.empty()) {
    report.status_text += (report.status_text.empty() ? "" : ": ") + result.answer;
  }
  if (std::string failures = failures_text(loaded, result); !failures.empty()) {
    result.add_first(report::Text{std::move(failures), report::Text::Kind::kFailure});
  }
  result.move_to(report, "Results", "Details");
  if (dynamic_cast<const TaskExperiment*>(loaded.experiment.get()) != nullptr) {
    report.replay = "modcal replay " + shell_word(settings.out.string());
  }
  return report;
}

}  // namespace

std::string title_of(const LoadedExperiment& loaded) {
  return loaded.title.empty() ? loaded.kind : loaded.title;
}

std::filesystem::path folder_of(const LoadedExperiment& loaded, const RunSettings& settings) {
  const std::filesystem::path folder =
      settings.folder.empty() ? loaded.document.folder() : settings.folder;
  return folder.empty() ? "." : folder;
}

nlohmann::ordered_json findings_json(const StudyResult& result) {
  auto parameters = nlohmann::ordered_json::array(), scores = nlohmann::ordered_json::array();
  for (const FoundParameter& parameter : result.parameters) {
    parameters.push_back({{"name", parameter.name},
                          {"value", report::number_json(parameter.value)},
                          {"deviation", report::number_json(parameter.deviation)},
                          {"unit", parameter.unit},
                          {"initial", report::number_json(parameter.initial)}});
  }
  for (const auto& [side, score] : result.scores) {
    scores.push_back({{"side", side},
                      {"window", {score.start, score.stop}},
                      {"correlation", report::number_json(score.correlation)},
                      {"relative_rms_error", report::number_json(score.relative_rms_error)},
                      {"coverage", report::number_json(score.coverage)}});
  }
  return {{"verdict", result.answer},
          {"parameters", std::move(parameters)},
          {"scores", std::move(scores)}};
}

void add_answer(const LoadedExperiment& loaded, StudyResult& result) {
  const bool failed = result.status == report::Status::kFailed;
  nlohmann::ordered_json answer = {{"status", failed                    ? "failed"
                                              : result.failed_tasks > 0 ? "some_failed"
                                                                        : "ok"}};
  answer.update(findings_json(result));
  answer["warnings"] = nlohmann::ordered_json::array();
  for (const Complaint& complaint : complaints_of(loaded.document, loaded.mistakes)) {
    answer["warnings"].push_back(message_of(complaint));
  }
  for (const std::string& text : result.warnings) answer["warnings"].push_back(text);
  answer["missed"] = result.missed;
  answer["failed_tasks"] = result.failed_tasks;
  answer["pending_tasks"] = result.pending_tasks;
  answer["summary"] = result.summary;
  result.files.emplace_back(kAnswerFile, report::json_file(answer));
}

void record_run(const LoadedExperiment& loaded, const RunSettings& settings, OutputDirectory& out) {
  const std::filesystem::path folder = folder_of(loaded, settings);
  nlohmann::ordered_json provenance = provenance_json(settings.command);
  const std::string absolute = std::filesystem::absolute(folder / "").lexically_normal().string();
  MODCAL_REQUIRE(first_not_utf8(absolute) == std::string::npos,
                 "the folder {} has a name that is not UTF-8 text: rename it", absolute);
  provenance["folder"] = absolute;
  std::error_code ignored;
  const std::string directory =
      (settings.directory.empty() ? std::filesystem::current_path(ignored) : settings.directory)
          .string();
  if (first_not_utf8(directory) == std::string::npos) provenance["directory"] = directory;
  provenance["seeds"] = seeds_json(loaded);
  out.write_provenance(std::move(provenance));
  out.write_text(kResolvedFile, resolved_text(loaded, folder));
}

ExitCode exit_code_of(const StudyResult& result) {
  if (result.status == report::Status::kFailed) return ExitCode::kNothingMeasured;
  return result.failed_tasks > 0 ? ExitCode::kSomeTasksFailed : ExitCode::kOk;
}

std::vector<std::string> names_of(const StudyResult& result) {
  std::vector<std::string> names;
  for (const auto& [name, content] : result.files) names.push_back(name);
  for (const SignalFile& file : result.signal_files) names.push_back(file.name);
  return names;
}

OutputDirectory free_folder(const std::filesystem::path& folder,
                            const std::vector<std::string>& names) {
  OutputDirectory out(folder);
  const std::string foreign = out.foreign_among(names);
  if (foreign.empty()) return out;
  complain({.place = {.file = (folder / foreign).string()},
            .text = fmt::format("no run of modcal wrote this file, and it is kept; the results "
                                "stand in {}: choose another folder with --out",
                                (folder / kApart).string())});
  return free_folder(folder / kApart, names);
}

void write_files(const OutputDirectory& out, const StudyResult& result) {
  for (const auto& [name, content] : result.files) out.write_text(name, content);
  for (const SignalFile& file : result.signal_files) write_signal_file(out, file);
}

void finish_report(report::Report report, const RunSettings& settings, const OutputDirectory& out) {
  report.command = settings.command;
  report.provenance = provenance_lines(settings.command);
  const report::WrittenReport written = report::write_report(report, out.path());
  if (!written.warning.empty()) warn("{}", written.warning);
  add_to_json("report", written.page.string());
  remark("report: {}\n", written.page.string());
}

void print_failures(const LoadedExperiment& loaded, const StudyResult& result,
                    const RunSettings& settings) {
  const std::string failures = failures_text(loaded, result);
  if (answer_style().json || failures.empty()) return;
  say_text(failures + fmt::format("one of them again: modcal replay {} {}\n",
                                  shell_word(settings.out.string()), result.failures[0].first[0]));
}

ExitCode write_results(const LoadedExperiment& loaded, StudyResult result, RunSettings settings,
                       double seconds, const Beside& beside) {
  result.state_command(settings.command);
  add_answer(loaded, result);
  report::Report report = report_of(loaded, result, settings);
  std::vector<std::string> names = report::file_names(report);
  for (std::string& name : names_of(result)) names.push_back(std::move(name));
  OutputDirectory out = free_folder(settings.out, names);
  const bool apart = out.path() != settings.out;
  settings.out = out.path();
  if (!beside.settings || apart) {
    record_run(loaded, settings, out);
  } else if (!out.has_provenance()) {
    out.write_provenance(provenance_json(settings.command));
  }
  names.insert(names.end(), {kProvenanceFile, kResolvedFile});
  if (beside.database) {
    out.keep({kDatabaseFile});
    out.keep({kSlurmScripts.begin(), kSlurmScripts.end()});
  }
  out.announce(names);
  write_files(out, result);
  print_summary(result, settings, seconds);
  finish_report(std::move(report), settings, out);
  print_failures(loaded, result, settings);
  out.remove_earlier();
  out.require_in_place();
  if (apart) return ExitCode::kInvalidInput;
  const ExitCode code = exit_code_of(result);
  return code == ExitCode::kOk && !result.missed.empty() ? ExitCode::kAcceptanceMissed : code;
}

ExitCode present(const LoadedExperiment& loaded, StudyResult result, const RunSettings& settings,
                 double seconds) {
  return write_results(loaded, std::move(result), settings, seconds, {});
}

}  // namespace modcal
