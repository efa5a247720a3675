#include <fmt/format.h>

#include <cstdio>

#include "experiments/cli/command.hpp"
#include "experiments/loader.hpp"

namespace modcal {
namespace {

ExitCode validate(const std::string& file, const std::vector<std::string>& assignments) {
  const LoadedExperiment loaded = load_experiment(file, assignments);
  fmt::print(stderr, "{}", format_mistakes(loaded.document, loaded.mistakes));
  if (loaded.has_errors()) return ExitCode::kInvalidInput;
  fmt::print("{}: valid, kind {}\n", file, loaded.kind);
  return ExitCode::kOk;
}

}  // namespace

void add_validate_command(CLI::App& app, const Chosen& chosen) {
  CLI::App* command =
      app.add_subcommand("validate", "Check an experiment file: every mistake at once");
  auto file = std::make_shared<std::string>();
  auto assignments = std::make_shared<std::vector<std::string>>();
  command->add_option("file", *file, "YAML file")->required();
  command->add_option("--set", *assignments, "key.path=value, overrides the file")
      ->allow_extra_args(false);
  command->callback([=] { chosen([=] { return validate(*file, *assignments); }); });
}

}  // namespace modcal
