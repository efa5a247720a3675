// help, completion and man: what the tree of commands says of itself.
#include <fmt/ranges.h>

#include "experiments/cli/command.hpp"
#include "experiments/cli/completion.hpp"
#include "experiments/cli/runner.hpp"
#include "experiments/config/reader.hpp"

namespace modcal {
namespace {

struct Example {
  std::string_view command, line, meaning;
};
constexpr Example kExamples[] = {
    {"run", "modcal run mine.yaml", "results in out/mine"},
    {"run", "modcal run mine.yaml --set seed=2 --out second", "one value changed"},
    {"validate", "modcal validate mine.yaml", "every mistake with its place"},
    {"validate", "modcal validate mine.yaml --json", "the same for programs"},
    {"limit", "modcal limit mine.yaml", "standard deviations to expect"},
    {"plan", "modcal plan mine.yaml", "what a run would take"},
    {"list", "modcal list optimizer", "all optimizers"},
    {"describe", "modcal describe experiment calibrate", "every key of a file"},
    {"schema", "modcal schema > modcal.schema.json", "for an editor"},
    {"schema", "modcal schema --answers", "what --json answers, for programs"},
    {"inspect", "modcal inspect record.csv", "channels, rate, levels, noise"},
    {"convert", "modcal convert record.uff record.csv", "the same channels in another format"},
    {"new", "modcal new calibrate record.csv --length '0.33 m' --out mine.yaml",
     "an experiment on a record"},
    {"new", "modcal new simulate", "an example of a kind"},
    {"reproduce", "modcal reproduce table1", "Table 1 of the paper"},
    {"status", "modcal status out/table1", "how far the run is"},
    {"merge", "modcal merge out/table1", "out/table1/results.sqlite"},
    {"report", "modcal report out/table1", "the report of what is finished"},
    {"replay", "modcal replay out/table1 12", "task 12 with all its figures"},
    {"compare", "modcal compare out/first out/second", "by a paired bootstrap"},
    {"submit", "modcal submit list.yaml --slurm --dry-run", "scripts, nothing submitted"},
    {"help", "modcal help run", "the same as modcal run --help"},
    {"completion", "modcal completion bash > ~/.local/share/bash-completion/completions/modcal",
     "where no package has installed it"},
    {"man", "modcal man | man -l -", "the manual page"},
};

std::string examples_of(std::string_view command) {
  std::string text;
  for (const Example& example : kExamples) {
    if (example.command == command)
      text += fmt::format("  {}\n      {}\n", example.line, example.meaning);
  }
  return text.empty() ? text : "Examples:\n" + text;
}

constexpr ExitCode kCodes[] = {ExitCode::kOk,
                               ExitCode::kInternal,
                               ExitCode::kUsage,
                               ExitCode::kInvalidInput,
                               ExitCode::kSomeTasksFailed,
                               ExitCode::kAcceptanceMissed,
                               ExitCode::kNothingMeasured,
                               ExitCode::kOutputLost,
                               ExitCode::kInterrupted};

std::string exit_codes() {
  std::string text = "Exit codes:\n";
  for (const ExitCode code : kCodes) {
    text += fmt::format("  {:<4}{}\n", static_cast<int>(code), meaning_of(code));
  }
  return text;
}

struct TreeArguments {
  const CLI::App* app = nullptr;
  std::string word;  ///< command or shell
};

void declare_tree(CLI::App& command, TreeArguments& arguments) {
  arguments.app = command.get_parent();
}

void declare_help(CLI::App& command, TreeArguments& arguments) {
  declare_tree(command, arguments);
  command.add_option("command", arguments.word, "command to explain; default: all in short");
}

// App::help() would explain the command that was chosen.
std::string help_of(const CLI::App& command, const std::string& name) {
  return command.get_formatter()->make_help(&command, name, CLI::AppFormatMode::Normal);
}

ExitCode help(const TreeArguments& arguments) {
  if (arguments.word.empty()) {
    say_text(help_of(*arguments.app, "modcal"));
    return ExitCode::kOk;
  }
  std::vector<std::string> names;
  for (const CLI::App* command : commands_of(*arguments.app)) {
    names.push_back(command->get_name());
    if (names.back() != arguments.word) continue;
    say_text(help_of(*command, "modcal " + names.back()));
    return ExitCode::kOk;
  }
  throw_invalid_input("unknown command \"{}\"{}", arguments.word,
                      suggestion(arguments.word, names));
}

void declare_completion(CLI::App& command, TreeArguments& arguments) {
  declare_tree(command, arguments);
  command.add_option("shell", arguments.word, "bash, zsh or fish")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}));
}

ExitCode completion(const TreeArguments& arguments) {
  say_text(completion_script(*arguments.app, arguments.word));
  return ExitCode::kOk;
}

// The manual page.

// Text of troff: hyphens that can be copied, no line that is a request.
std::string troff(std::string_view text) {
  std::string result;
  for (const char c : text) {
    if ((c == '.' || c == '\'') && (result.empty() || result.back() == '\n')) result += "\\&";
    result += c == '\\' ? "\\e" : c == '-' ? "\\-" : std::string(1, c);
  }
  return result;
}

std::string manual_of(const CLI::App& app, const CLI::App& command) {
  std::string text = fmt::format(".SS {}\n{}.\n.PP\n.B {}\n", troff("modcal " + command.get_name()),
                                 troff(command.get_description()), troff(usage_of(app, command)));
  for (const CLI::Option* option : command.get_options()) {
    const std::string name = option->get_positional()
                                 ? option->get_name()
                                 : fmt::format("{}", fmt::join(names_of(*option), ", "));
    text += fmt::format(".TP\n.B {}\n{}\n", troff(name), troff(option->get_description()));
  }
  for (const Example& example : kExamples) {
    if (example.command != command.get_name()) continue;
    text += fmt::format(".PP\nExample: {}\n.PP\n.nf\n{}\n.fi\n", troff(example.meaning),
                        troff(example.line));
  }
  return text;
}

ExitCode print_manual(const TreeArguments& arguments) {
  const CLI::App& app = *arguments.app;
  std::string text = fmt::format(
      ".TH MODCAL 1 \"\" \"{0}\" \"User Commands\"\n"
      ".SH NAME\nmodcal \\- calibrates bowed strings and identifies the force of the bow\n"
      ".SH SYNOPSIS\n.B {1}\n"
      ".SH DESCRIPTION\n{2}.\n"
      ".SH COMMANDS\n",
      troff(version_text()), troff(usage_of(app, app)), troff(app.get_description()));
  for (const CLI::App* command : commands_of(app)) text += manual_of(app, *command);
  text += ".SH EXIT STATUS\n";
  for (const ExitCode code : kCodes) {
    text += fmt::format(".TP\n.B {}\n{}\n", static_cast<int>(code), meaning_of(code));
  }
  say_text(text);
  return ExitCode::kOk;
}

}  // namespace

void add_tree_commands(CLI::App& app, const Chosen& chosen) {
  add_command(app, chosen, "help", "Explain a command", declare_help, help);
  add_command(app, chosen, "completion", "Print the completion script of a shell",
              declare_completion, completion);
  add_command(app, chosen, "man", "Print the manual page", declare_tree, print_manual);
  app.footer(
      "Examples:\n"
      "  modcal inspect record.csv\n"
      "  modcal new calibrate record.csv --length '0.33 m' --out mine.yaml\n"
      "  modcal validate mine.yaml\n"
      "  modcal run mine.yaml\n\n" +
      exit_codes());
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
    command->footer(examples_of(command->get_name()));
  }
}

}  // namespace modcal
