#include "experiments/cli/run_folder.hpp"

#include <unistd.h>

#include <cstring>
#include <fstream>
#include <system_error>

#include "libsim/records/signal_file.hpp"

namespace modcal {
namespace {

nlohmann::json read_provenance(const std::filesystem::path& out) {
  std::ifstream stream(out / "provenance.json");
  MODCAL_REQUIRE(stream.good(),
                 "{} holds no run: there is no provenance.json; name the folder given to "
                 "modcal run with --out",
                 out.string());
  nlohmann::json provenance = nlohmann::json::parse(stream, nullptr, false);
  const bool good = provenance.is_object() && provenance.contains("folder") &&
                    provenance.contains("program") && provenance.contains("command");
  MODCAL_REQUIRE(good, "{}: provenance.json does not say where the run came from", out.string());
  return provenance;
}

}  // namespace

OutputDirectory::OutputDirectory(std::filesystem::path path) : path_(std::move(path)) {
  std::error_code error;
  std::filesystem::create_directories(path_, error);
  MODCAL_REQUIRE(!error && std::filesystem::is_directory(path_),
                 "the output folder {} cannot be made: {}; choose another one with --out",
                 path_.string(), error ? error.message() : "a file stands there");
  const std::filesystem::path probe = path_ / ".modcal-write-test";
  std::ofstream stream(probe);
  stream << "probe" << std::flush;
  const bool good = stream.good();
  const std::string reason = std::strerror(errno);
  stream.close();
  std::filesystem::remove(probe, error);
  MODCAL_REQUIRE(good,
                 "the output folder {} cannot be written to: {}; choose another one with --out",
                 path_.string(), reason);
}

StoredRun::StoredRun(std::filesystem::path out) : out_(std::move(out)) {
  const nlohmann::json provenance = read_provenance(out_);
  folder_ = provenance["folder"].get<std::string>();
  command_ = provenance["command"].get<std::string>();
  loaded_ = load_experiment(out_ / "resolved.yaml");
  MODCAL_REQUIRE(!loaded_.has_errors(), "{}: the experiment cannot be read:\n{}",
                 (out_ / "resolved.yaml").string(),
                 format_mistakes(loaded_.document, loaded_.mistakes));
  list_ = dynamic_cast<const TaskExperiment*>(loaded_.experiment.get());
  MODCAL_REQUIRE(list_ != nullptr, "{} holds a run of kind {}, which is no list of tasks",
                 out_.string(), loaded_.kind);
  finished_.emplace(out_, provenance["program"].get<std::string>());
  outcomes_.emplace(stored_outcomes(*list_, *finished_, folder_));
}

}  // namespace modcal
