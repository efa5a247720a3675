// The program without its process: all commands, from the words of a command line to the answer.
#include "experiments/cli/command.hpp"
#include "experiments/cli/runner.hpp"
#include "libsim/base/instruction_set.hpp"

namespace modcal {
namespace {

void add_commands(CLI::App& app, const Chosen& chosen) {
  add_experiment_commands(app, chosen);
  add_plan_command(app, chosen);
  add_plugin_commands(app, chosen);
  add_record_commands(app, chosen);
  add_new_command(app, chosen);
  add_reproduce_command(app, chosen);
  add_stored_commands(app, chosen);
  add_compare_command(app, chosen);
  add_submit_command(app, chosen);
  add_tree_commands(app, chosen);
}

}  // namespace

ExitCode answer_words(int argc, const char* const* argv, void (*begin)()) {
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
    return finish_answer(ExitCode::kUsage);
  }
  if (is_unknown_command(app, argc, argv)) return finish_answer(ExitCode::kUsage);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return guarded([&] { return answer_of(app, error); });
  }
  begin();
  return guarded([&] {
    limit_instructions_by_environment();
    const Progress progress(app.get_subcommands().front()->get_name(), Progress::Of::kOne);
    return action();
  });
}

}  // namespace modcal
