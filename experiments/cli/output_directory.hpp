// The folder a run leaves its results in.
#pragma once

#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/report/encoding.hpp"
#include "libsim/base/files.hpp"

namespace modcal {

/// Knows from provenance.json, whose "files" names them, which files of the folder runs have
/// written: those are replaced, or removed once other results stand; no other file is touched. Its
/// "folders" are those below that hold results of the same run.
class OutputDirectory {
 public:
  /// Makes the folder and checks that files can be written there, before anything is computed;
  /// removes what killed runs have left half written. Throws InvalidInput where they cannot, and
  /// where a file that no run wrote has the name of one that every run writes.
  explicit OutputDirectory(std::filesystem::path path);

  const std::filesystem::path& path() const { return path_; }
  /// The first of the names that a file has which no run wrote; empty: none.
  std::string foreign_among(const std::vector<std::string>& names) const;
  /// Whether resolved.yaml, but for its first line, is this text.
  bool holds_resolved(std::string_view settings) const;
  /// Whether what runs have written here is said to come from somewhere.
  bool has_provenance() const { return !provenance_.empty(); }
  /// program_identity() of the run that wrote here last; empty: not known.
  std::string program() const { return provenance_.value("program", std::string()); }
  /// Throws InvalidInput where a file that no run wrote has one of the names.
  void require_own(const std::vector<std::string>& names) const;
  /// Path of a file that is about to be written.
  std::filesystem::path note(std::string_view name) const {
    written_.push_back(path_ / name);
    return written_.back();
  }
  /// Writes the whole file under a temporary name and renames it: an existing file is replaced by a
  /// complete one or not at all. Throws InvalidInput where that fails (no space, no permission).
  void write_text(std::string_view name, std::string_view content) const {
    report::write_file_atomically(note(name), content);
  }
  /// Where the results come from; names the files that stand here already, too.
  void write_provenance(nlohmann::ordered_json provenance);
  /// Before files of these names are written, so that those of a killed run are known as well.
  void announce(const std::vector<std::string>& names);
  /// Those of them that an earlier run wrote stay where they are.
  void keep(const std::vector<std::string>& names);
  void announce_folders(const std::vector<std::string>& names);
  /// Once they stand: removes what earlier runs wrote and this one has not announced.
  void remove_earlier();
  /// Before settings are written whose results do not stand yet: no others stay beside them.
  void make_way();
  /// Throws LostOutput where the folder, or a file that was written, was deleted or moved.
  void require_in_place() const;
  /// The LostOutput that require_in_place() would throw; null: nothing is lost.
  std::exception_ptr what_is_lost() const;

 private:
  void read_provenance();
  void write_names();
  void remove_files();
  /// All that runs have written, and the folder where nothing else stands in it.
  void remove_run();

  std::filesystem::path path_;
  OpenFile folder_;
  nlohmann::ordered_json provenance_ = nlohmann::ordered_json::object();
  /// What runs have written; none: a run was here and what it wrote is not known.
  std::optional<std::set<std::string>> earlier_;
  std::set<std::string> announced_;
  std::set<std::string> earlier_folders_, announced_folders_;
  mutable std::vector<std::filesystem::path> written_;
};

}  // namespace modcal
