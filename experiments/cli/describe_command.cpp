#include <fmt/format.h>

#include "experiments/cli/command.hpp"
#include "experiments/cli/plugin_kinds.hpp"
#include "experiments/config/help.hpp"
#include "experiments/config/reader.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

struct DescribeArguments {
  std::string kind;
  std::string name;
  bool json = false;
};

ExitCode describe(const DescribeArguments& arguments) {
  const auto slot = find_plugin_kind(arguments.kind).slot();
  std::vector<std::string> names;
  for (const std::string_view name : slot->names()) names.emplace_back(name);
  MODCAL_REQUIRE(std::find(names.begin(), names.end(), arguments.name) != names.end(),
                 "unknown {} \"{}\"{}", arguments.kind, arguments.name,
                 suggestion(arguments.name, names));
  slot->select(arguments.name);
  const auto options =
      describe_options([&slot](OptionVisitor& visitor) { slot->visit_options(visitor); });
  if (arguments.json) {
    const nlohmann::ordered_json description = {{"kind", arguments.kind},
                                                {"name", arguments.name},
                                                {"summary", slot->summary(arguments.name)},
                                                {"options", options}};
    fmt::print("{}\n", description.dump(2));
  } else {
    fmt::print("{} {}: {}\n{}", arguments.kind, arguments.name, slot->summary(arguments.name),
               options.empty() ? "no options\n" : help_text(options));
  }
  return ExitCode::kOk;
}

}  // namespace

void add_describe_command(CLI::App& app, const Chosen& chosen) {
  CLI::App* command = app.add_subcommand("describe", "Show a plug-in's options");
  auto arguments = std::make_shared<DescribeArguments>();
  command->add_option("kind", arguments->kind, "kind of plug-in")->required();
  command->add_option("name", arguments->name, "name of the plug-in")->required();
  command->add_flag("--json", arguments->json, "as JSON");
  command->callback([=] { chosen([=] { return describe(*arguments); }); });
}

}  // namespace modcal
