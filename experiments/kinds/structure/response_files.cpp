// Measured response functions of a structure.
#include <fmt/ranges.h>

#include <cmath>

#include "experiments/kinds/structure/structure_files.hpp"
#include "libsim/base/units.hpp"
#include "libsim/records/formats.hpp"

namespace modcal {
namespace {

// SI per newton for a value as it stands in the file; a unit that is not stated is taken to be SI.
double scale_of(const StructureChannelOptions& options, const ResponseFunction& function,
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

}  // namespace

void ResponseFunctionOptions::visit(OptionVisitor& visitor) {
  visitor("file", "universal file (UFF 58), relative to the folder of the experiment's file",
          {.required = true}, file);
  visitor("format", "format of the file; auto: by its extension",
          {.choices = record_format_choices()}, format);
  visitor("responses", "response functions of the sensors, all of one contact", {.required = true},
          responses);
  visit_exponential_window(visitor, window);
}

LoadedResponseFunctions load_response_functions(const ResponseFunctionOptions& options,
                                                const std::filesystem::path& folder) {
  std::vector<std::string> channels;
  for (const StructureChannelOptions& response : options.responses) {
    channels.push_back(response.channel);
  }
  ResponseFunctions read = read_response_functions(folder / options.file, options.format, channels);
  LoadedResponseFunctions loaded{.grid = read.grid};
  // Force and responses weighted by exp(−t/τ) have H on that contour.
  loaded.grid.sigma = window_decay(options.window);
  std::vector<std::string> unstated;
  for (std::size_t k = 0; k < read.functions.size(); ++k) {
    ResponseFunction& function = read.functions[k];
    const SensorKind kind = sensor_kind_of(options.responses[k].kind);
    const double scale = scale_of(options.responses[k], function, unit_of(kind), unstated);
    for (Complex& value : function.values) value *= scale;
    loaded.kinds.push_back(kind);
    loaded.names.push_back(function.name);
    loaded.values.push_back(std::move(function.values));
  }
  if (!unstated.empty()) {
    loaded.warnings.push_back(fmt::format(
        "no unit is stated of {}: taken to be SI; state calibration where it is another one",
        fmt::join(unstated, ", ")));
  }
  return loaded;
}

}  // namespace modcal
