#include <bit>
#include <fstream>

#include "libsim/base/error.hpp"
#include "libsim/base/units.hpp"
#include "libsim/records/quantities.hpp"
#include "libsim/records/signal_file.hpp"
#include "libsim/records/universal/universal_file.hpp"
#include "libsim/records/universal/universal_types.hpp"

namespace modcal {
namespace {

// One dataset 58b in doubles.
struct WrittenDataset {
  int type = 0;
  std::string name, provenance, last_id_line = "NONE";
  MeasuredPlaces places = {};
  bool is_complex = false, is_even = true;
  std::size_t size = 0;  ///< lines or samples
  double first = 0.0, step = 0.0;
  std::string abscissa, ordinate, denominator;  ///< lines of the header
  std::span<const double> numbers;              ///< all that stands behind it
};

std::string axis_line(int code, std::string_view label, std::string_view unit) {
  return fmt::format("{:10}{:5}{:5}{:5} {:20.20} {:20.20}\n", code, 0, 0, 0, label,
                     unit.empty() ? "NONE" : unit);
}

std::string axis_line(const Quantity* quantity, std::string_view unit) {
  return axis_line(quantity == nullptr ? 0 : quantity->code,
                   quantity == nullptr ? "NONE" : quantity->kind, unit);
}

std::string header_of(const WrittenDataset& data) {
  std::string text = fmt::format("    -1\n    58b{:6}{:6}{:12}{:12}{:6}{:6}{:12}{:12}\n",
                                 std::endian::native == std::endian::little ? 1 : 2, 2, 11,
                                 data.numbers.size_bytes(), 0, 0, 0, 0);
  text += fmt::format("{:.80}\n{:.80}\nNONE\nNONE\n{}\n", data.name, data.provenance,
                      data.last_id_line);
  // The full name stands in ID line 1: the entity has ten characters.
  const MeasuredPlaces& at = data.places;
  text += fmt::format("{:5}{:10}{:5}{:10} {:10}{:10}{:4} {:10}{:10}{:4}\n", data.type, 0, 0, 0,
                      "NONE", at.response_node, at.response_direction, "NONE", at.reference_node,
                      at.reference_direction);
  text += fmt::format("{:10}{:10}{:10}{:13.5E}{:13.5E}{:13.5E}\n", data.is_complex ? 6 : 4,
                      data.size, data.is_even ? 1 : 0, data.first, data.step, 0.0);
  return text + data.abscissa + data.ordinate + data.denominator + axis_line(nullptr, "");
}

void require_room(const std::string& name, std::string_view unit, const std::string& file) {
  MODCAL_REQUIRE(
      name.size() <= 80 && unit.size() <= 20 && name.find_first_of("\r\n") == std::string::npos,
      "{}: the name \"{}\" [{}] does not fit into a universal file", file, name, unit);
}

// Calls each(i, write) for every dataset in turn.
template <typename Each>
void write_datasets(const std::filesystem::path& path, std::size_t count, Each each) {
  replace_file(path, [&](const std::filesystem::path& temporary) {
    std::ofstream file(temporary, std::ios::binary);
    const auto write = [&file](const WrittenDataset& data) {
      file << header_of(data);
      file.write(reinterpret_cast<const char*>(data.numbers.data()),
                 static_cast<std::streamsize>(data.numbers.size_bytes()));
      file << "\n    -1\n";
    };
    for (std::size_t i = 0; i < count; ++i) each(i, write);
    file.close();
    MODCAL_REQUIRE(!file.fail(), "{}: writing failed; is the disk full?", path.string());
  });
}

// The lines where no formula gives them, and the values.
std::vector<double> numbers_of(const FileFunction& function, bool is_even) {
  std::vector<double> numbers;
  for (std::size_t m = 0; m < function.values.size(); ++m) {
    if (!is_even) numbers.push_back(function.hertz[m]);
    numbers.push_back(function.values[m].real());
    if (!function.is_real()) numbers.push_back(function.values[m].imag());
  }
  return numbers;
}

WrittenDataset dataset_of(const FileFunction& function, const std::optional<EvenLines>& even) {
  WrittenDataset data;
  data.type = type_of(function.what);
  data.name = function.name;
  data.places = function.places;
  data.is_complex = !function.is_real();
  data.is_even = even.has_value();
  data.size = function.values.size();
  if (even) {
    data.last_id_line = lines_text(*even);
    data.first = even->begin();
    data.step = even->spacing();
  }
  data.abscissa = axis_line(quantity_of_kind("frequency"), "Hz");
  const Quantity* const stated = quantity_of_kind(function.kind);
  data.ordinate =
      axis_line(stated != nullptr ? stated : quantity_of_unit(function.unit), function.unit);
  const bool is_force = is_unit_of(function.per_unit, "N");
  data.denominator = axis_line(
      is_force ? quantity_of_kind("excitation force") : quantity_of_unit(function.per_unit),
      function.per_unit);
  return data;
}

}  // namespace

void write_universal(const std::filesystem::path& path, std::span<const Signal> signals,
                     const RecordNotes& notes) {
  require_one_record(signals, path.string());
  for (const Signal& signal : signals) require_room(signal.quantity, signal.unit, path.string());
  write_datasets(path, signals.size(), [&](std::size_t i, const auto& write) {
    const Signal& signal = signals[i];
    write({.type = 1,
           .name = signal.quantity,
           .provenance = notes.provenance,
           .last_id_line = fmt::format("sample_rate: {}", signal.sample_rate),
           .size = signal.size(),
           .first = notes.start,
           .step = 1.0 / signal.sample_rate,
           .abscissa = axis_line(17, "Time", "s"),
           .ordinate = axis_line(quantity_of_unit(signal.unit), signal.unit),
           .denominator = axis_line(nullptr, ""),
           .numbers = signal.samples});
  });
}

void write_universal_functions(const std::filesystem::path& path,
                               std::span<const FileFunction> functions,
                               const std::string& provenance) {
  require_functions(functions, path.string());
  for (const FileFunction& function : functions) {
    require_room(function.name, function.unit, path.string());
    require_room(function.name, function.per_unit, path.string());
  }
  write_datasets(path, functions.size(), [&](std::size_t i, const auto& write) {
    const std::optional<EvenLines> even = even_lines(functions[i].hertz);
    const std::vector<double> numbers = numbers_of(functions[i], even.has_value());
    WrittenDataset data = dataset_of(functions[i], even);
    data.provenance = provenance;
    data.numbers = numbers;
    write(data);
  });
}

}  // namespace modcal
