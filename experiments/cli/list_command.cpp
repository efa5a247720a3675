#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "experiments/cli/command.hpp"
#include "experiments/cli/plugin_kinds.hpp"

namespace modcal {
namespace {

struct ListArguments {
  std::string kind;
  bool json = false;
};

ExitCode print_rows(const nlohmann::ordered_json& rows, bool json) {
  if (json) {
    fmt::print("{}\n", rows.dump(2));
    return ExitCode::kOk;
  }
  for (const auto& row : rows) {
    fmt::print("{:<22} {}\n", row["name"].get<std::string>(), row["summary"].get<std::string>());
  }
  return ExitCode::kOk;
}

ExitCode list(const ListArguments& arguments) {
  auto rows = nlohmann::ordered_json::array();
  if (arguments.kind.empty()) {
    for (const PluginKind& kind : plugin_kinds()) {
      rows.push_back({{"name", kind.name}, {"summary", kind.summary}});
    }
    return print_rows(rows, arguments.json);
  }
  const auto slot = find_plugin_kind(arguments.kind).slot();
  for (const std::string_view name : slot->names()) {
    rows.push_back({{"name", name}, {"summary", slot->summary(name)}});
  }
  return print_rows(rows, arguments.json);
}

}  // namespace

void add_list_command(CLI::App& app, const Chosen& chosen) {
  CLI::App* command = app.add_subcommand("list", "List the plug-ins of a kind, or the kinds");
  auto arguments = std::make_shared<ListArguments>();
  command->add_option("kind", arguments->kind, "kind of plug-in");
  command->add_flag("--json", arguments->json, "as JSON");
  command->callback([=] { chosen([=] { return list(*arguments); }); });
}

}  // namespace modcal
