// Measured response functions of a structure.
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "experiments/kinds/structure/structure_files.hpp"
#include "libsim/base/turn.hpp"
#include "libsim/base/units.hpp"
#include "libsim/records/formats.hpp"

namespace modcal {
namespace {

// SI per newton for a value as it stands in the file; a unit that is not stated is taken to be SI.
double scale_of(const FunctionChannelOptions& options, const ResponseFunction& function,
                std::string_view unit, std::vector<std::string>& unstated) {
  const double sign = options.turned ? -1.0 : 1.0;
  if (!std::isnan(options.calibration)) return sign * options.calibration;
  const std::string whole = fmt::format("({})/N", unit);
  if (is_unit_of(function.unit, whole)) return sign * to_si(1.0, function.unit, whole);
  double scale = sign * function.full_scale;
  for (const auto& [stated, si] :
       {std::pair(std::string_view(function.unit), unit),
        std::pair(std::string_view(function.per_unit), std::string_view("N"))}) {
    if (stated.empty()) {
      unstated.push_back(fmt::format("{} ({})", function.name, si));
      continue;
    }
    MODCAL_REQUIRE(
        is_unit_of(stated, si),
        "response function {} is in \"{}\" per \"{}\", which is none of what it is said to "
        "be ({} per N): state its kind, or calibration, the {} per N of a value 1",
        function.name, function.unit, function.per_unit, unit, unit);
    const double own = to_si(1.0, stated, si);
    scale *= si == unit ? own : 1.0 / own;
  }
  return scale;
}

// The functions of one file in SI units per newton.
Transfers session_of(const ResponseFunctionOptions& options, const std::filesystem::path& file,
                     LoadedResponseFunctions& loaded, std::vector<std::string>& unstated) {
  std::vector<std::string> channels;
  for (const FunctionChannelOptions& response : options.responses) {
    channels.push_back(response.channel);
  }
  ResponseFunctions read = read_response_functions(file, options.format, channels);
  const bool is_first = loaded.measured.empty();
  FrequencyGrid& grid = loaded.measured.grid;
  if (is_first) grid = read.grid;
  MODCAL_REQUIRE(grid.bins == read.grid.bins &&
                     std::abs(grid.spacing - read.grid.spacing) < 1e-9 * grid.spacing,
                 "{} has lines up to {:g} Hz, {:g} Hz apart, {} up to {:g} Hz, {:g} Hz apart: "
                 "sessions need one grid",
                 file.string(), read.grid.omega(read.grid.bins - 1) / kTurn,
                 read.grid.spacing / kTurn, options.file, grid.omega(grid.bins - 1) / kTurn,
                 grid.spacing / kTurn);
  Transfers session;
  for (std::size_t k = 0; k < read.functions.size(); ++k) {
    ResponseFunction& function = read.functions[k];
    const SensorKind kind = sensor_kind_of(options.responses[k].kind);
    const double scale = scale_of(options.responses[k], function, unit_of(kind), unstated);
    for (Complex& value : function.values) value *= scale;
    session.push_back(std::move(function.values));
    if (!is_first) continue;
    loaded.measured.sensors.push_back(kind);
    loaded.names.push_back(function.name);
  }
  return session;
}

// E|δH|²/|H|² = (1 − γ²)/(n γ²) of every line.
std::vector<double> random_of(const ResponseFunctionOptions& options, std::size_t k,
                              const std::filesystem::path& file, const FrequencyGrid& grid) {
  const std::string& channel = options.responses[k].coherence;
  const ResponseFunctions read =
      read_response_functions(file, options.format, {channel}, FrequencyFunction::kCoherence);
  MODCAL_REQUIRE(read.grid.bins == grid.bins && read.grid.spacing == grid.spacing,
                 "{}: coherence {} has other lines than its response function", file.string(),
                 channel);
  // What a coherence of 0 tells of a line: nothing.
  constexpr double kLeast = 1e-6;
  std::vector<double> random;
  for (const Complex& value : read.functions.front().values) {
    const double told = std::isnan(value.real()) ? 1.0 : value.real();
    MODCAL_REQUIRE(told >= 0.0 && told <= 1.0 + 1e-6,
                   "{}: coherence {} has the value {:g}, which is not between 0 and 1",
                   file.string(), channel, told);
    random.push_back(std::max(0.0, 1.0 - told) / (options.averages * std::max(told, kLeast)));
  }
  return random;
}

}  // namespace

void FunctionChannelOptions::visit(OptionVisitor& visitor) {
  StructureChannelOptions::visit(visitor);
  visitor("coherence", "channel of its coherence; none: not told", coherence);
}

void ResponseFunctionOptions::visit(OptionVisitor& visitor) {
  visitor("file",
          "universal file (UFF 58), CSV, MAT, NumPy or HDF5 file, relative to the folder of the "
          "file that names it",
          {.required = true}, file);
  visitor("sessions",
          "files of the same functions, measured again: their scatter is the model's error",
          sessions);
  visitor("format", "format of the file; auto: by its extension",
          {.choices = record_format_choices()}, format);
  visitor("responses", "response functions of the sensors, all of one contact", {.required = true},
          responses);
  visitor("averages", "strikes or blocks that every function is the mean of; a coherence needs it",
          {.range = Range::closed(1.0, 1e6), .word = "none"}, averages);
  visit_exponential_window(visitor, window);
}

std::vector<std::string> ResponseFunctionOptions::files() const {
  std::vector<std::string> all = {file};
  all.insert(all.end(), sessions.begin(), sessions.end());
  return all;
}

LoadedResponseFunctions load_response_functions(const ResponseFunctionOptions& options,
                                                const std::filesystem::path& folder) {
  LoadedResponseFunctions loaded;
  std::vector<std::string> unstated;
  for (const std::string& file : options.files()) {
    loaded.measured.sessions.push_back(session_of(options, folder / file, loaded, unstated));
  }
  FrequencyGrid& grid = loaded.measured.grid;
  if (std::ranges::any_of(options.responses, [](const FunctionChannelOptions& response) {
        return !response.coherence.empty();
      })) {
    MODCAL_REQUIRE(!std::isnan(options.averages),
                   "{}: what a coherence says of an error depends on how many strikes or blocks "
                   "were averaged: state averages",
                   options.file);
    for (std::size_t k = 0; k < options.responses.size(); ++k) {
      loaded.measured.random.push_back(options.responses[k].coherence.empty()
                                           ? std::vector<double>(grid.bins, 0.0)
                                           : random_of(options, k, folder / options.file, grid));
    }
  }
  // Force and responses weighted by exp(−t/τ) have H on that contour.
  grid.sigma = window_decay(options.window);
  std::ranges::sort(unstated);
  unstated.erase(std::unique(unstated.begin(), unstated.end()), unstated.end());
  if (!unstated.empty()) {
    loaded.warnings.push_back(fmt::format(
        "no unit is stated of {}: taken to be SI; state calibration where it is another one",
        fmt::join(unstated, ", ")));
  }
  return loaded;
}

}  // namespace modcal
