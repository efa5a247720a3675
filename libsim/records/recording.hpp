// A file of sampled channels as it was recorded: numbers in the units of the file.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace modcal {

struct RecordedChannel {
  std::string name;
  /// Unit of samples × full_scale as the file states it ("mN", "V"); empty where it states none.
  std::string unit;
  /// `unit` per recorded 1.0. 1 for CSV; for audio files only where the file states it, else NaN.
  double full_scale = 1.0;
  std::vector<double> samples;
};

struct Recording {
  std::string format;  ///< for people: "CSV, separated by ','", "WAV, 24 bit integers"
  double sample_rate = std::numeric_limits<double>::quiet_NaN();  ///< [Hz], NaN: not known
  std::string rate_source;                                        ///< where the rate was found
  double time_jitter = std::numeric_limits<double>::quiet_NaN();  ///< largest deviation [s]
  std::vector<RecordedChannel> channels;
  /// What a strict reading refuses, with file, line and column; the first kMaxProblems of them.
  std::vector<std::string> problems;
  std::size_t problem_count = 0;
  /// What a user should know although the record can be used.
  std::vector<std::string> warnings;

  static constexpr std::size_t kMaxProblems = 10;

  std::size_t frames() const { return channels.empty() ? 0 : channels.front().samples.size(); }
  void add_problem(std::string text);
  /// Throws InvalidInput with all problems, one a line, where there are any.
  void refuse_problems() const;
};

/// Indices into `names` of the wanted channels, in their order: each by its name or, where no name
/// equals the text, by its number 1 … size. Throws InvalidInput for a channel that is not there
/// (with the nearest name) or is wanted twice; `where` opens the message.
std::vector<std::size_t> find_channels(const std::vector<std::string>& names,
                                       const std::vector<std::string>& wanted,
                                       std::string_view where);

}  // namespace modcal
