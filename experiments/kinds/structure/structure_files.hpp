// Records of any structure and the file of its modes, as experiments state them.
#pragma once

#include <filesystem>

#include "libinverse/structure/structure_table.hpp"
#include "libsim/base/options.hpp"
#include "libsim/base/task_loop.hpp"

namespace modcal {

/// One channel of a recorded file.
struct StructureChannelOptions {
  std::string channel;
  std::string kind = "acceleration";  ///< of a response
  double calibration = std::numeric_limits<double>::quiet_NaN();
  bool turned = false;
  void visit(OptionVisitor& visitor);
};

/// The force of a strike.
struct StructureForceChannel : StructureChannelOptions {
  void visit(OptionVisitor& visitor);
};

/// The `record:` section of a structure: responses and, where it was measured, the force.
struct StructureRecordOptions {
  std::string file;
  std::string format = "auto";
  double sample_rate = std::numeric_limits<double>::quiet_NaN();
  bool has_force = false;
  StructureForceChannel force;
  std::vector<StructureChannelOptions> responses;
  double start = 0.0;
  double stop = std::numeric_limits<double>::quiet_NaN();
  double rest = std::numeric_limits<double>::quiet_NaN();
  double window = std::numeric_limits<double>::quiet_NaN();  ///< τ [s]; NaN: none
  void visit(OptionVisitor& visitor);
};

/// One response function of a file.
struct FunctionChannelOptions : StructureChannelOptions {
  std::string coherence;  ///< channel of it; empty: not told
  void visit(OptionVisitor& visitor);
};

/// The `functions:` section: measured response functions in the place of a record or of modes.
struct ResponseFunctionOptions {
  std::string file;
  std::vector<std::string> sessions;  ///< further files, of the same functions
  std::string format = "auto";
  std::vector<FunctionChannelOptions> responses;
  double averages = std::numeric_limits<double>::quiet_NaN();
  double window = std::numeric_limits<double>::quiet_NaN();  ///< τ [s]; NaN: none
  void visit(OptionVisitor& visitor);
  std::vector<std::string> files() const;
};

/// exp(−t/τ), by which an instrument has weighted all channels of a strike. τ [s]; NaN: none.
void visit_exponential_window(OptionVisitor& visitor, double& window);
/// 1/τ [1/s].
double window_decay(double window);

/// In SI units per newton.
struct LoadedResponseFunctions {
  MeasuredFunctions measured;  ///< without scatter
  std::vector<std::string> names;
  std::vector<std::string> warnings;
};

/// Throws InvalidInput where a file or a function cannot be had, or has another unit than its kind,
/// and for a coherence that is none or whose averages are not stated.
LoadedResponseFunctions load_response_functions(const ResponseFunctionOptions& options,
                                                const std::filesystem::path& folder);

/// A record in SI units, the mean of its quiet beginning taken out.
struct LoadedStructureRecord {
  StructureRecord record;
  std::vector<SensorKind> kinds;
  std::vector<std::string> names;
  double rest = 0.0;   ///< of which the mean was taken [s]
  double quiet = 0.0;  ///< so much of it has no channel that leaves its level [s]
  std::vector<std::string> warnings;
};

/// Throws InvalidInput where the file or a channel cannot be had, or has another unit than its
/// kind.
LoadedStructureRecord load_structure_record(const StructureRecordOptions& options,
                                            const std::filesystem::path& folder,
                                            const StopToken& stop = {});

/// Throws InvalidInput where the force of a strike begins with a tenth of its largest or more, or
/// is clipped: modes would have constants that are too large by the part of the blow that is
/// missing.
void require_whole_blow(const StructureRecord& record, const std::string& file);

/// Modes and sensors as YAML that reads back to the same values.
std::string table_text(const StructureTable& table);
/// Throws InvalidInput with all mistakes of the file, each at its place.
StructureTable read_table(const std::filesystem::path& path);
/// Files that the table names for its modes; none where it cannot be read.
std::vector<std::filesystem::path> files_named_by_table(const std::filesystem::path& path);

/// What sensors may read, by name.
std::vector<std::string_view> sensor_kind_names();
SensorKind sensor_kind_of(std::string_view name);
/// "acceleration" and its unit.
std::string_view name_of(SensorKind kind);
std::string_view unit_of(SensorKind kind);

}  // namespace modcal
