// run, validate and limit: what is done with an experiment file as a whole.
#include <cstdio>

#include "experiments/cli/command.hpp"
#include "experiments/cli/experiment_arguments.hpp"
#include "experiments/cli/message_colors.hpp"
#include "experiments/cli/runner.hpp"
#include "experiments/kinds/calibrate/limit_source.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

struct FileArguments : ExperimentArguments {
  std::string shard = "1/1";
  bool json = false;
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
  command.add_flag("--json", arguments.json, "summary as JSON");
}

ExitCode run(const FileArguments& arguments) {
  const auto loaded = load_and_print_mistakes(arguments.file, arguments.assignments);
  if (!loaded) return ExitCode::kInvalidInput;
  return run_one(*loaded, {.out = arguments.folder(),
                           .threads = arguments.threads,
                           .json = arguments.json,
                           .command = arguments.command(),
                           .shard = parse_shard(arguments.shard)});
}

void declare_validate(CLI::App& command, FileArguments& arguments) {
  arguments.declare_file(command);
  command.add_flag("--json", arguments.json, "as JSON");
}

nlohmann::ordered_json mistakes_json(const LoadedExperiment& loaded) {
  auto list = nlohmann::ordered_json::array();
  for (const Mistake& mistake : loaded.mistakes) {
    const SourcePosition& at = mistake.position;
    list.push_back({{"severity", mistake.warning ? "warning" : "error"},
                    {"place", at.origin.empty() ? loaded.document.file : at.origin},
                    {"line", at.line},
                    {"column", at.column},
                    {"text", mistake.text}});
  }
  return list;
}

ExitCode validate(const FileArguments& arguments) {
  const LoadedExperiment loaded = load_experiment(arguments.file, arguments.assignments);
  const bool valid = !loaded.has_errors();
  if (arguments.json) {
    print_json({{"file", arguments.file},
                {"valid", valid},
                {"kind", loaded.kind},
                {"mistakes", mistakes_json(loaded)}});
  } else {
    fmt::print(stderr, "{}", colored(format_mistakes(loaded.document, loaded.mistakes)));
    if (valid) fmt::print("{}: valid, kind {}\n", arguments.file, loaded.kind);
  }
  return valid ? ExitCode::kOk : ExitCode::kInvalidInput;
}

void declare_limit(CLI::App& command, FileArguments& arguments) { arguments.declare_file(command); }

ExitCode limit(const FileArguments& arguments) {
  const auto loaded = load_and_print_mistakes(arguments.file, arguments.assignments);
  if (!loaded) return ExitCode::kInvalidInput;
  const auto* source = dynamic_cast<const LimitSource*>(loaded->experiment.get());
  MODCAL_REQUIRE(source != nullptr,
                 "{} is no calibration: limits exist for the kinds calibrate and calibration_limit",
                 arguments.file);
  TruthCache truths;
  fmt::print("{}", limit_text(source->limit_question(), truths));
  return ExitCode::kOk;
}

}  // namespace

void add_experiment_commands(CLI::App& app, const Chosen& chosen) {
  add_command(app, chosen, "run", "Run an experiment", declare_run, run);
  add_command(app, chosen, "validate", "Check an experiment file: every mistake at once",
              declare_validate, validate);
  add_command(app, chosen, "limit", "Say how well a calibration can do, before any experiment",
              declare_limit, limit);
}

}  // namespace modcal
