// run, validate and limit: what is done with an experiment file as a whole.
#include <dlfcn.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "experiments/cli/build_info.hpp"
#include "experiments/cli/command.hpp"
#include "experiments/cli/runner.hpp"
#include "experiments/config/reader.hpp"
#include "experiments/kinds/calibrate/calibrate.hpp"

namespace modcal {
namespace {

struct FileArguments : ExperimentArguments {
  std::string shard = "1/1";
};

std::string complaint_about_shard(const std::string& text) {
  try {
    parse_shard(text);
    return {};
  } catch (const InvalidInput& error) {
    return error.what();
  }
}

void declare_run(CLI::App& command, FileArguments& arguments) {
  arguments.declare_file(command);
  arguments.declare_out(command);
  command
      .add_option("--shard", arguments.shard,
                  "K/N: part K of N of the task list; every part may run elsewhere")
      ->check(complaint_about_shard);
  declare_threads(command, arguments.threads, "number of threads; default all");
}

// The same message at the same place as validate has; what is no error the run says itself.
bool records_are_right(const LoadedExperiment& loaded) {
  LoadedExperiment checked = loaded;
  checked.mistakes.clear();
  check_records(checked);
  if (!checked.has_errors()) return true;
  complain(complaints_of(checked.document, checked.mistakes));
  add_to_json("mistakes", mistakes_json(checked));
  return false;
}

ExitCode run(const FileArguments& arguments) {
  const auto loaded =
      load_and_print_mistakes(arguments.file, arguments.assignments, arguments.means());
  if (!loaded || !records_are_right(*loaded)) return ExitCode::kInvalidInput;
  return run_one(*loaded, {.out = arguments.folder(),
                           .threads = arguments.threads,
                           .command = arguments.command(),
                           .shard = parse_shard(arguments.shard)});
}

void declare_file(CLI::App& command, FileArguments& arguments) { arguments.declare_file(command); }

ExitCode validate(const FileArguments& arguments) {
  require_no_record(arguments.file);
  LoadedExperiment loaded =
      load_experiment(arguments.file, arguments.assignments, arguments.means());
  check_records(loaded);
  const bool valid = !loaded.has_errors();
  complain(complaints_of(loaded.document, loaded.mistakes));
  if (answer_style().json) {
    print_json({{"file", arguments.file},
                {"valid", valid},
                {"kind", loaded.kind},
                {"mistakes", mistakes_json(loaded)}});
  } else if (valid) {
    say("{}: valid, kind {}\n", arguments.file, loaded.kind);
  }
  return valid ? ExitCode::kOk : ExitCode::kInvalidInput;
}

ExitCode limit(const FileArguments& arguments) {
  const auto loaded =
      load_and_print_mistakes(arguments.file, arguments.assignments, arguments.means());
  if (!loaded) return ExitCode::kInvalidInput;
  const auto question = loaded->experiment->limit_question();
  MODCAL_REQUIRE(question != nullptr,
                 "{} is not one calibration: limits exist for the kinds calibrate, without a "
                 "sweep, and calibration_limit",
                 arguments.file);
  TruthCache truths;
  if (answer_style().json) {
    print_json(limit_json(*question, truths));
  } else {
    say_text(limit_text(*question, truths));
  }
  return ExitCode::kOk;
}

struct ReproduceArguments {
  std::string target;
  std::string configs = shipped_configs();
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
      .command = fmt::format("modcal reproduce {} --out {}", arguments.target, shell_word(out)),
      .title = "Debut, Delaune and Antunes (2010): figures and table"};
  return experiments.size() == 1 ? run_one(experiments[0], settings)
                                 : run_together(experiments, settings);
}

void declare(CLI::App& command, ReproduceArguments& arguments) {
  command.add_option("target", arguments.target, "paper, table1, fig02 ... fig17, section7")
      ->required();
  command.add_option("--configs", arguments.configs, "folder of the experiment files");
  command.add_option("--out", arguments.out, "folder of the results; default out/<target>")
      ->check(complaint_about_name);
  declare_threads(command, arguments.threads, "number of threads; default all");
}

// Where the program stands, or would stand beside the module that another program has loaded: of a
// build, or installed in PREFIX/lib/python3/dist-packages/modcal.
std::vector<std::filesystem::path> own_folders() {
  Dl_info module{};
  const bool is_known = dladdr(reinterpret_cast<const void*>(&shipped_configs), &module) != 0;
  const std::filesystem::path file = is_known ? module.dli_fname : "";
  if (file.extension() != ".so") {
    return {std::filesystem::read_symlink("/proc/self/exe").parent_path()};
  }
  const std::filesystem::path folder = std::filesystem::absolute(file).parent_path();
  return {folder / "../..", folder / "../../../../bin"};
}

}  // namespace

std::string shipped_configs() {
  std::filesystem::path configs;
  for (const std::filesystem::path& own : own_folders()) {
    for (const char* folder : kBuildConfigs) {
      configs = (own / folder).lexically_normal();
      if (std::filesystem::is_directory(configs)) return configs.string();
    }
  }
  return configs.string();
}

void add_experiment_commands(CLI::App& app, const Chosen& chosen) {
  add_command(app, chosen, "run", "Run an experiment", declare_run, run);
  add_command(app, chosen, "validate",
              "Check an experiment file and its records: every mistake at once", declare_file,
              validate);
  add_command(app, chosen, "limit", "Say how well a calibration can do, before any experiment",
              declare_file, limit);
}

void add_reproduce_command(CLI::App& app, const Chosen& chosen) {
  add_command(app, chosen, "reproduce",
              "Make the paper's table and figures: paper, table1, fig02, ...", declare, reproduce);
}

}  // namespace modcal
