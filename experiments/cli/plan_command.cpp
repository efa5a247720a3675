#include <fmt/format.h>

#include <cstdio>

#include "experiments/cli/command.hpp"
#include "experiments/loader.hpp"

namespace modcal {
namespace {

ExitCode plan(const std::string& file, const std::vector<std::string>& assignments) {
  const LoadedExperiment loaded = load_experiment(file, assignments);
  fmt::print(stderr, "{}", format_mistakes(loaded.document, loaded.mistakes));
  if (loaded.has_errors()) return ExitCode::kInvalidInput;
  for (const std::string& line : loaded.experiment->plan()) fmt::print("{}\n", line);
  return ExitCode::kOk;
}

}  // namespace

void add_plan_command(CLI::App& app, const Chosen& chosen) {
  CLI::App* command = app.add_subcommand("plan", "Say what a run would do, skip and cost");
  auto file = std::make_shared<std::string>();
  auto assignments = std::make_shared<std::vector<std::string>>();
  command->add_option("file", *file, "YAML file")->required();
  command->add_option("--set", *assignments, "key.path=value, overrides the file")
      ->allow_extra_args(false);
  command->callback([=] { chosen([=] { return plan(*file, *assignments); }); });
}

}  // namespace modcal
