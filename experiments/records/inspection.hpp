// What a recorded file holds, for people, for programs, and as the start of an experiment.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "libsim/records/levels.hpp"
#include "libsim/records/recording.hpp"

namespace modcal {

struct InspectionOptions {
  std::string format = "auto";
  double sample_rate = std::numeric_limits<double>::quiet_NaN();  ///< [Hz]; NaN: from the file
  bool headers_only = false;  ///< measure nothing; large files are never measured
  /// A file whose reading needs more is refused before [B].
  double memory = std::numeric_limits<double>::infinity();
};

struct ChannelInspection {
  std::string name;
  std::string kind;  ///< of quantity; empty where the file does not tell
  std::string unit;  ///< of the levels; "full scale" where the file states none for audio samples
  Levels levels;
  Clipping clipping;
  double noise_rms;  ///< white_noise_rms
  /// Why a run would not take the channel for a reaction; samples that are no numbers are listed
  /// with the file's problems.
  std::optional<SampleFault> fault;
};

/// Who is who in a record of a structure: what the sensors read, and the force of a strike.
struct StructureChannels {
  struct Response {
    std::string channel;
    std::string_view kind;  ///< "acceleration"
  };
  std::vector<Response> responses;
  std::string force;  ///< empty: no channel is one
};

/// What a file of functions of frequency holds.
struct FunctionsInspection {
  std::vector<std::string> responses;  ///< names of response functions
  double first, last;                  ///< lines of the first function [Hz]
};

struct InspectionReport {
  std::string file;
  std::string format;
  double sample_rate;  ///< [Hz]; NaN: not known
  std::string rate_source;
  double time_jitter;  ///< [s]; NaN: no time column to check
  std::size_t frames;
  bool measured;  ///< else headers alone were read, and there are no levels
  std::vector<ChannelInspection> channels;
  std::vector<std::string> problems;  ///< what a run would refuse, with file, line and column
  std::size_t problem_count;
  std::vector<std::string> warnings;
  RecordOptions record;  ///< a proposal: the channels by their names or their order
  /// The proposal in its place of a force beside accelerations or velocities, and of motion alone.
  std::optional<StructureChannels> structure = std::nullopt;
  /// Of a file of functions of frequency alone, which the channels are then; frames: its lines.
  std::optional<FunctionsInspection> functions = std::nullopt;
};

/// Reads the file and measures every channel, of a large one the headers alone; errors in its rows
/// are listed, not thrown. Throws InvalidInput where the file cannot be read at all.
InspectionReport inspect(const std::filesystem::path& path, const InspectionOptions& options = {});

/// The channels that may be a string's ends and what is known at its contact: by their names, else
/// by their units and order; of two forces the one beside an end that is named is the other end,
/// with a warning.
RecordOptions proposed_roles(const std::filesystem::path& path, const InspectionOptions& options,
                             const std::vector<ChannelInspection>& channels,
                             std::vector<std::string>& warnings);

/// For a terminal; ends with the stanza.
std::string text(const InspectionReport& report);
/// Numbers that are not known are null.
nlohmann::ordered_json json(const InspectionReport& report);
/// The beginning of an experiment's YAML file: the `record:` section as proposed, and with the
/// numbers left empty that only the user knows (the reader asks for them) the string and the bow of
/// kind invert, or the band of kind fit_modes. Where no force was measured, identify_force's; of a
/// file of response functions fit_modes by these.
std::string stanza(const InspectionReport& report);

}  // namespace modcal
