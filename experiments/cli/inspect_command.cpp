#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "experiments/cli/command.hpp"
#include "experiments/records/inspection.hpp"

namespace modcal {
namespace {

struct InspectArguments {
  std::string file;
  InspectionOptions options;
  bool json = false;
};

ExitCode print_inspection(const InspectArguments& arguments) {
  const InspectionReport report = inspect(arguments.file, arguments.options);
  fmt::print("{}", arguments.json ? json(report).dump(2) + "\n" : text(report));
  return report.problem_count == 0 ? ExitCode::kOk : ExitCode::kInvalidInput;
}

void declare(CLI::App& command, InspectArguments& arguments) {
  command.add_option("file", arguments.file, "CSV or sound file")->required();
  command.add_option("--format", arguments.options.format, "auto, csv or wav");
  command.add_option("--sample-rate", arguments.options.sample_rate,
                     "[Hz], where the file has none");
  command.add_flag("--json", arguments.json, "as JSON");
}

}  // namespace

void add_inspect_command(CLI::App& app, const Chosen& chosen) {
  add_command(app, chosen, "inspect", "Show what a recorded file holds and the YAML to use it",
              declare, print_inspection);
}

}  // namespace modcal
