// Response functions in the columns of a CSV file.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "libsim/base/error.hpp"
#include "libsim/base/units.hpp"
#include "libsim/base/words.hpp"
#include "libsim/records/stored_channels.hpp"

namespace modcal {
namespace {

constexpr std::string_view kReal = " real", kImaginary = " imaginary", kPhase = " phase";

const RecordedChannel* find(const Recording& columns, const std::string& name) {
  const auto at = std::ranges::find(columns.channels, name, &RecordedChannel::name);
  return at == columns.channels.end() ? nullptr : &*at;
}

std::vector<double> hertz_of(const RecordedChannel& frequency, const std::string& file) {
  MODCAL_REQUIRE(frequency.unit.empty() || is_unit_of(frequency.unit, "Hz"),
                 "{}: the column {} is in \"{}\"; state frequencies in Hz", file, frequency.name,
                 frequency.unit);
  std::vector<double> hertz = frequency.samples;
  if (!frequency.unit.empty()) {
    for (double& line : hertz) line = to_si(line, frequency.unit, "Hz");
  }
  return hertz;
}

// Radians for one in the column; NaN: its unit is not known.
double radians(const std::string& unit) {
  if (unit == "rad") return 1.0;
  const bool is_degree = unit == "deg" || unit == "degree" || unit == "degrees" || unit == "°";
  return is_degree ? std::numbers::pi / 180.0 : std::numeric_limits<double>::quiet_NaN();
}

StoredChannel function_of(const Recording& columns, const RecordedChannel& column,
                          const std::vector<double>& hertz, const std::string& file) {
  StoredChannel function;
  function.head.name = column.name;
  function.head.unit = column.unit;
  function.size = hertz.size();
  if (column.name.ends_with(kReal)) {
    function.head.name.resize(column.name.size() - kReal.size());
  }
  const std::string& name = function.head.name;
  const RecordedChannel* const imaginary = find(columns, name + std::string(kImaginary));
  const RecordedChannel* const phase = find(columns, name + std::string(kPhase));
  function.is_coherence = imaginary == nullptr && phase == nullptr;
  MODCAL_REQUIRE(imaginary == nullptr || phase == nullptr,
                 "{}: {} has an imaginary part and a phase; leave one column out", file, name);
  MODCAL_REQUIRE(imaginary != nullptr || name == column.name,
                 "{}: {} has a real part and no column \"{} imaginary\"", file, name, name);
  MODCAL_REQUIRE(column.unit.find("dB") == std::string::npos,
                 "{}: {} is in \"{}\"; write magnitudes, not levels", file, name, column.unit);
  MODCAL_REQUIRE(imaginary == nullptr || imaginary->unit.empty() || imaginary->unit == column.unit,
                 "{}: {} is in \"{}\", its imaginary part in \"{}\"", file, name, column.unit,
                 imaginary->unit);
  MODCAL_REQUIRE(imaginary != nullptr || phase == nullptr || !std::isnan(radians(phase->unit)),
                 "{}: the column {} is in \"{}\"; state its unit, [deg] or [rad]", file,
                 phase->name, phase->unit);
  std::vector<Complex> values(hertz.size());
  for (std::size_t m = 0; m < values.size(); ++m) {
    const double real = column.samples[m];
    values[m] = imaginary != nullptr ? Complex(real, imaginary->samples[m])
                : phase != nullptr
                    ? real * std::polar(1.0, phase->samples[m] * radians(phase->unit))
                    : Complex(real);
  }
  set_lines(hertz, function, [values] { return values; });
  return function;
}

}  // namespace

ResponseFunctions read_csv_responses(const std::filesystem::path& path,
                                     const std::vector<std::string>& channels,
                                     FrequencyFunction wanted) {
  // Rows are no samples in time: any rate will do.
  const Recording columns = read_csv(path, {.sample_rate = 1.0, .has_time = false});
  const auto is_frequency = [](const RecordedChannel& column) {
    const std::string name = lower_case(column.name);
    return name == "frequency" || name == "freq" || name == "f";
  };
  const auto frequency = std::ranges::find_if(columns.channels, is_frequency);
  MODCAL_REQUIRE(frequency != columns.channels.end(),
                 "{}: response functions need a column frequency [Hz]; there are {}", path.string(),
                 columns.channels.size());
  const std::vector<double> hertz = hertz_of(*frequency, path.string());
  std::vector<StoredChannel> functions;
  for (const RecordedChannel& column : columns.channels) {
    const bool is_part = column.name.ends_with(kImaginary) || column.name.ends_with(kPhase);
    if (is_part || is_frequency(column)) continue;
    functions.push_back(function_of(columns, column, hertz, path.string()));
  }
  return assemble_responses(functions, channels, wanted, path.string());
}

}  // namespace modcal
