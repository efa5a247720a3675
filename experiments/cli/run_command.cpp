#include <fmt/format.h>

#include <cstdio>

#include "experiments/cli/command.hpp"
#include "experiments/cli/message_colors.hpp"
#include "experiments/cli/runner.hpp"
#include "experiments/cli/shell_word.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

struct RunArguments {
  std::string file;
  std::string out;
  std::vector<std::string> assignments;
  std::string shard = "1/1";
  int threads = 0;
  bool json = false;
};

std::string command_of(const RunArguments& arguments, const std::string& out) {
  std::string command = "modcal run " + shell_word(arguments.file) + " --out " + shell_word(out);
  for (const std::string& assignment : arguments.assignments) {
    command += " --set " + shell_word(assignment);
  }
  if (arguments.threads > 0) command += fmt::format(" --threads {}", arguments.threads);
  return command;
}

ExitCode run(const RunArguments& arguments) {
  const LoadedExperiment loaded = load_experiment(arguments.file, arguments.assignments);
  fmt::print(stderr, "{}", colored(format_mistakes(loaded.document, loaded.mistakes)));
  if (loaded.has_errors()) return ExitCode::kInvalidInput;
  const std::string out =
      arguments.out.empty()
          ? (std::filesystem::path("out") / std::filesystem::path(arguments.file).stem()).string()
          : arguments.out;
  return run_one(loaded, {.out = out,
                          .threads = arguments.threads,
                          .json = arguments.json,
                          .command = command_of(arguments, out),
                          .shard = parse_shard(arguments.shard)});
}

}  // namespace

void add_run_command(CLI::App& app, const Chosen& chosen) {
  CLI::App* command = app.add_subcommand("run", "Run an experiment");
  auto arguments = std::make_shared<RunArguments>();
  command->add_option("file", arguments->file, "YAML file")->required();
  command->add_option("--out", arguments->out,
                      "folder of the results; default out/<name of the file>");
  command->add_option("--set", arguments->assignments, "key.path=value, overrides the file")
      ->allow_extra_args(false);
  command
      ->add_option("--shard", arguments->shard,
                   "K/N: part K of N of the task list; every part may run elsewhere")
      ->check([](const std::string& text) {
        try {
          parse_shard(text);
          return std::string();
        } catch (const InvalidInput& error) {
          return std::string(error.what());
        }
      });
  command->add_option("--threads", arguments->threads, "number of threads; default all")
      ->check(CLI::Range(1, 4096));
  command->add_flag("--json", arguments->json, "summary as JSON");
  command->callback([=] { chosen([=] { return run(*arguments); }); });
}

}  // namespace modcal
