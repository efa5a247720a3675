#include <cstdio>

#include "experiments/cli/command.hpp"
#include "experiments/cli/runner.hpp"

namespace modcal {
namespace {

int main_of(int argc, char** argv) {
  if (!prepare_streams(argc, argv)) return static_cast<int>(ExitCode::kUsage);
  CLI::App app(
      "modcal: calibrates the modal model of a bowed string and identifies the friction "
      "force between bow and string from the reactions at the string's ends");
  app.set_version_flag("--version", version_text());
  app.require_subcommand(1);
  Action action;
  const Chosen chosen = [&action](Action chosen_action) { action = std::move(chosen_action); };
  add_experiment_commands(app, chosen);
  add_plan_command(app, chosen);
  add_plugin_commands(app, chosen);
  add_inspect_command(app, chosen);
  add_new_command(app, chosen);
  add_reproduce_command(app, chosen);
  add_stored_commands(app, chosen);
  add_submit_command(app, chosen);
  if (is_unknown_command(app, argc, argv)) return static_cast<int>(ExitCode::kUsage);
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
