// list, describe and schema: what can stand in an experiment file.

#include "experiments/cli/answer_schema.hpp"
#include "experiments/cli/command.hpp"
#include "experiments/config/help.hpp"
#include "experiments/config/reader.hpp"
#include "libcalib/objective.hpp"
#include "libcalib/optimizer.hpp"
#include "libinverse/joint/force_prior.hpp"

namespace modcal {
namespace {

struct PluginKind {
  std::string_view name;
  std::string_view summary;
  std::unique_ptr<PluginSlot> (*slot)();
};

template <typename Product>
std::unique_ptr<PluginSlot> slot_of() {
  return std::make_unique<Choice<Product>>();
}

template <typename Product>
constexpr PluginKind kind_of(std::string_view summary) {
  return {Product::kKind, summary, &slot_of<Product>};
}

std::span<const PluginKind> plugin_kinds() {
  static constexpr std::array kKinds = {
      kind_of<DampingLaw>("modal damping of the string"),
      kind_of<Estimator>("what is estimated from which reactions"),
      kind_of<Experiment>("what a YAML file describes: its kind"),
      kind_of<ForcePrior>("what a joint estimate supposes about the force's spectrum"),
      kind_of<FrictionLaw>("friction between bow and string"),
      kind_of<Gesture>("how the bow's velocity or force changes with time"),
      kind_of<InitialMotion>("how the string moves at first"),
      kind_of<Objective>("what a calibration minimizes"),
      kind_of<Optimizer>("how a calibration minimizes it"),
      kind_of<ParameterChoice>("how much regularization suits the data"),
      kind_of<Regularizer>("what keeps noise from being amplified"),
      kind_of<Simulator>("how a scene is simulated"),
  };
  return kKinds;
}

const PluginKind& find_plugin_kind(std::string_view name) {
  std::vector<std::string> names;
  for (const PluginKind& kind : plugin_kinds()) {
    if (kind.name == name) return kind;
    names.emplace_back(kind.name);
  }
  throw_invalid_input("unknown kind of plug-in \"{}\"{}", name, suggestion(name, names));
}

struct PluginArguments {
  std::string kind;
  std::string name;
  bool answers = false;
};

void declare_list(CLI::App& command, PluginArguments& arguments) {
  command.add_option("kind", arguments.kind, "kind of plug-in");
}

ExitCode list(const PluginArguments& arguments) {
  auto rows = nlohmann::ordered_json::array();
  const auto add = [&rows](std::string_view name, std::string_view summary) {
    rows.push_back({{"name", name}, {"summary", summary}});
  };
  if (arguments.kind.empty()) {
    for (const PluginKind& kind : plugin_kinds()) add(kind.name, kind.summary);
  } else {
    const auto slot = find_plugin_kind(arguments.kind).slot();
    for (const std::string_view name : slot->names()) add(name, slot->summary(name));
  }
  if (answer_style().json) {
    print_json(rows);
    return ExitCode::kOk;
  }
  for (const auto& row : rows) {
    say("{:<22} {}\n", row["name"].get<std::string>(), row["summary"].get<std::string>());
  }
  return ExitCode::kOk;
}

void declare_describe(CLI::App& command, PluginArguments& arguments) {
  command.add_option("kind", arguments.kind, "kind of plug-in")->required();
  command.add_option("name", arguments.name, "name of the plug-in")->required();
}

ExitCode describe(const PluginArguments& arguments) {
  const auto slot = find_plugin_kind(arguments.kind).slot();
  std::vector<std::string> names;
  for (const std::string_view name : slot->names()) names.emplace_back(name);
  MODCAL_REQUIRE(std::find(names.begin(), names.end(), arguments.name) != names.end(),
                 "unknown {} \"{}\"{}", arguments.kind, arguments.name,
                 suggestion(arguments.name, names));
  slot->select(arguments.name);
  const auto options =
      describe_options([&slot](OptionVisitor& visitor) { slot->visit_options(visitor); });
  if (answer_style().json) {
    print_json({{"kind", arguments.kind},
                {"name", arguments.name},
                {"summary", slot->summary(arguments.name)},
                {"options", options}});
  } else {
    say("{} {}: {}\n{}", arguments.kind, arguments.name, slot->summary(arguments.name),
        options.empty() ? "no options\n" : help_text(options));
  }
  return ExitCode::kOk;
}

void declare_schema(CLI::App& command, PluginArguments& arguments) {
  command.add_flag("--answers", arguments.answers, "that of what --json answers");
}

// A kind that does not exist is one mistake of "kind", and each kind is judged by its own part.
ExitCode print_schema(const PluginArguments& arguments) {
  if (arguments.answers) {
    print_json(answer_schema());
    return ExitCode::kOk;
  }
  auto cases = nlohmann::ordered_json::array();
  Choice<Experiment> choice;
  for (const std::string_view name : choice.names()) {
    choice.select(name);
    nlohmann::ordered_json schema =
        options_schema([&choice](OptionVisitor& visitor) { choice.visit_options(visitor); });
    schema["description"] = choice.summary(name);
    schema["properties"]["kind"] = {{"const", name}};
    schema["properties"]["title"] = {{"type", "string"}};
    schema["properties"]["description"] = {{"type", "string"}};
    cases.push_back(
        {{"if", {{"properties", {{"kind", {{"const", name}}}}}, {"required", {"kind"}}}},
         {"then", std::move(schema)}});
  }
  print_json(with_shared_parts({{"$schema", "https://json-schema.org/draft/2020-12/schema"},
                                {"title", "modcal experiment"},
                                {"type", "object"},
                                {"properties", {{"kind", {{"enum", choice.names()}}}}},
                                {"required", {"kind"}},
                                {"allOf", std::move(cases)}}));
  return ExitCode::kOk;
}

}  // namespace

void add_plugin_commands(CLI::App& app, const Chosen& chosen) {
  add_command(app, chosen, "list", "List the plug-ins of a kind, or the kinds", declare_list, list);
  add_command(app, chosen, "describe", "Show a plug-in's options", declare_describe, describe);
  add_command<PluginArguments>(app, chosen, "schema",
                               "Print the JSON schema of experiment files, or of answers",
                               declare_schema, print_schema);
}

}  // namespace modcal
