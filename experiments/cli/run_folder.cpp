#include <fmt/chrono.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <fstream>
#include <sstream>
#include <system_error>
#include <thread>

#include "experiments/cli/build_info.hpp"
#include "experiments/cli/runner.hpp"
#include "experiments/config/help.hpp"
#include "libsim/records/signal_file.hpp"

namespace modcal {
namespace {

constexpr std::string_view kResolvedWords =
    " with every default written out. Relative paths start ";

nlohmann::json read_provenance(const std::filesystem::path& out) {
  const std::filesystem::path file = out / kProvenanceFile;
  MODCAL_REQUIRE(std::filesystem::exists(file),
                 "{} holds no run: there is no provenance.json; name the folder given to "
                 "modcal run with --out",
                 out.string());
  nlohmann::json provenance = nlohmann::json::parse(content_of_file(file), nullptr, false);
  for (const char* key : {"folder", "program", "command"}) {
    const bool good =
        provenance.is_object() && provenance.contains(key) && provenance[key].is_string();
    MODCAL_REQUIRE(good,
                   "{} does not say where the run came from: {} is to be a text; run the same "
                   "command again",
                   file.string(), key);
  }
  return provenance;
}

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

nlohmann::ordered_json libraries() {
  nlohmann::ordered_json result = nlohmann::ordered_json::object();
  for (const auto& [name, version] : kBuildLibraries) result[name] = version;
  return result;
}

// As people write it: text without quotes, an object as "CLI11 2.1.2, fmt 9.1.0".
std::string plain_text(const nlohmann::ordered_json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (!value.is_object()) return value.dump();
  std::string list;
  for (const auto& [name, member] : value.items()) {
    list += (list.empty() ? "" : ", ") + name + ' ' + plain_text(member);
  }
  return list;
}

void collect_seeds(const nlohmann::ordered_json& options, const std::string& prefix,
                   nlohmann::ordered_json& seeds) {
  for (const auto& option : options) {
    const std::string key = option["key"].get<std::string>();
    if ((key == "seed" || key == "seeds") && option.contains("default")) {
      seeds[prefix + key] = option["default"];
    }
    const bool absent = option["type"] == "optional section" && !option.contains("present");
    if (option.contains("options") && !absent)
      collect_seeds(option["options"], prefix + key + ".", seeds);
  }
}

void add_seeds(const YamlNode& axes, nlohmann::ordered_json& seeds) {
  for (const YamlNode::Member& axis : axes.members) {
    if (axis.key != "seed" && !axis.key.ends_with(".seed")) continue;
    seeds[axis.key] = nlohmann::ordered_json::array();
    for (const YamlNode& value : axis.value.items) seeds[axis.key].push_back(value.text);
  }
}

void collect_swept_seeds(const YamlNode& root, nlohmann::ordered_json& seeds) {
  const YamlNode* sweep = root.find("sweep");
  if (sweep == nullptr) return;
  if (const YamlNode* product = sweep->find("product")) add_seeds(*product, seeds);
  if (const YamlNode* zip = sweep->find("zip")) {
    for (const YamlNode& group : zip->items) add_seeds(group, seeds);
  }
}

// Whether somebody makes the results of the folder. Shared, so that two who ask do not see each
// other.
bool is_locked(const std::filesystem::path& folder) {
  try {
    const FolderLock lock(folder, {.index = 1, .count = 2});
    return false;
  } catch (const InvalidInput&) {
    return true;
  }
}

}  // namespace

std::string resolved_text(const LoadedExperiment& loaded, const std::filesystem::path& folder) {
  return fmt::format(
      "# {}{}in {}: copy it there to run it.\n{}", loaded.document.file, kResolvedWords,
      std::filesystem::absolute(folder / "").lexically_normal().string(), loaded.resolved());
}

bool is_resolved_text(std::string_view text) {
  return text.starts_with("# ") &&
         text.substr(0, text.find('\n')).find(kResolvedWords) != std::string_view::npos;
}

StoredRun::StoredRun(std::filesystem::path out) : out_(std::move(out)) {
  const nlohmann::json provenance = read_provenance(out_);
  folder_ = provenance["folder"].get<std::string>();
  command_ = provenance["command"].get<std::string>();
  const auto directory = provenance.find("directory");
  if (directory != provenance.end() && directory->is_string()) {
    directory_ = directory->get<std::string>();
  }
  // What was done elsewhere may have needed more than there is here.
  constexpr double kAny = std::numeric_limits<double>::infinity();
  loaded_ = load_experiment(out_ / kResolvedFile, {}, {.memory = kAny});
  MODCAL_REQUIRE(!loaded_.has_errors(), "{}: the experiment cannot be read:\n{}",
                 (out_ / kResolvedFile).string(),
                 format_mistakes(loaded_.document, loaded_.mistakes));
  list_ = dynamic_cast<const TaskExperiment*>(loaded_.experiment.get());
  if (list_ == nullptr) refuse_single();
  finished_.emplace(out_, provenance["program"].get<std::string>());
  outcomes_.emplace(stored_outcomes(*list_, *finished_, folder_));
}

void StoredRun::require_some_done() const {
  for (std::size_t task = 0; task < tasks(); ++task) {
    if (outcomes_->has(task)) return;
  }
  throw_invalid_input(
      "{}: none of the {} tasks is done, by this program and with its files as they are now; run:\n"
      "  {}",
      out_.string(), tasks(), command_from_here());
}

std::string StoredRun::command_from_here() const {
  std::error_code ignored;
  // Of a folder that was moved with all around it the paths are what they were.
  const bool is_there = std::filesystem::is_directory(directory_, ignored);
  if (!is_there || std::filesystem::equivalent(directory_, ".", ignored)) return command_;
  return fmt::format("cd {} && {}", shell_word(directory_.string()), command_);
}

RunSettings StoredRun::settings(std::filesystem::path out) const {
  return {.out = std::move(out), .command = command_, .folder = folder_, .directory = directory_};
}

void StoredRun::refuse_single() const {
  const bool running = is_locked(out_);
  const std::string what = fmt::format("{} holds a run of kind {}, which is no list of tasks",
                                       out_.string(), loaded_.kind);
  if (std::filesystem::exists(out_ / kAnswerFile) &&
      std::filesystem::exists(out_ / report::kPageFile)) {
    // No place at the begin: the sentence goes on behind the colon.
    throw InvalidInput(fmt::format(
        "{}: its answer stands in {}, its report in {}{}", what, (out_ / kAnswerFile).string(),
        (out_ / report::kPageFile).string(), running ? "; another run works there now" : ""));
  }
  MODCAL_REQUIRE(!running,
                 "{0} and works there now: its answer will stand in {1}, its report in {2}", what,
                 (out_ / kAnswerFile).string(), (out_ / report::kPageFile).string());
  throw_invalid_input(
      "{} and is not finished: it was stopped, or failed, and has left no answer; run it again "
      "with:\n  {}",
      what, command_from_here());
}

nlohmann::ordered_json seeds_json(const LoadedExperiment& loaded) {
  nlohmann::ordered_json seeds = nlohmann::ordered_json::object();
  Choice<Experiment> choice = loaded.choice;
  collect_seeds(describe_options([&](OptionVisitor& visitor) { choice.visit_options(visitor); }),
                "", seeds);
  collect_swept_seeds(loaded.document.root, seeds);
  return seeds;
}

std::string version_text() {
  return fmt::format("modcal {} (commit {}{})", kBuildVersion, kBuildCommit,
                     kBuildDirty ? ", with local changes" : "");
}

std::string program_identity() {
  return fmt::format("modcal {} {} {} {} {}", kBuildVersion, kBuildCommit, kBuildCompiler,
                     kBuildType, kBuildSources);
}

nlohmann::ordered_json provenance_json(const std::string& command) {
  const std::time_t now = std::time(nullptr);
  return {{"version", kBuildVersion},
          {"commit", kBuildCommit},
          {"dirty", kBuildDirty},
          {"program", program_identity()},
          {"compiler", kBuildCompiler},
          {"build_type", kBuildType},
          {"libraries", libraries()},
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
    lines.push_back({name, plain_text(value)});
  }
  return lines;
}

}  // namespace modcal
