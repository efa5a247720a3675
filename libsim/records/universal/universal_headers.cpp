#include <algorithm>
#include <charconv>

#include "libsim/base/error.hpp"
#include "libsim/base/words.hpp"
#include "libsim/records/csv_grammar.hpp"
#include "libsim/records/universal/columns.hpp"
#include "libsim/records/universal/universal_file.hpp"

namespace modcal {
namespace {

class HeaderReader {
 public:
  explicit HeaderReader(const std::filesystem::path& path) : file_(path) {}

  UniversalFile read() {
    std::string line;
    while (file_.next(line)) {
      if (trimmed(line).empty()) continue;
      MODCAL_REQUIRE(is_delimiter(line),
                     "{}:{}: byte {}: a dataset of a universal file begins with -1", file_.name(),
                     file_.place().line - 1, file_.place().byte);
      read_dataset();
    }
    return std::move(result_);
  }

 private:
  std::string where() const {
    return fmt::format("{}:{}: dataset {}{}", file_.name(), file_.place().line - 1, number_,
                       binary_ ? "b" : "");
  }
  Columns line() {
    std::string text;
    MODCAL_REQUIRE(file_.next(text),
                   "{}: the file ends at byte {}, within its header; it was cut off", where(),
                   file_.size());
    MODCAL_REQUIRE(!is_delimiter(text), "{}: it ends within its header", where());
    return {text, where()};
  }

  void read_dataset();
  void read_units();
  void read_function(const Columns& heading);
  void skip_to_end();
  void skip_values(const UniversalFunction& function);
  void leap_lines(const UniversalFunction& function);
  void find_width(UniversalFunction& function) const;

  LineFile file_;
  UniversalFile result_;
  int number_ = 0;
  bool binary_ = false;
};

void HeaderReader::read_dataset() {
  number_ = 0;
  binary_ = false;
  const Columns heading = line();
  number_ = heading.small(0, 6);
  MODCAL_REQUIRE(number_ > 0, "{}: a number of a dataset is expected", where());
  binary_ = trimmed(heading.text(6, 1)) == "b";
  if (number_ == 58) return read_function(heading);
  if (number_ == 164) return read_units();
  auto& others = result_.other_datasets;
  if (std::find(others.begin(), others.end(), number_) == others.end()) others.push_back(number_);
  MODCAL_REQUIRE(!binary_, "{}: binary datasets other than 58b are not read", where());
  if (number_ == 55) result_.shapes.push_back(file_.place());
  skip_to_end();
}

void HeaderReader::skip_to_end() {
  const std::string begin = where();
  std::string text;
  do {
    MODCAL_REQUIRE(file_.next(text), "{}: it has no end, -1, up to byte {}; the file was cut off",
                   begin, file_.size());
  } while (!is_delimiter(text));
}

void HeaderReader::read_units() {
  UniversalUnits units;
  units.code = line().small(0, 10);
  const Columns factors = line();
  for (std::size_t i = 0; i < 3; ++i) {
    units.factors[i] = factors.number(25 * i, 25);
    MODCAL_REQUIRE(units.factors[i] > 0.0, "{}: a factor of units must be > 0", where());
  }
  result_.units = units;
  skip_to_end();
}

UniversalAxis axis_of(const Columns& line) {
  return {line.small(0, 10),
          {line.small(10, 5), line.small(15, 5), line.small(20, 5)},
          known_field(line.text(26, 20)),
          known_field(line.text(47, 20))};
}

std::string name_of(const UniversalFunction& function, const std::string& entity) {
  if (entity.empty()) {
    const std::string id = known_field(function.id_lines[0]);
    return id.empty() && function.places.response_node > 0
               ? fmt::format("node {} {:+d}", function.places.response_node,
                             function.places.response_direction)
               : id;
  }
  if (function.places.response_node == 0) return entity;
  return fmt::format("{} {} {:+d}", entity, function.places.response_node,
                     function.places.response_direction);
}

void HeaderReader::read_function(const Columns& heading) {
  UniversalFunction function;
  function.header = {file_.place().byte, file_.place().line - 1};
  for (std::string& id : function.id_lines) id = std::string(trimmed(line().text(0, 80)));
  const Columns dof = line();
  function.type = dof.small(0, 5);
  function.places.response_node = dof.small(41, 10);
  function.places.response_direction = dof.small(51, 4);
  function.places.reference_node = dof.small(66, 10);
  function.places.reference_direction = dof.small(76, 4);
  function.name = name_of(function, known_field(dof.text(31, 10)));
  const Columns form = line();
  const int data_type = form.small(0, 10);
  MODCAL_REQUIRE(data_type == 2 || (data_type >= 4 && data_type <= 6),
                 "{}: values of type {} are not read; 2, 4, 5 and 6 are possible", where(),
                 data_type);
  function.is_double = data_type == 4 || data_type == 6;
  function.is_complex = data_type >= 5;
  const long long size = form.whole(10, 10);
  MODCAL_REQUIRE(size >= 0, "{}: {} values are announced", where(), size);
  function.size = static_cast<std::uint64_t>(size);
  function.is_even = form.small(20, 10) == 1;
  function.first = form.number(30, 13);
  function.step = form.number(43, 13);
  PrintedDigits digits;
  digits.add(trimmed(form.text(43, 13)));
  if (function.step > 0.0) {
    function.step_resolution = 0.5 * digits.resolution(function.step) / function.step;
  }
  function.abscissa = axis_of(line());
  function.ordinate = axis_of(line());
  function.denominator = axis_of(line());
  line();
  function.values = file_.place();
  function.binary = binary_;
  if (binary_) {
    function.little_endian = heading.small(7, 6) == 1;
    MODCAL_REQUIRE(heading.small(13, 6) == 2, "{}: numbers that are not IEEE are not read",
                   where());
    const long long bytes = heading.whole(31, 12);
    MODCAL_REQUIRE(bytes >= 0, "{}: {} bytes are announced", where(), bytes);
    function.byte_count = static_cast<std::uint64_t>(bytes);
    find_width(function);
  }
  skip_values(function);
  result_.functions.push_back(std::move(function));
}

// Some writers keep an uneven abscissa in floats beside doubles, as the text form does.
void HeaderReader::find_width(UniversalFunction& function) const {
  const std::uint64_t value = function.is_double ? 8 : 4, parts = function.is_complex ? 2 : 1;
  const std::uint64_t per_value = value * (parts + (function.is_even ? 0 : 1));
  function.abscissa_is_single = function.is_double && !function.is_even &&
                                function.byte_count == function.size * (per_value - 4);
  MODCAL_REQUIRE(function.abscissa_is_single || function.byte_count == function.size * per_value,
                 "{}: {} bytes are announced for {} values of {} bytes", where(),
                 function.byte_count, function.size, per_value);
}

std::uint64_t numbers_in(std::string_view line) {
  std::uint64_t count = 0;
  double value = 0.0;
  const char* at = line.data();
  const char* const end = at + line.size();
  for (;;) {
    while (at < end && (*at == ' ' || *at == '\t' || *at == '+')) ++at;
    const auto [stop, error] = std::from_chars(at, end, value);
    if (error != std::errc()) return at == end ? count : 0;
    ++count;
    at = stop;
  }
}

// Over lines of text that are all as long as the first one, if the end of the values stands where
// it is then: a file of a gigabyte is not read for its headers. Stays where it does not; the values
// themselves are checked when they are read.
void HeaderReader::leap_lines(const UniversalFunction& function) {
  const FilePlace begin = file_.place();
  const std::uint64_t numbers =
      function.size * ((function.is_complex ? 2u : 1u) + (function.is_even ? 0u : 1u));
  std::string line;
  const std::uint64_t own = file_.next(line) ? numbers_in(line) : 0;
  const std::uint64_t bytes = file_.place().byte - begin.byte;
  const std::uint64_t lines = own == 0 ? 0 : numbers / own;
  bool right = lines > 1 && lines * bytes <= file_.size() - begin.byte;
  if (right) {
    // The end of the line before, the rest of the values, the end of the dataset.
    file_.go_to({begin.byte + lines * bytes - 1, begin.line + lines - 1});
    right = file_.next(line) && line.empty();
    const FilePlace there = file_.place();
    if (numbers % own > 0) right = right && file_.next(line) && numbers_in(line) == numbers % own;
    right = right && file_.next(line) && is_delimiter(line);
    if (right) return file_.go_to(there);
  }
  file_.go_to(begin);
}

void HeaderReader::skip_values(const UniversalFunction& function) {
  if (function.binary) {
    file_.skip(function.byte_count);
  } else {
    // A number of text has two characters at least.
    MODCAL_REQUIRE(function.size <= file_.left(),
                   "{}: {} values are announced, {} bytes are left; it was cut off", where(),
                   function.size, file_.left());
    leap_lines(function);
  }
  std::string text;
  const std::string begin = where();
  do {
    MODCAL_REQUIRE(file_.next(text),
                   "{}: its values have no end, -1, up to byte {}; it was cut off", begin,
                   file_.size());
    MODCAL_REQUIRE(!function.binary || trimmed(text).empty() || is_delimiter(text),
                   "{}: byte {}: more than the {} bytes announced stand before its end, -1", begin,
                   file_.place().byte, function.byte_count);
  } while (!is_delimiter(text));
}

}  // namespace

UniversalFile read_universal_headers(const std::filesystem::path& path) {
  return HeaderReader(path).read();
}

}  // namespace modcal
