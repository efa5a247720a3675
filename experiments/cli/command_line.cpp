// What is wrong with the words of a command line, and what a command takes.
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <regex>
#include <sstream>

#include "experiments/cli/command.hpp"
#include "experiments/config/reader.hpp"

namespace modcal {
namespace {

const CLI::App& chosen_of(const CLI::App& app) {
  return app.get_subcommands().empty() ? app : *app.get_subcommands().front();
}

std::string name_of(const CLI::App& app, const CLI::App& command) {
  return &command == &app ? "modcal" : "modcal " + command.get_name();
}

// A positional as the usage has it.
std::string upper_case(std::string text) {
  if (text.starts_with('-')) return text;
  for (char& letter : text) {
    letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
  }
  return text;
}

// About the first word left over that looks like an option; empty: there is none.
std::string unknown_option(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : chosen_of(app).get_options()) {
    if (!option->get_positional()) names.push_back(option->get_name());
  }
  for (const std::string& word : app.remaining(true)) {
    const std::string name = word.substr(0, word.find('='));
    if (name.size() < 2 || name == "--" || name[0] != '-' || std::isdigit(name[1]) != 0) continue;
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      return fmt::format("unknown option \"{}\"{}", name, suggestion(name, names));
    }
  }
  return {};
}

template <typename Kind>
bool is(const CLI::ParseError& error) {
  return dynamic_cast<const Kind*>(&error) != nullptr;
}

// The option that CLI11's text is about, which its errors have nowhere else; null: none.
const CLI::Option* option_in(const std::string& text, const CLI::App& command) {
  for (const CLI::Option* option : command.get_options()) {
    const std::string name = option->get_name();
    if (text.starts_with(name + ":") || text.find(": " + name + " = ") != std::string::npos) {
      return option;
    }
  }
  return nullptr;
}

// What CLI11 says, with what to do about it.
Complaint mistake_of(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App& command = chosen_of(app);
  const std::string name = name_of(app, command), usage = usage_of(app, command);
  const std::string text = error.what();
  if (is<CLI::RequiredError>(error) && &command != &app) {
    const std::string missing = upper_case(text.substr(0, text.find(' ')));
    return {.text = fmt::format("{} is missing: {}", missing, usage)};
  }
  if (is<CLI::RequiresError>(error)) {
    const std::size_t end = text.find(' ');
    return {.place = {.option = text.substr(0, end)},
            .text = fmt::format("is read with a {} alone: name it, or leave the option out: {}",
                                upper_case(text.substr(text.rfind(' ') + 1)), usage)};
  }
  if (is<CLI::ExtrasError>(error)) {
    return {.text = fmt::format("{} does not take \"{}\": {}", name,
                                fmt::join(app.remaining(true), " "), usage)};
  }
  const CLI::Option* option = option_in(text, command);
  if (option == nullptr) return {.text = fmt::format("{}; see {} --help", text, name)};
  const std::string what = option->get_name();
  if (is<CLI::ArgumentMismatch>(error)) {
    const std::size_t given = option->results().size();
    if (given < 2) return {.text = fmt::format("{} needs a value: {}", what, usage)};
    return {.text = fmt::format("{} is given {} times: leave one of them", what, given)};
  }
  const InputPlace place = what.starts_with("--") ? InputPlace{.option = what} : InputPlace{};
  if (is<CLI::ConversionError>(error)) {
    return {.place = place,
            .text = fmt::format("\"{}\" is not what it takes: see {} --help",
                                fmt::join(option->results(), " "), name)};
  }
  const std::string told = place.empty() ? text : text.substr(what.size() + 2);
  return {.place = place, .text = fmt::format("{}; see {} --help", told, name)};
}

}  // namespace

std::string usage_of(const CLI::App& app, const CLI::App& command) {
  std::string text = name_of(app, command);
  if (&command == &app) return text + " COMMAND ...";
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_positional() && !option->get_required()) continue;
    const std::string name = option->get_name();
    const std::string word = option->get_positional() ? upper_case(name) : name;
    text += option->get_required() ? " " + word : " [" + word + "]";
  }
  return text + " [OPTIONS]";
}

ExitCode answer_of(const CLI::App& app, const CLI::ParseError& error) {
  if (error.get_exit_code() == 0) {
    std::ostringstream out, unused;
    app.exit(error, out, unused);
    say_text(out.str());
    return ExitCode::kOk;
  }
  const std::string unknown = unknown_option(app);
  complain(unknown.empty() ? mistake_of(app, error) : Complaint{.text = unknown});
  return ExitCode::kUsage;
}

bool is_unknown_command(const CLI::App& app, int argc, const char* const* argv) {
  if (argc < 2) return false;
  const std::string first = argv[1];
  const auto is_option_of_all = [&] {
    const CLI::Option* option = app.get_option_no_throw(first.substr(0, first.find('=')));
    return option != nullptr;
  };
  if (first.starts_with('-') && is_option_of_all()) return false;
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  const auto is_command = [&](const char* word) {
    return std::find(names.begin(), names.end(), word) != names.end();
  };
  if (is_command(argv[1])) return false;
  const auto later = std::find_if(argv + 2, argv + argc, is_command);
  if (later != argv + argc) {
    complain(
        {.text = fmt::format("the command comes first: modcal {} {}", *later, shell_word(first))});
  } else if (first.starts_with('-')) {
    return false;
  } else {
    complain({.text = fmt::format("unknown command \"{}\"{}", first, suggestion(first, names))});
  }
  return true;
}

std::string complaint_about_name(const std::string& name) {
  const bool is_blank = name.find_first_not_of(" \t\n") == std::string::npos;
  return is_blank ? "the name is empty: write one, or leave the option out" : "";
}

std::string hertz_of(const std::string& text) {
  const ScalarNumber number = parse_number(text, "Hz");
  if (!number.error.empty()) throw CLI::ValidationError(number.error);
  return fmt::format("{}", number.value);
}

std::string require_size(std::string text) {
  static const std::regex size("0*[1-9][0-9]* ?([kmgtpe]i?)?b?", std::regex::icase);
  if (std::regex_match(text, size)) return text;
  throw CLI::ValidationError(
      fmt::format("\"{}\" is no size: write one such as 8GB or 500MB", text));
}

}  // namespace modcal
