#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "experiments/cli/command.hpp"
#include "experiments/cli/message_colors.hpp"
#include "experiments/loader.hpp"

namespace modcal {
namespace {

struct ValidateArguments {
  std::string file;
  std::vector<std::string> assignments;
  bool json = false;
};

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

ExitCode validate(const ValidateArguments& arguments) {
  const LoadedExperiment loaded = load_experiment(arguments.file, arguments.assignments);
  const bool valid = !loaded.has_errors();
  if (arguments.json) {
    const nlohmann::ordered_json object = {{"file", arguments.file},
                                           {"valid", valid},
                                           {"kind", loaded.kind},
                                           {"mistakes", mistakes_json(loaded)}};
    fmt::print("{}\n", object.dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
  } else {
    fmt::print(stderr, "{}", colored(format_mistakes(loaded.document, loaded.mistakes)));
    if (valid) fmt::print("{}: valid, kind {}\n", arguments.file, loaded.kind);
  }
  return valid ? ExitCode::kOk : ExitCode::kInvalidInput;
}

}  // namespace

void add_validate_command(CLI::App& app, const Chosen& chosen) {
  CLI::App* command =
      app.add_subcommand("validate", "Check an experiment file: every mistake at once");
  auto arguments = std::make_shared<ValidateArguments>();
  command->add_option("file", arguments->file, "YAML file")->required();
  command->add_option("--set", arguments->assignments, "key.path=value, overrides the file")
      ->allow_extra_args(false);
  command->add_flag("--json", arguments->json, "as JSON");
  command->callback([=] { chosen([=] { return validate(*arguments); }); });
}

}  // namespace modcal
