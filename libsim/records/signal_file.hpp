// What writing signals to any kind of file has in common.
#pragma once

#include <filesystem>
#include <functional>
#include <span>
#include <string_view>

#include "libsim/signal/signal.hpp"

namespace modcal {

/// Throws InvalidInput unless the signals can stand in one file: at least one, of one rate > 0 [Hz]
/// and one length > 0, with different non-empty names and finite samples.
void require_one_record(std::span<const Signal> signals, std::string_view file);

/// Calls write(temporary) and renames the temporary file to `path`; removes it where write throws.
/// An existing file at `path` is never left half written.
void replace_file(const std::filesystem::path& path,
                  const std::function<void(const std::filesystem::path&)>& write);

}  // namespace modcal
