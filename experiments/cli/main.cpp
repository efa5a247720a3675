#include <algorithm>
#include <cstdio>
#include <string_view>

#include "experiments/cli/command.hpp"
#include "experiments/cli/runner.hpp"

namespace modcal {
namespace {

int refused(ExitCode code) { return static_cast<int>(finish_answer(code)); }

void add_commands(CLI::App& app, const Chosen& chosen) {
  add_experiment_commands(app, chosen);
  add_plan_command(app, chosen);
  add_plugin_commands(app, chosen);
  add_inspect_command(app, chosen);
  add_new_command(app, chosen);
  add_reproduce_command(app, chosen);
  add_stored_commands(app, chosen);
  add_submit_command(app, chosen);
  add_tree_commands(app, chosen);
}

int main_of(int argc, char** argv) {
  // What stops before the command line is read is said as it asks for, too.
  answer_style().json = std::find(argv, argv + argc, std::string_view("--json")) != argv + argc;
  if (!prepare_streams(argc, argv)) return refused(ExitCode::kUsage);
  CLI::App app(
      "modcal: calibrates the modal model of a bowed string and identifies the friction "
      "force between bow and string from the reactions at the string's ends",
      "modcal");
  app.set_version_flag("-V,--version", version_text());
  app.require_subcommand(1);
  Action action;
  add_commands(app, [&action](Action chosen_action) { action = std::move(chosen_action); });
  if (argc == 1) {
    hint_text(app.help());
    return refused(ExitCode::kUsage);
  }
  if (is_unknown_command(app, argc, argv)) return refused(ExitCode::kUsage);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return static_cast<int>(guarded([&] { return answer_of(app, error); }));
  }
  catch_interrupts();
  return static_cast<int>(guarded(action));
}

}  // namespace
}  // namespace modcal

// What fails outside a command: memory, or a message that cannot be written.
int main(int argc, char** argv) {
  try {
    return modcal::main_of(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "internal error: %s\n", error.what());
    return static_cast<int>(modcal::ExitCode::kInternal);
  }
}
