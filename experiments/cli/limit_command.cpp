#include <fmt/format.h>

#include <cstdio>

#include "experiments/cli/command.hpp"
#include "experiments/cli/message_colors.hpp"
#include "experiments/kinds/calibrate/limit_source.hpp"
#include "experiments/loader.hpp"

namespace modcal {
namespace {

ExitCode limit(const std::string& file, const std::vector<std::string>& assignments) {
  const LoadedExperiment loaded = load_experiment(file, assignments);
  fmt::print(stderr, "{}", colored(format_mistakes(loaded.document, loaded.mistakes)));
  if (loaded.has_errors()) return ExitCode::kInvalidInput;
  const auto* source = dynamic_cast<const LimitSource*>(loaded.experiment.get());
  MODCAL_REQUIRE(source != nullptr,
                 "{} is no calibration: limits exist for the kinds calibrate and calibration_limit",
                 file);
  TruthCache truths;
  fmt::print("{}", limit_text(source->limit_question(), truths));
  return ExitCode::kOk;
}

}  // namespace

void add_limit_command(CLI::App& app, const Chosen& chosen) {
  CLI::App* command =
      app.add_subcommand("limit", "Say how well a calibration can do, before any experiment");
  auto file = std::make_shared<std::string>();
  auto assignments = std::make_shared<std::vector<std::string>>();
  command->add_option("file", *file, "YAML file of kind calibrate or calibration_limit")
      ->required();
  command->add_option("--set", *assignments, "key.path=value, overrides the file")
      ->allow_extra_args(false);
  command->callback([=] { chosen([=] { return limit(*file, *assignments); }); });
}

}  // namespace modcal
