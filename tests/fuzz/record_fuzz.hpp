// A record of one format: strictly, as runs read it, and by `modcal inspect`.
#pragma once

#include <nlohmann/json.hpp>

#include "experiments/records/inspection.hpp"
#include "libsim/records/record_file.hpp"
#include "libsim/records/response_functions.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/leaks_of_libraries.hpp"

namespace modcal::fuzz {

inline void read_as(const std::string& format, std::string_view content) {
  const MemoryFile file(content);
  Recording recording;
  const bool is_good =
      accepted([&] { recording = read_record(file.path(), format, ReadOptions{}); });
  InspectionReport report;
  const bool is_inspected =
      accepted([&] { report = inspect(file.path(), InspectionOptions{.format = format}); });
  if (is_inspected) {
    // Both are made of names that the file chooses; bytes that are no text are replaced.
    constexpr auto kReplace = nlohmann::json::error_handler_t::replace;
    require(!text(report).empty() && !json(report).dump(2, ' ', false, kReplace).empty(),
            "nothing is said of a record");
  }
  for (const FrequencyFunction wanted :
       {FrequencyFunction::kResponse, FrequencyFunction::kCoherence}) {
    ResponseFunctions functions;
    if (!accepted(
            [&] { functions = read_response_functions(file.path(), format, {"1"}, wanted); })) {
      continue;
    }
    require(functions.functions.size() == 1 &&
                functions.functions[0].values.size() == functions.grid.bins,
            "a response function of another number of lines");
  }
  FileFunctions all;
  if (accepted([&] { all = read_functions(file.path(), format); })) {
    for (const FileFunction& function : all.functions) {
      require(function.values.size() == function.hertz.size(), "values without their lines");
    }
  }
  if (!is_good) return;
  require(is_inspected, "a record that a run takes cannot be inspected");
  require(report.frames == recording.frames(), "inspect sees another number of samples");
  for (const RecordedChannel& channel : recording.channels) {
    require(channel.samples.size() == recording.frames(), "channels of different lengths");
  }
}

}  // namespace modcal::fuzz
