// Response functions in the columns of a CSV file.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "libsim/base/error.hpp"
#include "libsim/base/units.hpp"
#include "libsim/records/arrays/array_file.hpp"
#include "libsim/records/csv/csv_table.hpp"
#include "libsim/records/csv_grammar.hpp"
#include "libsim/records/signal_file.hpp"

namespace modcal {
namespace {

constexpr std::string_view kReal = " real", kImaginary = " imaginary", kPhase = " phase";

const RecordedChannel* find(const Recording& columns, const std::string& name) {
  const auto at = std::ranges::find(columns.channels, name, &RecordedChannel::name);
  return at == columns.channels.end() ? nullptr : &*at;
}

bool is_frequency(const RecordedChannel& column) { return is_name_of_lines(column.name); }

// Columns that are no functions, and why.
std::vector<StoredChannel> none_of(const Recording& columns, const std::string& why) {
  std::vector<StoredChannel> others;
  for (const RecordedChannel& column : columns.channels) {
    StoredChannel& other = others.emplace_back();
    other.head.name = column.name;
    other.other_than_time = fmt::format("{} rows: {}", column.samples.size(), why);
  }
  return others;
}

// Radians for one in the column; NaN: its unit is not known.
double radians(const std::string& unit) {
  if (unit == "rad") return 1.0;
  const bool is_degree = unit == "deg" || unit == "degree" || unit == "degrees" || unit == "°";
  return is_degree ? std::numbers::pi / 180.0 : std::numeric_limits<double>::quiet_NaN();
}

void require_no_level(const std::string& name, const std::string& unit, const std::string& file) {
  MODCAL_REQUIRE(unit.find("dB") == std::string::npos,
                 "{}: {} is in \"{}\"; write magnitudes, not levels", file, name, unit);
}

using Lines = std::shared_ptr<const std::vector<double>>;

StoredChannel function_of(const Recording& columns, const RecordedChannel& column,
                          const Lines& hertz, const std::string& file) {
  StoredChannel function;
  function.head.name = column.name;
  function.head.unit = column.unit;
  function.size = column.samples.size();
  if (column.name.ends_with(kReal)) {
    function.head.name.resize(column.name.size() - kReal.size());
  }
  const std::string& name = function.head.name;
  const RecordedChannel* const imaginary = find(columns, name + std::string(kImaginary));
  const RecordedChannel* const phase = find(columns, name + std::string(kPhase));
  if (imaginary == nullptr && phase == nullptr) function.what = FrequencyFunction::kCoherence;
  MODCAL_REQUIRE(imaginary == nullptr || phase == nullptr,
                 "{}: {} has an imaginary part and a phase; leave one column out", file, name);
  MODCAL_REQUIRE(imaginary != nullptr || name == column.name,
                 "{}: {} has a real part and no column \"{} imaginary\"", file, name, name);
  require_no_level(name, column.unit, file);
  MODCAL_REQUIRE(imaginary == nullptr || imaginary->unit.empty() || imaginary->unit == column.unit,
                 "{}: {} is in \"{}\", its imaginary part in \"{}\"", file, name, column.unit,
                 imaginary->unit);
  MODCAL_REQUIRE(imaginary != nullptr || phase == nullptr || !std::isnan(radians(phase->unit)),
                 "{}: the column {} is in \"{}\"; state its unit, [deg] or [rad]", file,
                 phase->name, phase->unit);
  std::vector<Complex> values(column.samples.size());
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

// One that function_of() finds again.
void require_plain_column(const std::string& name, const std::string& unit,
                          const std::string& file) {
  const ColumnHeading read = parse_column_heading(heading_text(name, unit));
  const bool is_part =
      name.ends_with(kReal) || name.ends_with(kImaginary) || name.ends_with(kPhase);
  MODCAL_REQUIRE(read.name == name && read.unit == unit && !is_part && !is_name_of_lines(name),
                 "{}: a function named \"{}\" with the unit \"{}\" cannot be told from its "
                 "heading; use a name without brackets that is no frequency and no part of a "
                 "function, or write another format",
                 file, name, unit);
  require_no_level(name, unit, file);
}

}  // namespace

std::vector<StoredChannel> csv_functions(const std::filesystem::path& path) {
  // Rows are no samples in time: any rate will do.
  const Recording columns = read_csv(path, {.sample_rate = 1.0, .has_time = false});
  const auto frequency = std::ranges::find_if(columns.channels, is_frequency);
  if (frequency == columns.channels.end()) {
    return none_of(columns, "response functions need a column frequency [Hz]");
  }
  const std::string& unit = frequency->unit;
  if (!unit.empty() && !is_unit_of(unit, "Hz")) {
    return none_of(columns, fmt::format("the column {} is in \"{}\"; state frequencies in Hz",
                                        frequency->name, unit));
  }
  std::vector<double> lines = frequency->samples;
  for (double& line : lines) line = unit.empty() ? line : to_si(line, unit, "Hz");
  const auto hertz = std::make_shared<const std::vector<double>>(std::move(lines));
  std::vector<StoredChannel> functions;
  for (const RecordedChannel& column : columns.channels) {
    const bool is_part = column.name.ends_with(kImaginary) || column.name.ends_with(kPhase);
    if (is_part || is_frequency(column)) continue;
    functions.push_back(function_of(columns, column, hertz, path.string()));
  }
  return functions;
}

void write_csv_functions(const std::filesystem::path& path, std::span<const FileFunction> functions,
                         const std::string& provenance) {
  const std::string file = path.string();
  require_functions(functions, file);
  std::vector<std::string> headings = {heading_text("frequency", "Hz")};
  for (const FileFunction& function : functions) {
    const std::string unit = function.whole_unit();
    require_plain_column(function.name, unit, file);
    headings.push_back(heading_text(function.name, unit));
    if (function.is_real()) continue;
    headings.push_back(heading_text(function.name + std::string(kImaginary), unit));
  }
  const std::vector<double>& hertz = functions.front().hertz;
  write_csv_table(path, headings, {&provenance, 1}, hertz.size(), [&](std::size_t m, auto& row) {
    row.push_back(hertz[m]);
    for (const FileFunction& function : functions) {
      row.push_back(function.values[m].real());
      if (!function.is_real()) row.push_back(function.values[m].imag());
    }
  });
}

}  // namespace modcal
