// Runs another program and waits for it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace modcal::report {

struct ProcessOutcome {
  bool started = false;  ///< false: the program was not found or could not be run
  int exit_code = -1;    ///< 128 + n after signal n
  std::string output;    ///< what it wrote to stdout and stderr, or why it did not start
  bool succeeded() const { return started && exit_code == 0; }
};

/// Runs `arguments` (the program first, looked up in PATH) in `directory` with an empty stdin.
ProcessOutcome run_process(const std::vector<std::string>& arguments,
                           const std::filesystem::path& directory);

}  // namespace modcal::report
