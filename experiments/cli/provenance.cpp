#include "experiments/cli/provenance.hpp"

#include <fmt/chrono.h>
#include <sys/utsname.h>

#include <Eigen/Core>
#include <fstream>
#include <thread>

#include "experiments/cli/build_info.hpp"

namespace modcal {
namespace {

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

std::string system_name() {
  utsname name{};
  return uname(&name) == 0 ? fmt::format("{} {} {}", name.sysname, name.release, name.machine)
                           : std::string("unknown");
}

}  // namespace

std::string version_text() {
  return fmt::format("modcal {} (commit {}{})", kBuildVersion, kBuildCommit,
                     kBuildDirty ? ", with local changes" : "");
}

nlohmann::ordered_json provenance_json(const std::string& command) {
  const std::time_t now = std::time(nullptr);
  return {{"version", kBuildVersion},
          {"commit", kBuildCommit},
          {"dirty", kBuildDirty},
          {"compiler", kBuildCompiler},
          {"build_type", kBuildType},
          {"libraries",
           {{"eigen", fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION,
                                  EIGEN_MINOR_VERSION)},
            {"fftw", kBuildFftw},
            {"nlopt", kBuildNlopt},
            {"ceres", kBuildCeres},
            {"fmt", fmt::format("{}", FMT_VERSION)}}},
          {"processor", processor()},
          {"hardware_threads", std::thread::hardware_concurrency()},
          {"system", system_name()},
          {"command", command},
          {"time_utc", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(now))}};
}

std::vector<report::ProvenanceLine> provenance_lines(const std::string& command) {
  std::vector<report::ProvenanceLine> lines;
  const nlohmann::ordered_json provenance = provenance_json(command);
  for (const auto& [name, value] : provenance.items()) {
    if (name == "command") continue;
    lines.push_back({name, value.is_string() ? value.get<std::string>() : value.dump()});
  }
  return lines;
}

}  // namespace modcal
