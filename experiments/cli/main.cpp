#include <fmt/format.h>

#include <cstdio>
#include <exception>

#include "experiments/cli/command.hpp"
#include "experiments/cli/interrupt.hpp"
#include "experiments/cli/provenance.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

ExitCode act(const Action& action) {
  try {
    return action();
  } catch (const InvalidInput& error) {
    fmt::print(stderr, "error: {}\n", error.what());
    return ExitCode::kInvalidInput;
  } catch (const Interrupted&) {
    return ExitCode::kInterrupted;
  } catch (const std::exception& error) {
    fmt::print(stderr, "internal error: {}\nPlease report it with the file and the command.\n",
               error.what());
    return ExitCode::kInternal;
  }
}

int main_of(int argc, char** argv) {
  CLI::App app(
      "modcal: calibrates the modal model of a bowed string and identifies the friction "
      "force between bow and string from the reactions at the string's ends");
  app.set_version_flag("--version", version_text());
  app.require_subcommand(1);
  Action action;
  const Chosen chosen = [&action](Action chosen_action) { action = std::move(chosen_action); };
  add_run_command(app, chosen);
  add_validate_command(app, chosen);
  add_plan_command(app, chosen);
  add_list_command(app, chosen);
  add_describe_command(app, chosen);
  add_schema_command(app, chosen);
  add_inspect_command(app, chosen);
  add_reproduce_command(app, chosen);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::kUsage);
  }
  catch_interrupts();
  return static_cast<int>(act(action));
}

}  // namespace
}  // namespace modcal

int main(int argc, char** argv) { return modcal::main_of(argc, argv); }
