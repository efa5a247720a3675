#include "experiments/kinds/structure/table_functions.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

double hertz(const FrequencyGrid& grid, std::size_t line) {
  return grid.omega(line) / (2.0 * std::numbers::pi);
}

// From the first line on every one is needed: a contour takes them all.
void require_lines(const std::vector<Complex>& values, const StructureTable& table,
                   std::string_view file, std::string_view name) {
  const FrequencyGrid& grid = table.measured.grid;
  const auto is_known = [](const Complex& value) {
    return std::isfinite(value.real()) && std::isfinite(value.imag());
  };
  const auto first = std::ranges::find_if(values, is_known);
  const auto hole = std::find_if_not(first, values.end(), is_known);
  const auto at = [&](auto line) {
    return hertz(grid, static_cast<std::size_t>(line - values.begin()));
  };
  MODCAL_REQUIRE(first != values.end() && at(first) <= table.low,
                 "{}: response function {} has no line as low as low = {:g} Hz", file, name,
                 table.low);
  MODCAL_REQUIRE(hole == values.end(), "{}: response function {} is not finite at {:g} Hz", file,
                 name, at(hole));
}

void warn_of_coarse_lines(StructureTable& table) {
  const double left = table.measured.rings_on(), spacing = hertz(table.measured.grid, 1);
  // An amplitude of 3 % is what an error bar of 5 % may leave out.
  if (left <= 0.03) return;
  table.warnings.push_back(
      fmt::format("lines {:.3g} Hz apart are too coarse for what rings so long: {:.0f} % of the "
                  "impulse response "
                  "is left after {:.3g} s; measure longer blocks, or state the exponential window "
                  "that was used",
                  spacing, 100.0 * left, 1.0 / spacing));
}

}  // namespace

double scatter_untold(const std::vector<std::string>& sessions) {
  return sessions.empty() ? 0.05 : 0.0;
}

void take_functions(const ResponseFunctionOptions& options, const std::filesystem::path& file,
                    StructureTable& table) {
  const std::string path = file.string();
  LoadedResponseFunctions loaded = load_response_functions(options, file.parent_path());
  MeasuredFunctions& measured = table.measured = std::move(loaded.measured);
  table.warnings = std::move(loaded.warnings);
  const std::size_t count = measured.sensors.size();
  if (table.model.sensors.empty()) {
    table.model.sensors = measured.sensors;
    table.scatters.assign(count, {.modal = scatter_untold(options.sessions)});
  }
  table.names = std::move(loaded.names);
  MODCAL_REQUIRE(table.model.sensors.size() == count,
                 "{}: {} sensors for {} functions: leave sensors out, or state one for each", path,
                 table.model.sensors.size(), count);
  const double last = hertz(measured.grid, measured.grid.bins - 1);
  MODCAL_REQUIRE(table.high <= last,
                 "{}: high = {:g} Hz lies above the last line of {}, {:g} Hz: state less", path,
                 table.high, options.file, last);
  for (std::size_t k = 0; k < count; ++k) {
    MODCAL_REQUIRE(table.model.sensors[k] == measured.sensors[k],
                   "{}: sensors.{} is {}, its function {}", path, k,
                   name_of(table.model.sensors[k]), name_of(measured.sensors[k]));
    const double scatter = table.scatters[k].modal;
    MODCAL_REQUIRE(scatter > 0.0 || !options.sessions.empty(),
                   "{}: functions of one session do not tell how far they may be off: state "
                   "sensors.{}.scatter above 0, or sessions",
                   path, k);
    measured.scatter.push_back(scatter);
    for (const Transfers& session : measured.sessions) {
      require_lines(session[k], table, path, table.names[k]);
    }
  }
  warn_of_coarse_lines(table);
}

}  // namespace modcal
