// One command of modcal: adds itself to the command line and says what to do when it is chosen.
#pragma once

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <functional>

#include "experiments/cli/exit_code.hpp"

namespace modcal {

using Action = std::function<ExitCode()>;
/// Called with the chosen command's action while the command line is being parsed.
using Chosen = std::function<void(Action)>;

void add_run_command(CLI::App& app, const Chosen& chosen);
void add_validate_command(CLI::App& app, const Chosen& chosen);
void add_plan_command(CLI::App& app, const Chosen& chosen);
void add_limit_command(CLI::App& app, const Chosen& chosen);
void add_list_command(CLI::App& app, const Chosen& chosen);
void add_describe_command(CLI::App& app, const Chosen& chosen);
void add_schema_command(CLI::App& app, const Chosen& chosen);
void add_inspect_command(CLI::App& app, const Chosen& chosen);
void add_reproduce_command(CLI::App& app, const Chosen& chosen);
void add_status_command(CLI::App& app, const Chosen& chosen);
void add_merge_command(CLI::App& app, const Chosen& chosen);
void add_report_command(CLI::App& app, const Chosen& chosen);
void add_replay_command(CLI::App& app, const Chosen& chosen);
void add_compare_command(CLI::App& app, const Chosen& chosen);
void add_submit_command(CLI::App& app, const Chosen& chosen);

}  // namespace modcal
