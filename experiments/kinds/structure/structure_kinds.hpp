// Kinds "fit_modes" and "identify_force": any structure, from a strike to the force.
#pragma once

#include "experiments/experiment.hpp"
#include "experiments/kinds/structure/structure_files.hpp"
#include "libinverse/structure/contact_place.hpp"
#include "libinverse/structure/force/structure_force.hpp"
#include "libinverse/structure/strikes/strike_fit.hpp"

namespace modcal {

/// The file of a structure's record.
FileRead file_read(const StructureRecordOptions& record);

/// A further strike at the same place: another file of the same channels, or another part of it.
struct OtherStrikeOptions {
  std::string file;  ///< empty: that of the record
  double start = 0.0;
  double stop = std::numeric_limits<double>::quiet_NaN();
  void visit(OptionVisitor& visitor);
};

/// Kind "fit_modes": a table of modes from strikes whose force was measured, or from response
/// functions.
struct FitModesOptions {
  static constexpr std::string_view kForStructures =
      "fit_modes makes a table; one is read by kind: identify_force (table: modes.yaml) and kind: "
      "simulate (structure: {table: modes.yaml})";
  bool has_record = false;
  StructureRecordOptions record;
  std::vector<OtherStrikeOptions> other_strikes;
  bool has_functions = false;
  ResponseFunctionOptions functions;
  double low = 0.0, high = 0.0;
  double contour = std::numeric_limits<double>::quiet_NaN();
  std::int64_t most_modes = 60;
  std::int64_t seed = 0;  ///< nothing is drawn: all tasks of a list have this one
  void visit(OptionVisitor& visitor);

  std::vector<Finding> lint() const;
  std::vector<Finding> lint_records(const std::filesystem::path& folder) const;
  std::vector<PlanLine> plan() const;
  std::optional<PlannedSimulations> planned_simulations() const { return std::nullopt; }
  std::vector<FileRead> files_read() const;
  StudyResult run(const StudyContext& context) const;

  /// The record, then the other strikes.
  std::vector<StructureRecordOptions> strikes() const;
  /// What strikes or sessions are called.
  std::vector<std::string> strike_names() const;
};

/// How far the structure may have changed since its table was made.
struct StructureChangeOptions : StructureChange {
  void visit(OptionVisitor& visitor);
};

/// Kind "identify_force": the force at a structure's contact from K responses and a table.
struct IdentifyForceOptions {
  static constexpr std::string_view kForStructures =
      "state table: modes.yaml and record: {file: ..., responses: [{channel: ...}, ...]}";
  std::string table;
  std::vector<std::string> other_places;    ///< tables of the same structure driven elsewhere
  std::vector<std::string> other_contacts;  ///< the same, where forces act as well
  StructureRecordOptions record;
  std::string shape = "auto";
  bool non_negative = false;
  double window = std::numeric_limits<double>::quiet_NaN();
  double contour = std::numeric_limits<double>::quiet_NaN();
  bool unchanged = false;
  bool refines = false;
  StructureChangeOptions change;
  std::int64_t draws = 12;
  std::int64_t seed = 1;
  bool write_sound = false;
  void visit(OptionVisitor& visitor);

  std::vector<Finding> lint() const;
  std::vector<Finding> lint_records(const std::filesystem::path& folder) const;
  std::vector<PlanLine> plan() const;
  std::optional<PlannedSimulations> planned_simulations() const { return std::nullopt; }
  std::vector<FileRead> files_read() const;
  StudyResult run(const StudyContext& context) const { return found(context, false); }

 protected:
  /// All keys but that of the draws.
  void visit_keys(OptionVisitor& visitor);
  /// modes_first: what was asked for are the modes, not the force.
  StudyResult found(const StudyContext& context, bool modes_first) const;

 private:
  /// The table first, then those of the other places or contacts.
  std::vector<std::string> tables() const;
  /// Which of several places it is; nothing of one.
  std::optional<ContactPlaces> weighed(const std::vector<StructureTable>& places,
                                       const LoadedStructureRecord& loaded) const;
  StructureForceOptions force_options(const LoadedStructureRecord& loaded) const;
  void lint_tables(const std::filesystem::path& folder, std::vector<SensorKind>& kinds,
                   std::vector<Finding>& findings) const;
};

/// What the channels of a structure's sensors state wrongly; path: of the list.
std::vector<Finding> lint_responses(const std::string& path, std::size_t sensors);

}  // namespace modcal
