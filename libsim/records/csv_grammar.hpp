// The grammar of a CSV file: lines, comments, separators and quotes; numbers are not its business.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace modcal {

/// Receives what a CSV file is made of, in its order.
class CsvHandler {
 public:
  virtual ~CsvHandler() = default;
  /// A line whose first character (blanks aside) is '#' or '%'; `text` is what follows it.
  virtual void comment(std::string_view text) = 0;
  /// Field `index` (from 0) of the current row, without its quotes and the blanks around it.
  virtual void field(std::size_t index, std::string_view text) = 0;
  virtual void end_row(std::size_t fields) = 0;
};

/// A CSV file opened for one pass (RFC 4180, with comment lines; the separator is the one that a
/// first line "sep=;" states, else a tab, a semicolon or a comma, the first of these that stands in
/// the header; LF, CRLF or CR ends a
/// line; a UTF-8 byte order mark is skipped). Memory: one line.
class CsvFile {
 public:
  /// Throws InvalidInput where the file cannot be read, is empty or is not 8-bit text.
  explicit CsvFile(const std::filesystem::path& path);

  /// Reads the file to its end, or the lines that begin in its first `most` bytes. Throws
  /// InvalidInput where a quote is misplaced or never closed.
  void parse(CsvHandler& handler, std::uint64_t most = std::numeric_limits<std::uint64_t>::max());
  /// Bytes that were read.
  std::uint64_t taken() const { return taken_; }

  const std::string& name() const { return name_; }
  /// The separator found; 0 before the header is read.
  char separator() const { return separator_; }
  std::string separator_name() const;
  /// Number of the line being read, from 1.
  std::size_t line() const { return line_; }
  /// "file:line:column" of field `index` of the line being read.
  std::string place(std::size_t index) const;

 private:
  class Parser;
  bool next_line();

  std::string name_;
  std::ifstream file_;
  char newline_ = '\n';
  char separator_ = 0;
  std::string text_;
  std::size_t line_ = 0;
  std::uint64_t taken_ = 0;
};

// Numbers and column headings of a CSV record.

/// What a field holds. kNotFinite: "nan", "inf"; kOutOfRange: a number no double can hold.
enum class NumberKind { kNumber, kNotFinite, kOutOfRange, kText };

/// Decimal number with point, optional sign and exponent, and nothing else. `value` is NaN unless
/// the kind is kNumber (or the infinity that was written).
struct ParsedNumber {
  NumberKind kind = NumberKind::kText;
  double value = 0.0;
};
ParsedNumber parse_number(std::string_view text);

/// Whether numbers have decimal points or commas. A comma marks decimals, "0,25", where it does not
/// separate columns; all numbers of a file are written alike.
class DecimalMark {
 public:
  /// As parse_number() of a field between such separators.
  ParsedNumber parse(std::string_view text, char separator);
  /// Why the numbers so far may not be what they seem; empty: they are.
  std::string doubt() const;

 private:
  bool has_points_ = false;
  bool is_told_ = false;    ///< some comma cannot mark thousands
  std::string comma_ = {};  ///< the first number with one
};

/// Whether no field is a text.
bool are_numbers(std::span<const std::string> fields, char separator);

/// Throws InvalidInput where several names that are wanted stand in the only heading: the columns
/// have other separators. place: of the heading.
void require_apart(std::span<const std::string> headings, std::span<const std::string> wanted,
                   std::string_view place);

/// Why a field is no usable number and what to do about it.
std::string describe_bad_number(NumberKind kind, std::string_view text);

/// The finest decimals a column was printed with.
class PrintedDigits {
 public:
  void add(std::string_view number);
  /// Spacing of the printed numbers about `magnitude`: 10^−decimals for a fixed number of decimals,
  /// coarser for a fixed number of significant digits.
  double resolution(double magnitude) const;

 private:
  int decimals_ = 0;
  int significant_ = 1;
};

/// A heading "name [unit]" or "name (unit)"; the unit is empty where none is written.
struct ColumnHeading {
  std::string name;
  std::string unit;
};
ColumnHeading parse_heading(std::string_view text);
/// "name [unit]", or the name alone for an empty unit.
std::string heading_text(std::string_view name, std::string_view unit);

// What the file tells of its sampling: columns of instants, or a comment.

/// As parse_heading(), and of a time or a force the unit may stand behind another mark: "time/ms",
/// "t_s", "F_l/mN"; behind that of a time a number: "Time (s) 2".
ColumnHeading parse_column_heading(std::string_view text);

/// Those named t or time without a unit, and those whose unit is one of time.
class TimeColumns {
 public:
  TimeColumns() = default;
  explicit TimeColumns(std::span<const ColumnHeading> headings);

  bool empty() const { return columns_.empty(); }
  bool contains(std::size_t column) const;
  /// The instants of a column: the nearest to its left, or to its right in a file that ends with
  /// instants and does not begin with them. Nothing where there are none.
  std::optional<std::size_t> instants_of(std::size_t column) const;

 private:
  std::vector<std::size_t> columns_;
  bool stand_behind_ = false;
};

/// What a number called so is taken for, its name in small letters with _ between words.
bool is_name_of_rate(std::string_view name);

// Is a column of sampling instants uniform?

struct TimeFinding {
  std::size_t sample;  ///< index of the sample the finding is about, from 0
  std::string text;
  bool breaks = false;  ///< instants are missing here or return
};

struct TimeAxis {
  double sample_rate;  ///< [Hz]; NaN for fewer than two samples or instants that do not increase
  double jitter;       ///< largest deviation from the uniform grid [s]
  std::size_t jitter_sample;
  double rate_error;  ///< of the rate, relative, from printing and jitter
  bool coarse;  ///< not uniform, and printed too coarsely to tell why; the rate is not known then
  std::vector<TimeFinding> findings;
};

/// Why a rate is not known.
std::string too_coarse_text(std::string_view what, double resolution);

/// A rate whose period is known to a relative `resolution`: the whole number of hertz within it,
/// where there is one.
double rate_of_period(double period, double resolution);

/// A rate [Hz], why it may be another one or is not known (NaN), and by how much, relative, the
/// digits that were printed leave it open.
struct PrintedRate {
  double hertz = std::numeric_limits<double>::quiet_NaN();
  std::string doubt = {};
  double rounding = 0.0;
};

/// The rate of a period as it was printed, `value` units of time. One with too few digits for 0.05
/// % of the rate tells it where one over it is a whole number of hertz: without a doubt where that
/// is 1, 2 or 5 times a power of ten and the digits hold no other rate that recorders have.
/// Otherwise it is not known.
PrintedRate rate_of_printed_period(std::string_view number, double value, std::string_view what,
                                   std::string_view unit = "s");

/// The rate of a comment "sample_rate: 51.2 kHz", "fs [Hz] = 51200" or "dt: 1 ms" on the file's
/// present line; nothing for any other comment, and one with two units. Throws InvalidInput, with
/// the line, for a sample_rate that is none.
std::optional<PrintedRate> rate_in_comment(std::string_view text, const CsvFile& file);

/// Compares instants t_i [s], printed to `resolution` [s], with the uniform grid t_0 + i Δt,
/// Δt = (t_{n−1} − t_0)/(n − 1). A step over 1.5 median steps is a gap; a deviation over
/// 0.01 Δt + resolution (printing moves each instant by half its resolution) is jitter. The rate is
/// one over the printed step where all instants are multiples of it, 0.003, 0.006, 0.009; else the
/// whole number of hertz that explains them all within their printed resolution, where one does.
TimeAxis examine_time_axis(std::span<const double> t, double resolution);

}  // namespace modcal
