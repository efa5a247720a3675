// What the commands that work on an experiment file have in common.
#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "experiments/loader.hpp"

namespace modcal {

struct ExperimentArguments {
  std::string file;
  std::vector<std::string> assignments;  ///< "key.path=value"
  std::string out;                       ///< empty: out/<name of the file>
  int threads = 0;                       ///< 0: not stated

  /// FILE and --set.
  void declare_file(CLI::App& command);
  /// --out; seen_by: who else must see the folder, empty: nobody.
  void declare_out(CLI::App& command, const std::string& seen_by = {});

  std::filesystem::path folder() const;
  /// Assignments as words of a shell: " --set ..." for each.
  std::string assignment_words() const;
  /// The command line that makes the same results again, of the whole list.
  std::string command() const;
};

/// --threads with its range.
void declare_threads(CLI::App& command, int& threads, const char* meaning);

/// The experiment, after its mistakes were printed; none where an error is among them.
std::optional<LoadedExperiment> load_and_print_mistakes(
    const std::filesystem::path& file, const std::vector<std::string>& assignments = {});

void print_json(const nlohmann::ordered_json& object);

}  // namespace modcal
