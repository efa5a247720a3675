#include <csv.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <iterator>

#include "libsim/base/error.hpp"
#include "libsim/records/csv_grammar.hpp"
#include "libsim/records/record_file.hpp"
#include "libsim/records/signal_file.hpp"

namespace modcal {
namespace {

constexpr std::size_t kBlock = 1 << 16;

std::string escaped(const std::string& text) {
  if (text.find_first_of(",;\t\"\n\r#") == std::string::npos) return text;
  std::string result(2 * text.size() + 2, '\0');
  result.resize(csv_write(result.data(), result.size(), text.data(), text.size()));
  return result;
}

void append_comment(fmt::memory_buffer& out, const std::string& text) {
  std::string line = text;
  std::replace(line.begin(), line.end(), '\r', ' ');
  for (std::size_t start = 0; start <= line.size();) {
    const std::size_t end = std::min(line.find('\n', start), line.size());
    fmt::format_to(std::back_inserter(out), "# {}\n", line.substr(start, end - start));
    start = end + 1;
  }
}

// Headings first: numpy.genfromtxt(names=True) takes the first line for them.
void append_preamble(fmt::memory_buffer& out, std::span<const Signal> signals,
                     const CsvWriteOptions& options) {
  std::string_view separator;
  if (options.time_column) {
    out.append(std::string_view("t [s]"));
    separator = ",";
  }
  for (const Signal& signal : signals) {
    out.append(separator);
    out.append(escaped(heading_text(signal.quantity, signal.unit)));
    separator = ",";
  }
  out.push_back('\n');
  append_comment(out, fmt::format("sample_rate: {} Hz", signals.front().sample_rate));
  for (const std::string& line : options.provenance) append_comment(out, line);
}

void append_row(fmt::memory_buffer& out, std::span<const Signal> signals, std::size_t i,
                bool time_column) {
  const auto end = std::back_inserter(out);
  if (time_column) {
    fmt::format_to(end, "{},", static_cast<double>(i) / signals.front().sample_rate);
  }
  for (const Signal& signal : signals) fmt::format_to(end, "{},", signal.samples[i]);
  out[out.size() - 1] = '\n';
}

void require_plain_headings(std::span<const Signal> signals, const std::string& file) {
  for (const Signal& signal : signals) {
    const ColumnHeading read = parse_heading(heading_text(signal.quantity, signal.unit));
    MODCAL_REQUIRE(
        read.name == signal.quantity && read.unit == signal.unit,
        "{}: a signal named \"{}\" with the unit \"{}\" cannot be told from its heading; "
        "use a name without brackets and without blanks at its ends",
        file, signal.quantity, signal.unit);
  }
}

}  // namespace

void write_csv(const std::filesystem::path& path, std::span<const Signal> signals,
               const CsvWriteOptions& options) {
  const std::string name = path.string();
  require_one_record(signals, name);
  require_plain_headings(signals, name);
  replace_file(path, [&](const std::filesystem::path& temporary) {
    errno = 0;
    std::ofstream file(temporary, std::ios::binary);
    MODCAL_REQUIRE(file.is_open(),
                   "{}: cannot be written: {}; check the folder and its permissions", name,
                   std::strerror(errno));
    fmt::memory_buffer out;
    append_preamble(out, signals, options);
    for (std::size_t i = 0; i < signals.front().size(); ++i) {
      append_row(out, signals, i, options.time_column);
      if (out.size() < kBlock && i + 1 < signals.front().size()) continue;
      file.write(out.data(), static_cast<std::streamsize>(out.size()));
      out.clear();
    }
    file.close();
    MODCAL_REQUIRE(!file.fail(), "{}: writing failed: {}; is the disk full?", name,
                   std::strerror(errno));
  });
}

}  // namespace modcal
