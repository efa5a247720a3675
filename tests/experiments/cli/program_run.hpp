// Runs the program as a user does and keeps what it says.
#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <sstream>
#include <string>
#include <string_view>

#include "tests/folder_test.hpp"

namespace modcal::testing {

/// A scene of a few milliseconds of work.
inline const std::string kSmallScene = R"(scene:
  string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz, modes: 10}
  bow: {position: 30 mm, velocity: 0.1 m/s, normal_force: 1 N}
  friction: {type: coulomb_exponential, static: 0.4, dynamic: 0.2, decay: 5 s/m}
  duration: 0.1 s
simulator: {type: newmark_explicit, time_step: 4 us}
)";
inline const std::string kSmallSimulation =
    "kind: simulate\ntitle: small\n" + kSmallScene +
    "measurement: {sample_rate: 12.5 kHz, noise_level: 1 %}\n";

/// Axes that make eight tasks of it.
inline constexpr std::string_view kEightTasks = R"(sweep:
  product:
    scene.bow.normal_force: [0.98 N, 1 N]
    seed: [1, 2, 3, 4]
)";

/// Axes that make so many tasks of it, of which `submit` does not do all.
inline std::string many_seeds(int count) {
  std::string seeds = "1";
  for (int seed = 2; seed <= count; ++seed) seeds += ", " + std::to_string(seed);
  return "sweep: {product: {seed: [" + seeds + "]}}\n";
}

/// A test with a folder of its own.
class ProgramTest : public FolderTest {
 protected:
  struct Outcome {
    int code = -1;
    std::string out;
    std::string err;
  };

  /// `modcal` followed by `arguments`, words of a shell, in the test's folder.
  Outcome modcal(const std::string& arguments) const {
    return shell("'" MODCAL_PROGRAM "' " + arguments);
  }
  Outcome shell(const std::string& command) const {
    const std::string line = "cd '" + folder().string() + "' && { " + command + "; } >.out 2>.err";
    const int status = std::system(line.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, content_of(folder() / ".out"),
            content_of(folder() / ".err")};
  }
};

/// One with a small simulation in small.yaml and a list of eight in list.yaml.
class SmallRuns : public ProgramTest {
 protected:
  SmallRuns() {
    write("small.yaml", kSmallSimulation);
    write("list.yaml", kSmallSimulation + std::string(kEightTasks));
  }
};

}  // namespace modcal::testing
