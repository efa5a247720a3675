// One command of modcal: adds itself to the command line and says what to do when it is chosen.
#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <functional>
#include <memory>

#include "experiments/cli/exit_code.hpp"

namespace modcal {

using Action = std::function<ExitCode()>;
/// Called with the chosen command's action while the command line is being parsed.
using Chosen = std::function<void(Action)>;

/// A command of the line: `declare` says what it reads, `act` what it does with that.
template <typename Arguments>
void add_command(CLI::App& app, const Chosen& chosen, const char* name, const char* meaning,
                 void (*declare)(CLI::App& command, Arguments& arguments),
                 ExitCode (*act)(const Arguments& arguments)) {
  CLI::App* command = app.add_subcommand(name, meaning);
  auto arguments = std::make_shared<Arguments>();
  declare(*command, *arguments);
  command->callback([=] { chosen([=] { return act(*arguments); }); });
}

void add_experiment_commands(CLI::App& app, const Chosen& chosen);
void add_plan_command(CLI::App& app, const Chosen& chosen);
void add_plugin_commands(CLI::App& app, const Chosen& chosen);
void add_inspect_command(CLI::App& app, const Chosen& chosen);
void add_reproduce_command(CLI::App& app, const Chosen& chosen);
void add_stored_commands(CLI::App& app, const Chosen& chosen);
void add_submit_command(CLI::App& app, const Chosen& chosen);

}  // namespace modcal
