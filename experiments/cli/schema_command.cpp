#include <fmt/format.h>

#include "experiments/cli/command.hpp"
#include "experiments/config/help.hpp"
#include "experiments/experiment.hpp"

namespace modcal {
namespace {

ExitCode print_schema() {
  auto variants = nlohmann::ordered_json::array();
  Choice<Experiment> choice;
  for (const std::string_view name : choice.names()) {
    choice.select(name);
    nlohmann::ordered_json schema =
        options_schema([&choice](OptionVisitor& visitor) { choice.visit_options(visitor); });
    schema["description"] = choice.summary(name);
    schema["properties"]["kind"] = {{"const", name}};
    schema["properties"]["title"] = {{"type", "string"}};
    schema["properties"]["description"] = {{"type", "string"}};
    schema["required"].push_back("kind");
    variants.push_back(std::move(schema));
  }
  const nlohmann::ordered_json document = {
      {"$schema", "https://json-schema.org/draft/2020-12/schema"},
      {"title", "modcal experiment"},
      {"oneOf", std::move(variants)}};
  fmt::print("{}\n", document.dump(2));
  return ExitCode::kOk;
}

}  // namespace

void add_schema_command(CLI::App& app, const Chosen& chosen) {
  CLI::App* command = app.add_subcommand("schema", "Print the JSON schema of experiment files");
  command->callback([=] { chosen(print_schema); });
}

}  // namespace modcal
