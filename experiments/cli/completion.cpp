#include "experiments/cli/completion.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

namespace modcal {
namespace {

bool takes_value(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

// What stands behind a command: words, or what the program itself lists of a kind.
struct Place {
  std::string_view command;
  int number;             // 1 is that behind the command
  std::string_view kind;  // empty: the kinds; "before": that of the word before
  std::string_view words = {};
};
constexpr Place kPlaces[] = {
    {"list", 1, ""},          {"describe", 1, ""},         {"describe", 2, "before"},
    {"new", 1, "experiment"}, {"help", 1, "", "commands"}, {"completion", 1, "", "bash zsh fish"}};

// As all three shells expand it. before: the word before, as this one calls it.
std::string words_of(const Place& place, const CLI::App& app, std::string_view before) {
  if (place.words == "commands") {
    std::string names;
    for (const CLI::App* command : commands_of(app)) names += command->get_name() + " ";
    return names;
  }
  if (!place.words.empty()) return std::string(place.words);
  return fmt::format("$(modcal list {} 2>/dev/null | cut -d\" \" -f1)",
                     place.kind == "before" ? before : place.kind);
}

std::string bash_completion(const CLI::App& app) {
  std::vector<std::string> names;
  std::string cases, places;
  for (const CLI::App* command : commands_of(app)) {
    names.push_back(command->get_name());
    std::vector<std::string> words;
    for (const CLI::Option* option : options_of(*command)) {
      for (std::string& name : names_of(*option)) words.push_back(std::move(name));
    }
    cases += fmt::format("    {}) options=\"{}\" ;;\n", names.back(), fmt::join(words, " "));
  }
  for (const Place& place : kPlaces) {
    places += fmt::format("    {}:{}) words=\"{}\" ;;\n", place.command, place.number + 1,
                          words_of(place, app, "${COMP_WORDS[2]}"));
  }
  return fmt::format(R"(# bash completion of modcal
_modcal() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} options= words=
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ]; then
    COMPREPLY=($(compgen -W "{0} --help --version" -- "$current"))
    return
  fi
  case ${{COMP_WORDS[1]}} in
{1}  esac
  case $current in
    -*) COMPREPLY=($(compgen -W "$options" -- "$current")); return ;;
  esac
  case ${{COMP_WORDS[1]}}:$COMP_CWORD in
{2}  esac
  COMPREPLY=($(compgen -W "$words" -- "$current"))
}}
complete -o default -F _modcal modcal
)",
                     fmt::join(names, " "), cases, places);
}

std::string with_escapes(std::string_view text, std::string_view special, std::string_view escape) {
  std::string result;
  for (const char c : text) {
    if (special.find(c) != std::string_view::npos) result += escape;
    result += c;
  }
  return result;
}

// Inside single quotes of zsh, where '[', ']' and ':' have a meaning for _arguments.
std::string zsh_text(std::string_view text) {
  std::string result;
  for (const char c : with_escapes(text, "[]:\\", "\\")) {
    result += c == '\'' ? "'\\''" : std::string(1, c);
  }
  return result;
}

std::string zsh_completion(const CLI::App& app) {
  std::string commands, cases;
  for (const CLI::App* command : commands_of(app)) {
    commands +=
        fmt::format("    '{}:{}'\n", command->get_name(), zsh_text(command->get_description()));
    cases += fmt::format("    {})\n      _arguments \\\n", command->get_name());
    for (const CLI::Option* option : options_of(*command)) {
      for (const std::string& name : names_of(*option)) {
        cases += fmt::format("        '{}[{}]{}' \\\n", name, zsh_text(option->get_description()),
                             takes_value(*option) ? ":value:_files" : "");
      }
    }
    for (const Place& place : kPlaces) {
      if (place.command != command->get_name()) continue;
      cases += fmt::format("        '{}:word:{{compadd -- {}}}' \\\n", place.number,
                           words_of(place, app, "$words[2]"));
    }
    cases += "        '*:file:_files' ;;\n";
  }
  return fmt::format(R"(#compdef modcal
_modcal() {{
  local -a commands
  commands=(
{}  )
  if (( CURRENT == 2 )); then
    _describe command commands
    return
  fi
  local command=$words[2]
  shift words
  (( CURRENT-- ))
  case $command in
{}  esac
}}
_modcal "$@"
)",
                     commands, cases);
}

std::string fish_completion(const CLI::App& app) {
  const auto quoted = [](std::string_view text) {
    return fmt::format("'{}'", with_escapes(text, "'\\", "\\"));
  };
  std::string text = "# fish completion of modcal\n";
  for (const CLI::App* command : commands_of(app)) {
    const std::string& name = command->get_name();
    text += fmt::format("complete -c modcal -n __fish_use_subcommand -f -a {} -d {}\n", name,
                        quoted(command->get_description()));
    for (const CLI::Option* option : options_of(*command)) {
      text += fmt::format("complete -c modcal -n '__fish_seen_subcommand_from {}'", name);
      for (const std::string& letter : option->get_snames()) text += " -s " + letter;
      for (const std::string& word : option->get_lnames()) text += " -l " + word;
      text += fmt::format("{} -d {}\n", takes_value(*option) ? " -r" : "",
                          quoted(option->get_description()));
    }
  }
  for (const Place& place : kPlaces) {
    text += fmt::format(
        "complete -c modcal -n '__fish_seen_subcommand_from {}; and test (count (commandline "
        "-opc)) -eq {}' -f -a '{}'\n",
        place.command, place.number + 1, words_of(place, app, "(commandline -opc)[3]"));
  }
  return text;
}

}  // namespace

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

std::vector<const CLI::Option*> options_of(const CLI::App& command) {
  std::vector<const CLI::Option*> options = command.get_options();
  std::erase_if(options, [](const CLI::Option* option) { return option->get_positional(); });
  return options;
}

std::string completion_script(const CLI::App& app, std::string_view shell) {
  if (shell == "bash") return bash_completion(app);
  return shell == "zsh" ? zsh_completion(app) : fish_completion(app);
}

}  // namespace modcal
