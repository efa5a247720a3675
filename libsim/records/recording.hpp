// A file of sampled channels as it was recorded: numbers in the units of the file.
#pragma once

#include <filesystem>
#include <optional>

#include "libsim/base/error.hpp"
#include "libsim/base/options.hpp"
#include "libsim/base/task_loop.hpp"
#include "libsim/signal/signal.hpp"

namespace modcal {

struct RecordedChannel {
  std::string name;
  /// Unit of samples × full_scale as the file states it ("mN", "V"); empty where it states none.
  std::string unit;
  /// `unit` per recorded 1.0. 1 for CSV; for audio files only where the file states it, else NaN.
  double full_scale = 1.0;
  std::vector<double> samples;
  /// What the file says it measures ("force", "acceleration"); empty where it does not.
  std::string kind = {};
};

/// Line of every sample of a text file; comments and blank lines between rows are the exception.
class SampleLines {
 public:
  void add(std::size_t sample, std::size_t line);
  /// Line of a sample that was added.
  std::size_t line(std::size_t sample) const;
  bool empty() const { return starts_.empty(); }

 private:
  std::vector<std::pair<std::size_t, std::size_t>> starts_;
};

struct Recording {
  std::string format;  ///< for people: "CSV, separated by ','", "WAV, 24 bit integers"
  double sample_rate = std::numeric_limits<double>::quiet_NaN();  ///< [Hz], NaN: not known
  std::string rate_source;                                        ///< where the rate was found
  double start = 0.0;                                             ///< of the first sample [s]
  double time_jitter = std::numeric_limits<double>::quiet_NaN();  ///< largest deviation [s]
  std::vector<RecordedChannel> channels;
  /// What a strict reading refuses, with file, line and column; the first kMaxProblems of them.
  std::vector<std::string> problems;
  std::size_t problem_count = 0;
  /// What a user should know although the record can be used.
  std::vector<std::string> warnings;
  /// Those of the warnings that tell of another sample rate than the one stated by more than 0.05
  /// %, or of gaps in time: one of both is wrong.
  std::vector<std::string> contradictions;
  SampleLines lines;              ///< empty but for CSV files
  std::size_t stated_frames = 0;  ///< as the header says, where only headers were read

  /// Fixed by: length of a message that is still read.
  static constexpr std::size_t kMaxProblems = 10;

  std::size_t frames() const {
    return channels.empty() ? 0 : std::max(stated_frames, channels.front().samples.size());
  }
  void add_problem(std::string text);
  /// Every sample that is not finite is a problem.
  void check_finite(std::string_view file);
  /// A warning that is a contradiction.
  void contradict(std::string text);
  /// What is wrong with instants: a problem, unless the rate is stated; then a contradiction where
  /// some are missing (`breaks`), else a warning.
  void tell_of_instants(std::string text, bool breaks, bool is_rate_stated);
  /// Takes the rate stated by the user in the place of that of the file (NaN: it tells none). More
  /// than `rounding` (relative) between them is a warning, more than 0.05 %, which no calibration
  /// of a clock corrects, a contradiction.
  void compare_rate(double stated, double rounding, std::string_view file);
  /// Throws InvalidInput with all problems, one a line, where there are any.
  void refuse_problems() const;
};

/// Behind the name of a file without a header of which the first rows alone were read.
inline constexpr std::string_view kEstimatedLength =
    ": the number of samples is estimated by the size of the file";

/// A channel that cannot be had.
class WrongChannel : public InvalidInput {
 public:
  WrongChannel(std::size_t place, const std::string& text) : InvalidInput(text), place_(place) {}
  std::size_t place() const { return place_; }  ///< among those wanted

 private:
  std::size_t place_;
};

/// Indices into `names` of the wanted channels, in their order: each by its name or, where no name
/// equals the text, by its number 1 … size. Throws WrongChannel for a channel that is not there
/// (with the nearest name) or is wanted twice; `where` opens the message.
std::vector<std::size_t> find_channels(const std::vector<std::string>& names,
                                       const std::vector<std::string>& wanted,
                                       std::string_view where);

// The `record:` section of an experiment: which channels of which file are what.

/// One channel of a recorded file.
struct RecordedChannelOptions {
  std::string channel;
  double calibration =
      std::numeric_limits<double>::quiet_NaN();  ///< [unit] per recorded 1; NaN: file
  bool turned = false;                           ///< the sensor reads with the other sign
  double delay = 0.0;                            ///< [s]
  std::string_view unit = "N";
  void visit(OptionVisitor& visitor);
};

/// A recorded experiment: the reactions at one or both ends and, where they were measured, force
/// and motion at the contact.
struct RecordOptions {
  std::string file;
  std::string format = "auto";
  double sample_rate = std::numeric_limits<double>::quiet_NaN();  ///< [Hz]; NaN: from the file
  bool has_left = false;
  bool has_right = false;
  bool has_reference = false;
  bool has_reference_velocity = false;
  bool has_reference_displacement = false;
  RecordedChannelOptions left;                                 ///< R1, at x = 0
  RecordedChannelOptions right;                                ///< R2, at x = L
  RecordedChannelOptions reference;                            ///< f_c, used for scoring only
  RecordedChannelOptions reference_velocity{.unit = "m/s"};    ///< v, for the same
  RecordedChannelOptions reference_displacement{.unit = "m"};  ///< y
  double start = 0.0;                                          ///< [s] after the first sample
  double stop = std::numeric_limits<double>::quiet_NaN();      ///< [s]; NaN: the end
  void visit(OptionVisitor& visitor);
};

/// The `bow:` section of an experiment on a record: where the force acts.
struct ContactOptions {
  double position = std::numeric_limits<double>::quiet_NaN();  ///< x_c [m]
  void visit(OptionVisitor& visitor);
};

// Recorded signals, ready for inversion and calibration.

/// In SI units, of one sample rate [Hz] and one length; at least one reaction.
struct RecordedSignals {
  double sample_rate = 0.0;
  std::optional<Signal> left;                    ///< R1 at x = 0
  std::optional<Signal> right;                   ///< R2 at x = L
  std::optional<Signal> reference;               ///< f_c at the contact
  std::optional<Signal> reference_velocity;      ///< v
  std::optional<Signal> reference_displacement;  ///< y
  std::vector<std::string> warnings;

  std::size_t size() const { return left ? left->size() : right->size(); }
};

/// What one key of the section `record` states and the file does not bear.
class WrongRecordKey : public InvalidInput {
 public:
  WrongRecordKey(std::string key, const std::string& text, std::string place = {})
      : InvalidInput(text, std::move(place)), key_(std::move(key)) {}
  const std::string& key() const { return key_; }  ///< below `record`: "left.channel"

 private:
  std::string key_;
};

/// Throws InvalidInput, with the place, for samples [first, last) of a channel that no sensor of a
/// vibration has read (find_fault()).
void require_vibration(const Recording& recording, const RecordedChannel& channel,
                       std::size_t first, std::size_t last, const std::string& file);

/// Reads the chosen channels of the file (relative to `folder`), converts them to SI units, shifts
/// them by their delays and crops them. Throws WrongRecordKey for a channel that is not there or
/// used twice or has neither a unit of its kind nor a calibration, reactions whose samples tell
/// against them (find_fault()), a delay beyond the record, a window outside of it and a stated
/// sample rate that the file contradicts, and InvalidInput for a file that cannot be used.
/// Throws Interrupted where `stop` was requested.
RecordedSignals load_record(const RecordOptions& options, const std::filesystem::path& folder,
                            const StopToken& stop = {});

}  // namespace modcal
