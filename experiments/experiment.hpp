// One kind of experiment: what `kind:` names at the top of a file.
#pragma once

#include <nlohmann/json.hpp>

#include "experiments/study/study.hpp"

namespace modcal {

/// Something about the settings that no single option shows.
struct Finding {
  std::string path;  ///< dotted path of the option it concerns
  std::string text;
  bool is_error = true;
  bool is_idle = false;  ///< what it names does nothing: no mistake where another task reads it
  /// Of a task of a list, the axis that it concerns and its value there, as written; else empty.
  std::string axis = {}, value = {};
};

/// The simulations of a run, by one of them.
struct PlannedSimulations {
  TruthOptions truth;
  double sample_rate = 0.0;
  OutputRequest outputs;
  std::size_t count = 1;  ///< distinct ones
  /// Most numbers a sample that the work on one of them holds at a time, about, with its signals.
  double numbers_per_sample = 100.0;
  bool are_kept = true;  ///< until the run ends, for other tasks
  /// Those of other scenes: plucks beside strokes.
  std::vector<PlannedSimulations> others = {};
};

/// A file whose content a run depends on.
struct FileRead {
  std::string name;         ///< from the folder of the experiment's file
  std::string key;          ///< where it is stated, such as "record.file"
  std::string format = {};  ///< of a record; empty: another file
  double channels = 0.0;    ///< that are taken of it
  /// Most numbers a sample that the work on it holds at a time, about, beside what was read.
  double numbers_per_sample = 0.0;
  double numbers_per_second = 0.0;  ///< the same of what is left of a band
  double numbers = 0.0;             ///< those that do not depend on the file's length
  /// Files that this one names, whose content is a part of it; null: it names none.
  std::vector<std::filesystem::path> (*named)(const std::filesystem::path&) = nullptr;

  bool operator==(const FileRead&) const = default;
};

/// A line of what a run would do, and the same as data for programs.
struct PlanLine {
  std::string text;
  nlohmann::ordered_json facts = nlohmann::ordered_json::object();

  PlanLine(std::string line) : text(std::move(line)) {}
  PlanLine(std::string line, nlohmann::ordered_json data)
      : text(std::move(line)), facts(std::move(data)) {}
};

/// Of all lines together: lists of one name are one list.
nlohmann::ordered_json facts_of(const std::vector<PlanLine>& lines);

struct LimitQuestion;
struct SearchTask;

class Experiment {
 public:
  static constexpr std::string_view kKind = "experiment";
  static Registry<Experiment> registry();

  virtual ~Experiment() = default;
  /// Physics and consistency of the settings; nothing is computed.
  virtual std::vector<Finding> lint() const = 0;
  /// What the recorded files say against the settings; reads them, from the folder of the
  /// experiment's file.
  virtual std::vector<Finding> lint_records(const std::filesystem::path& /*folder*/) const {
    return {};
  }
  /// What a run would do, one line each.
  virtual std::vector<PlanLine> plan() const = 0;
  /// What it would simulate; nothing where it simulates nothing.
  virtual std::optional<PlannedSimulations> planned_simulations() const { return std::nullopt; }
  virtual std::vector<FileRead> files_read() const { return {}; }
  /// What it calibrates, whose limit can be stated; null where it calibrates nothing.
  virtual std::shared_ptr<const LimitQuestion> limit_question() const { return nullptr; }
  /// Its search with the records made or read, for who searches by himself; null where it
  /// calibrates nothing.
  virtual std::shared_ptr<const SearchTask> search_task(const StudyContext& /*context*/) const {
    return nullptr;
  }
  /// What to state where the structure is a table of modes, for who stated it here.
  virtual std::string_view for_structures() const = 0;
  virtual StudyResult run(const StudyContext& context) const = 0;
};

}  // namespace modcal
