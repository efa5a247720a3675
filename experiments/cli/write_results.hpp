// Leaves what a run found in its folder, and nothing of earlier runs beside it.
#pragma once

#include "experiments/cli/output_directory.hpp"
#include "experiments/cli/runner.hpp"

namespace modcal {

std::string title_of(const LoadedExperiment& loaded);
/// Where relative paths of the experiment start.
std::filesystem::path folder_of(const LoadedExperiment& loaded, const RunSettings& settings);
ExitCode exit_code_of(const StudyResult& result);

/// What it found, for programs: verdict, parameters, scores.
nlohmann::ordered_json findings_json(const StudyResult& result);

/// The findings with status, warnings and summary as a file of the result, answer.json: who opens
/// the folder later learns what its run has said.
void add_answer(const LoadedExperiment& loaded, StudyResult& result);

/// provenance.json first, then resolved.yaml: a run that is killed between has left no file
/// unnamed.
void record_run(const LoadedExperiment& loaded, const RunSettings& settings, OutputDirectory& out);

/// Names of the files of a result, without those of its report.
std::vector<std::string> names_of(const StudyResult& result);
/// The folder, or, where a file that no run wrote has one of the names, one below it: what was
/// computed is not lost.
OutputDirectory free_folder(const std::filesystem::path& folder,
                            const std::vector<std::string>& names);
void write_files(const OutputDirectory& out, const StudyResult& result);
void finish_report(report::Report report, const RunSettings& settings, const OutputDirectory& out);

/// What stands in a folder beside the results.
struct Beside {
  bool settings = true;  ///< resolved.yaml and provenance.json of this run
  bool database = true;  ///< and scripts of this list
};

/// On standard output: how many tasks of a list failed, which, why, and how to see one.
void print_failures(const LoadedExperiment& loaded, const StudyResult& result,
                    const RunSettings& settings);

/// present(), with what is missing beside the results.
ExitCode write_results(const LoadedExperiment& loaded, StudyResult result, RunSettings settings,
                       double seconds, const Beside& beside);

}  // namespace modcal
