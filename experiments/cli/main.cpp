#include <algorithm>
#include <cstdio>
#include <string_view>

#include "experiments/cli/command.hpp"

namespace modcal {
namespace {

ExitCode main_of(int argc, char** argv) {
  // What stops before the command line is read is said as it asks for, too.
  answer_style().json = std::find(argv, argv + argc, std::string_view("--json")) != argv + argc;
  if (!prepare_streams(argc, argv)) return finish_answer(ExitCode::kUsage);
  return answer_words(argc, argv, catch_interrupts);
}

}  // namespace
}  // namespace modcal

// What fails outside a command: memory, or a message that cannot be written.
int main(int argc, char** argv) {
  try {
    return static_cast<int>(modcal::main_of(argc, argv));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "internal error: %s\n", error.what());
    return static_cast<int>(modcal::ExitCode::kInternal);
  }
}
