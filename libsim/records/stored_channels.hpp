// Channels of a file that keeps each by itself: chosen first, read afterwards.
#pragma once

#include <functional>
#include <memory>

#include "libsim/records/frequency_lines.hpp"
#include "libsim/records/record_file.hpp"
#include "libsim/records/response_functions.hpp"

namespace modcal {

/// A channel as its header describes it.
struct StoredChannel {
  RecordedChannel head;  ///< without samples
  std::size_t size = 0;
  double sample_rate = std::numeric_limits<double>::quiet_NaN();  ///< [Hz]; NaN: not known
  std::string rate_source;
  std::string rate_doubt = {};     ///< why it may be another one, or is not known; empty: no doubt
  double rate_rounding = 0.0;      ///< of the rate, relative, by the digits it was printed with
  bool is_rate_stated = false;     ///< beside the instants, which must agree with it
  std::string contradiction = {};  ///< what else in the file tells another rate; empty: nothing
  double start = std::numeric_limits<double>::quiet_NaN();  ///< of the first sample [s]; NaN: none
  /// About one over the rate [s], where the rate is not known yet; NaN: nor is this.
  double period = std::numeric_limits<double>::quiet_NaN();
  /// What it is where it is no function of time ("frequency response, 801 lines"); else empty.
  std::string other_than_time = {};
  std::string place = {};  ///< "data.uff: dataset 58 at line 12"
  /// Reads the samples; may be empty where only headers are wanted.
  std::function<std::vector<double>()> read = {};
  /// Reads the instants [s] where the file states them one by one; else empty. Then they tell the
  /// sample rate.
  std::function<std::vector<double>()> read_times = {};
  std::string times_name = {};   ///< the same for all channels that have the same instants
  double time_resolution = 0.0;  ///< of the largest instant as it was stored, relative
  /// Of a function of frequency: what it is, its lines where they are even and the first one lies a
  /// whole number of steps from 0, its lines one by one [Hz], the unit of its force, and its
  /// values; null for anything else.
  FrequencyFunction what = FrequencyFunction::kResponse;
  EvenLines lines = {};
  std::string per_unit = {};
  std::function<std::vector<double>()> read_lines = {};
  std::function<std::vector<Complex>()> read_response = {};
  MeasuredPlaces places = {};
};

/// The wanted channels as one record. Unasked those in time that have the first one's rate, length
/// and beginning are taken; the others are warnings. Throws WrongChannel for a wanted one that is
/// not there, is no function of time or differs from the first in rate, length or beginning, and
/// InvalidInput for samples that are not finite and a rate that is not known or contradicted
/// (listed by a survey).
Recording assemble(std::string format, std::vector<StoredChannel> stored,
                   const ReadOptions& options, const std::string& file);

/// Their names, those without one by their number, equal ones told apart: "h1", "h1 (2)".
std::vector<std::string> different_names(const std::vector<StoredChannel>& stored);

/// How a channel lies in time, or what else it is.
std::string grid_text(const StoredChannel& channel);

/// A function at these frequencies [Hz], which must increase. They are even where each is so to a
/// hundredth of their distance and the first one lies a whole number of it from 0.
void set_lines(const std::shared_ptr<const std::vector<double>>& hertz, StoredChannel& channel,
               std::function<std::vector<Complex>()> read);

/// The same at the first `channel.size` multiples of a distance [Hz] from 0 on.
void set_multiples(double distance, StoredChannel& channel,
                   std::function<std::vector<Complex>()> read);

/// The wanted response functions, as read_response_functions() says.
ResponseFunctions assemble_responses(const std::vector<StoredChannel>& stored,
                                     const std::vector<std::string>& channels,
                                     FrequencyFunction wanted, const std::string& file);

/// All functions of frequency, as read_functions() says.
FileFunctions assemble_functions(const std::vector<StoredChannel>& stored, const std::string& file);
}  // namespace modcal
