// What writing signals to any kind of file has in common.
#pragma once

#include <span>

#include "libsim/records/response_functions.hpp"

namespace modcal {

/// Throws InvalidInput unless the signals can stand in one file: at least one, of one rate > 0 [Hz]
/// and one length > 0, with different non-empty names and finite samples.
void require_one_record(std::span<const Signal> signals, std::string_view file);

/// Throws InvalidInput unless the functions can stand in a file: at least one, with different
/// non-empty names, two lines [Hz] or more that increase, and finite values.
void require_functions(std::span<const FileFunction> functions, std::string_view file);

/// Calls write(temporary) and renames the temporary file to `path`; removes it where write throws.
/// An existing file at `path` is never left half written.
void replace_file(const std::filesystem::path& path,
                  const std::function<void(const std::filesystem::path&)>& write);

// Names, units and full scales of the channels, kept in the comment of an audio file.

/// Longest comment that libsndfile 1.2 reads back from a WAV file [bytes].
/// Fixed by: a limit of that library.
inline constexpr std::size_t kLongestWavComment = 2000;

/// {"modcal":{"full_scale":10,"channels":[["R1","N"],["R2","N"]]}}: short, because of the limit.
std::string wav_comment(std::span<const Signal> signals, double full_scale);

/// The channels (without samples) of such a comment; for any other comment, or one for another
/// number of channels, they are named "1" … "count", with no unit and full scale NaN.
std::vector<RecordedChannel> channels_of_comment(std::string_view comment, std::size_t count);

}  // namespace modcal
