// The tree of commands for shells.
#pragma once

#include <CLI/App.hpp>

namespace modcal {

std::vector<const CLI::App*> commands_of(const CLI::App& app);
/// Those of a command that are no words of their own.
std::vector<const CLI::Option*> options_of(const CLI::App& command);
/// "-q" and "--quiet".
std::vector<std::string> names_of(const CLI::Option& option);

/// Script that completes command lines in "bash", "zsh" or "fish".
std::string completion_script(const CLI::App& app, std::string_view shell);

}  // namespace modcal
