// Reads and writes records: CSV files, WAV and the other audio files of libsndfile.
#pragma once

#include <span>

#include "libsim/records/recording.hpp"

namespace modcal {

struct ReadOptions {
  /// Channels to keep, in this order, by name or by number from 1 (all columns of a CSV file
  /// counted); empty: all but time.
  std::vector<std::string> channels = {};
  /// [Hz]; overrides what the file says (a difference becomes a warning). NaN: from the file.
  double sample_rate = std::numeric_limits<double>::quiet_NaN();
  /// Columns of a CSV file may be instants; false: every column is a channel.
  bool has_time = true;
  /// Keep going over errors in the samples: they are listed in Recording::problems, and what is no
  /// number is NaN. Otherwise they throw.
  bool survey = false;
  /// Keep no samples: Recording::stated_frames counts them. Of formats without a header the first
  /// rows are read, which tell about how many there are.
  bool headers_only = false;
  /// Polled while samples are read; Interrupted is thrown where it is requested.
  StopToken stop = {};
  /// A file whose reading needs more is refused before [B].
  double memory = std::numeric_limits<double>::infinity();
};

/// Reads a CSV record: an optional preamble of comments (# …), one row of headings `name [unit]`,
/// rows of decimal numbers. The sample rate comes from the options, from a comment
/// `# sample_rate: 51200 Hz`, or from the time column of the first channel (TimeColumns); that
/// column must be uniform (examine_time_axis), and those of other channels must tell the same
/// instants. Throws InvalidInput with file:line:column, value and remedy.
Recording read_csv(const std::filesystem::path& path, const ReadOptions& options = {});

/// What a file says beside the samples that are written.
struct RecordNotes {
  std::string provenance = {};
  double start = 0.0;  ///< of the first sample [s]
};

struct CsvWriteOptions {
  /// A first column t [s] = start + i/f_s.
  bool time_column = true;
  /// Where the samples come from; each line becomes a comment.
  std::vector<std::string> provenance = {};
  double start = 0.0;  ///< of the first sample [s]
};

/// Writes signals of one rate and length: the headings `quantity [unit]`, comments with the sample
/// rate and the provenance, one row per sample. Numbers are the shortest decimals that read back
/// to the same double, so read_csv returns the same bits. An existing file is replaced only when
/// the new one is complete. Throws InvalidInput for no signals, different rates or lengths, equal
/// names, headings that would be read as instants or as other ones, samples that are not finite,
/// and where the file cannot be written.
void write_csv(const std::filesystem::path& path, std::span<const Signal> signals,
               const CsvWriteOptions& options = {});

/// Reads a WAV record (also RF64, WAVEX, W64 and what else libsndfile opens): any channel count;
/// samples of 8, 16, 24, 32 bits are divided by their full scale 2^(bits−1), float and double are
/// taken as they are. Names, units and full scales come from the file's comment where write_wav
/// left them; else the names are "1", "2", … and the full scale is NaN. Throws InvalidInput with
/// file, channel, sample and remedy.
Recording read_wav(const std::filesystem::path& path, const ReadOptions& options = {});

/// A recording in memory that is read by its name, in the place of a file in any folder, for as
/// long as this lives.
class GivenRecording {
 public:
  /// Throws InvalidInput for a name that another one has and for samples that no file may have.
  GivenRecording(std::string name, Recording recording);
  ~GivenRecording();
  GivenRecording(const GivenRecording&) = delete;
  GivenRecording& operator=(const GivenRecording&) = delete;

 private:
  std::string name_;
};

/// A given recording, or a record of the named format (libsim/records/formats.hpp) or, for "auto",
/// of the one that its extension tells. Throws InvalidInput for another one.
Recording read_record(const std::filesystem::path& path, const std::string& format,
                      const ReadOptions& options = {});

/// How much a record holds: rows, and the numbers in each.
struct RecordSize {
  double frames = 0.0;
  double channels = 0.0;
  double sample_rate = std::numeric_limits<double>::quiet_NaN();  ///< [Hz], where the file tells it
  /// To read so many of the channels [B]: a vector that grows holds up to twice its samples, and a
  /// signal is a copy of its channel.
  double bytes_to_read(double wanted) const { return 2.0 * sizeof(double) * frames * wanted; }
};

/// Told by its headers, or of a CSV file by its size and its first rows, about; no samples are
/// read. Nothing for a given recording and for what is not there or cannot be read.
std::optional<RecordSize> size_of_record(const std::filesystem::path& path,
                                         const std::string& format);

/// Throws InvalidInput where reading a record, all channels, needs more than `memory` [B].
void require_memory(const std::filesystem::path& path, const std::string& format, double memory);

enum class WavSamples { kFloat, kDouble, kPcm24 };

struct WavWriteOptions {
  WavSamples samples = WavSamples::kFloat;
  /// The signals' unit per full scale 1.0 (> 0): a sample x is stored as x/full_scale. A power of
  /// two with kDouble keeps every bit.
  double full_scale = 1.0;
  /// Where the samples come from; stored in the file's title.
  std::string provenance = {};
};

/// Writes signals of one rate and length, one per channel, with their names, units and full scale
/// in the file's comment (JSON), so that read_wav restores them; RF64 where a WAV file's 32-bit
/// sizes do not suffice. 24-bit samples are rounded to full_scale 2^−23. An existing file is
/// replaced only when the new one is complete. Throws InvalidInput where the rate is no whole
/// number of hertz, where a sample is not finite or, for 24 bits, beyond full scale, and where the
/// file cannot be written.
void write_wav(const std::filesystem::path& path, std::span<const Signal> signals,
               const WavWriteOptions& options = {});

/// Whether a file with this many bytes of samples needs RF64 (EBU Tech 3306) in the place of WAV.
bool needs_rf64(std::uint64_t sample_bytes);

}  // namespace modcal
