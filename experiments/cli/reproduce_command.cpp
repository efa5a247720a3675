#include <fmt/format.h>

#include <algorithm>

#include "experiments/cli/build_info.hpp"
#include "experiments/cli/command.hpp"
#include "experiments/cli/experiment_arguments.hpp"
#include "experiments/cli/runner.hpp"
#include "experiments/config/reader.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

struct ReproduceArguments {
  std::string target;
  std::string configs = kBuildConfigs;
  std::string out;
  int threads = 0;
};

std::vector<std::filesystem::path> yaml_files(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  if (std::filesystem::is_directory(folder)) {
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.path().extension() == ".yaml") files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

// "paper": every file of configs/paper; "table1": that one of them.
std::vector<std::filesystem::path> files_of(const ReproduceArguments& arguments) {
  auto all = yaml_files(std::filesystem::path(arguments.configs) / "paper");
  MODCAL_REQUIRE(!all.empty(), "no experiment stands in {}/paper: name the folder with --configs",
                 arguments.configs);
  if (arguments.target == "paper") return all;
  std::vector<std::string> names = {"paper"};
  for (const std::filesystem::path& file : all) {
    if (file.stem() == arguments.target) return {file};
    names.push_back(file.stem().string());
  }
  throw_invalid_input("unknown target \"{}\"{}", arguments.target,
                      suggestion(arguments.target, names));
}

ExitCode reproduce(const ReproduceArguments& arguments) {
  std::vector<LoadedExperiment> experiments;
  for (const std::filesystem::path& file : files_of(arguments)) {
    auto loaded = load_and_print_mistakes(file);
    if (!loaded) return ExitCode::kInvalidInput;
    experiments.push_back(std::move(*loaded));
  }
  const std::string out = arguments.out.empty() ? "out/" + arguments.target : arguments.out;
  const RunSettings settings{
      .out = out,
      .threads = arguments.threads,
      .command = fmt::format("modcal reproduce {} --out {}", arguments.target, out),
      .title = "Debut, Delaune and Antunes (2010): figures and table"};
  return experiments.size() == 1 ? run_one(experiments[0], settings)
                                 : run_together(experiments, settings);
}

void declare(CLI::App& command, ReproduceArguments& arguments) {
  command.add_option("target", arguments.target, "paper, table1, fig02 ... fig17, section7")
      ->required();
  command.add_option("--configs", arguments.configs, "folder of the experiment files");
  command.add_option("--out", arguments.out, "folder of the results; default out/<target>");
  declare_threads(command, arguments.threads, "number of threads; default all");
}

}  // namespace

void add_reproduce_command(CLI::App& app, const Chosen& chosen) {
  add_command(app, chosen, "reproduce",
              "Make the paper's table and figures: paper, table1, fig02, ...", declare, reproduce);
}

}  // namespace modcal
