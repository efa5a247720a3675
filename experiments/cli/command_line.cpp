// What is wrong with the words of a command line.
#include <algorithm>
#include <cctype>
#include <sstream>

#include "experiments/cli/command.hpp"
#include "experiments/config/reader.hpp"

namespace modcal {
namespace {

// About the first word left over that looks like an option; empty: there is none.
std::string unknown_option(const CLI::App& app) {
  std::vector<std::string> names;
  const CLI::App* command = &app;
  if (!app.get_subcommands().empty()) command = app.get_subcommands().front();
  for (const CLI::Option* option : command->get_options()) {
    if (!option->get_positional()) names.push_back(option->get_name());
  }
  for (const std::string& word : app.remaining(true)) {
    const std::string name = word.substr(0, word.find('='));
    if (name.size() < 2 || name[0] != '-' || std::isdigit(name[1]) != 0) continue;
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      return fmt::format("unknown option \"{}\"{}", name, suggestion(name, names));
    }
  }
  return {};
}

}  // namespace

ExitCode answer_of(const CLI::App& app, const CLI::ParseError& error) {
  const std::string unknown = error.get_exit_code() == 0 ? std::string() : unknown_option(app);
  if (!unknown.empty()) {
    complain("error: {}\n", unknown);
    return ExitCode::kUsage;
  }
  std::ostringstream out, err;
  const int code = app.exit(error, out, err);
  say_text(out.str());
  complain_text(err.str());
  return code == 0 ? ExitCode::kOk : ExitCode::kUsage;
}

bool is_unknown_command(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return false;
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  const auto is_command = [&](const char* word) {
    return std::find(names.begin(), names.end(), word) != names.end();
  };
  if (is_command(argv[1])) return false;
  const auto later = std::find_if(argv + 2, argv + argc, is_command);
  if (later != argv + argc) {
    complain("error: the command comes first: modcal {} {}\n", *later, shell_word(argv[1]));
  } else {
    complain("error: unknown command \"{}\"{}\n", argv[1], suggestion(argv[1], names));
  }
  return true;
}

std::string complaint_about_name(const std::string& name) {
  return name.empty() ? "the name is empty: write one, or leave the option out" : "";
}

}  // namespace modcal
