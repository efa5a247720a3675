#include "experiments/cli/output_directory.hpp"

#include <algorithm>
#include <system_error>

#include "experiments/cli/runner.hpp"

namespace modcal {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kFolder = "the folder of the results";

// What cannot be looked at is not taken for missing.
fs::file_type type_of(const fs::path& file, bool follow) {
  std::error_code error;
  const fs::file_status status = follow ? fs::status(file, error) : fs::symlink_status(file, error);
  MODCAL_REQUIRE(status.type() != fs::file_type::none, "{}: cannot be looked at: {}", file.string(),
                 error.message());
  return status.type();
}

bool stands(const fs::path& file) { return type_of(file, false) != fs::file_type::not_found; }

bool is_regular(const fs::path& file) { return type_of(file, true) == fs::file_type::regular; }

// A list of names that somebody else wrote must not lead out of the folder.
bool may_be_removed(const fs::path& folder, const fs::path& name) {
  if (name.is_absolute() || name != name.lexically_normal() || *name.begin() == "..") return false;
  std::error_code error;
  if (name.has_parent_path() && fs::is_symlink(folder / name.parent_path(), error)) return false;
  return name == name.filename() || name == fs::path("figures") / name.filename() ||
         name == fs::path(kSlurmFolder) / name.filename();
}

bool is_folder_below(const fs::path& folder, const fs::path& name) {
  std::error_code error;
  return !name.empty() && name == name.filename() && name != "." && name != ".." &&
         fs::is_directory(fs::symlink_status(folder / name, error));
}

std::set<std::string> texts_in(const nlohmann::ordered_json& list) {
  std::set<std::string> texts;
  if (!list.is_array()) return texts;
  for (const auto& text : list) {
    if (text.is_string()) texts.insert(text.get<std::string>());
  }
  return texts;
}

}  // namespace

OutputDirectory::OutputDirectory(fs::path path) : path_(std::move(path)) {
  std::error_code error;
  fs::create_directories(path_, error);
  MODCAL_REQUIRE(!error && fs::is_directory(path_),
                 "the output folder {} cannot be made: {}; choose another one with --out",
                 path_.string(), error ? error.message() : "a file stands there");
  const std::string reason = why_not_writable(path_);
  MODCAL_REQUIRE(reason.empty(),
                 "the output folder {} cannot be written to: {}; choose another one with --out",
                 path_.string(), reason);
  folder_ = OpenFile::folder(path_, kFolder);
  remove_abandoned_parts(path_);
  remove_abandoned_parts(path_ / "figures");
  read_provenance();
  require_own({kProvenanceFile, kResolvedFile, report::kPageFile});
}

void OutputDirectory::require_own(const std::vector<std::string>& names) const {
  const std::string foreign = foreign_among(names);
  MODCAL_REQUIRE(foreign.empty(),
                 "{}: no run of modcal wrote this file, and the results would replace it; choose "
                 "another folder with --out",
                 (path_ / foreign).string());
}

void OutputDirectory::read_provenance() {
  using Json = nlohmann::ordered_json;
  const fs::path file = path_ / kProvenanceFile, resolved = path_ / kResolvedFile;
  const Json read = is_regular(file) ? Json::parse(content_of_file(file), nullptr, false) : Json();
  if (read.is_object() && read.value("program", Json()).is_string()) {
    provenance_ = read;
  } else if (!is_regular(resolved) || !is_resolved_text(content_of_file(resolved))) {
    earlier_.emplace();  // no run was here
    return;
  }
  earlier_folders_ = texts_in(provenance_.value("folders", Json::array()));
  const auto files = provenance_.find("files");
  if (files != provenance_.end() && files->is_array()) earlier_ = texts_in(*files);
}

std::string OutputDirectory::foreign_among(const std::vector<std::string>& names) const {
  const auto foreign = std::find_if(names.begin(), names.end(), [this](const std::string& name) {
    return earlier_ && !earlier_->contains(name) && !announced_.contains(name) &&
           stands(path_ / name);
  });
  return foreign == names.end() ? std::string() : *foreign;
}

bool OutputDirectory::holds_resolved(std::string_view settings) const {
  if (!is_regular(path_ / kResolvedFile)) return false;
  const std::string content = content_of_file(path_ / kResolvedFile);
  return content.substr(content.find('\n') + 1) == settings;  // npos + 1 is 0
}

void OutputDirectory::write_provenance(nlohmann::ordered_json provenance) {
  provenance_ = std::move(provenance);
  announce({kProvenanceFile, kResolvedFile});
  note(kProvenanceFile);
}

void OutputDirectory::announce(const std::vector<std::string>& names) {
  announced_.insert(names.begin(), names.end());
  write_names();
}

void OutputDirectory::keep(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    // Of a folder that does not say what is its run's, what stands there is.
    if (earlier_ ? earlier_->contains(name) : stands(path_ / name)) announced_.insert(name);
  }
}

void OutputDirectory::announce_folders(const std::vector<std::string>& names) {
  announced_folders_.insert(names.begin(), names.end());
  write_names();
}

void OutputDirectory::write_names() {
  provenance_.erase("files");
  provenance_.erase("folders");
  if (earlier_) {
    std::set<std::string> names = announced_;
    names.insert(earlier_->begin(), earlier_->end());
    provenance_["files"] = names;
  }
  std::set<std::string> folders = announced_folders_;
  folders.insert(earlier_folders_.begin(), earlier_folders_.end());
  if (!folders.empty()) provenance_["folders"] = folders;
  report::write_file_atomically(path_ / kProvenanceFile, json_text(provenance_));
}

void OutputDirectory::make_way() {
  if (!earlier_ || !has_provenance()) return;  // no run was here, or what it wrote is not known
  announce({kProvenanceFile, kResolvedFile});
  remove_earlier();
}

void OutputDirectory::remove_earlier() {
  remove_files();
  for (const std::string& name : earlier_folders_) {
    if (announced_folders_.contains(name) || !is_folder_below(path_, name)) continue;
    OutputDirectory(path_ / name).remove_run();
  }
  earlier_.emplace();
  earlier_folders_.clear();
  write_names();
}

void OutputDirectory::remove_run() {
  remove_files();
  std::error_code ignored;
  fs::remove(path_, ignored);
}

void OutputDirectory::remove_files() {
  for (const std::string& name : earlier_.value_or(std::set<std::string>())) {
    const fs::path file = path_ / name;
    if (announced_.contains(name) || !may_be_removed(path_, name)) continue;
    std::error_code error;
    if (!fs::is_directory(fs::symlink_status(file, error))) fs::remove(file, error);
    MODCAL_REQUIRE(!error, "{}, of an earlier run, cannot be removed: {}", file.string(),
                   error.message());
  }
  std::error_code ignored;
  for (const char* folder : {"figures", kSlurmFolder}) {
    fs::remove(path_ / folder, ignored);  // where nothing is left in it
  }
}

std::exception_ptr OutputDirectory::what_is_lost() const {
  try {
    require_in_place();
  } catch (const LostOutput&) {
    return std::current_exception();
  }
  return nullptr;
}

void OutputDirectory::require_in_place() const {
  folder_.require_in_place(kFolder);
  for (const fs::path& file : written_) {
    if (fs::exists(file)) continue;
    throw LostOutput(fmt::format(
        "{}: the file was deleted or moved while the command worked; run the same command again",
        file.string()));
  }
}

}  // namespace modcal
