#include <csv.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <iterator>

#include "libsim/base/error.hpp"
#include "libsim/records/csv/csv_table.hpp"
#include "libsim/records/csv_grammar.hpp"
#include "libsim/records/record_file.hpp"
#include "libsim/records/signal_file.hpp"

namespace modcal {
namespace {

constexpr std::size_t kBlock = 1 << 16;

std::string escaped(const std::string& text) {
  if (text.find_first_of(",;\t\"\n\r#%") == std::string::npos) return text;
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

void require_plain_headings(std::span<const Signal> signals, const std::string& file) {
  for (const Signal& signal : signals) {
    const ColumnHeading read = parse_column_heading(heading_text(signal.quantity, signal.unit));
    MODCAL_REQUIRE(
        read.name == signal.quantity && read.unit == signal.unit,
        "{}: a signal named \"{}\" with the unit \"{}\" cannot be told from its heading; "
        "use a name without brackets and without blanks at its ends",
        file, signal.quantity, signal.unit);
    MODCAL_REQUIRE(TimeColumns({&read, 1}).empty(),
                   "{}: a column \"{}\" would be read as instants; rename the signal or its unit, "
                   "or write another format",
                   file, heading_text(signal.quantity, signal.unit));
  }
}

// A name that no signal has.
std::string time_name(std::span<const Signal> signals) {
  std::string name = "t";
  while (std::ranges::find(signals, name, &Signal::quantity) != signals.end()) {
    if (name == "t") {
      name = "time";
    } else {
      name += '_';
    }
  }
  return name;
}

// Headings first: numpy.genfromtxt(names=True) takes the first line for them.
void append_preamble(fmt::memory_buffer& out, std::span<const std::string> headings,
                     std::span<const std::string> comments) {
  std::string_view separator;
  for (const std::string& heading : headings) {
    out.append(std::exchange(separator, ","));
    out.append(escaped(heading));
  }
  out.push_back('\n');
  for (const std::string& line : comments) append_comment(out, line);
}

}  // namespace

void write_csv_table(const std::filesystem::path& path, std::span<const std::string> headings,
                     std::span<const std::string> comments, std::size_t rows,
                     const std::function<void(std::size_t, std::vector<double>&)>& append_row) {
  const std::string name = path.string();
  replace_file(path, [&](const std::filesystem::path& temporary) {
    errno = 0;
    std::ofstream file(temporary, std::ios::binary);
    MODCAL_REQUIRE(file.is_open(),
                   "{}: cannot be written: {}; check the folder and its permissions", name,
                   std::strerror(errno));
    fmt::memory_buffer out;
    append_preamble(out, headings, comments);
    std::vector<double> row;
    for (std::size_t i = 0; i < rows; ++i) {
      row.clear();
      append_row(i, row);
      for (const double value : row) fmt::format_to(std::back_inserter(out), "{},", value);
      out[out.size() - 1] = '\n';
      if (out.size() < kBlock && i + 1 < rows) continue;
      file.write(out.data(), static_cast<std::streamsize>(out.size()));
      out.clear();
    }
    file.close();
    MODCAL_REQUIRE(!file.fail(), "{}: writing failed: {}; is the disk full?", name,
                   std::strerror(errno));
  });
}

void write_csv(const std::filesystem::path& path, std::span<const Signal> signals,
               const CsvWriteOptions& options) {
  const std::string name = path.string();
  require_one_record(signals, name);
  require_plain_headings(signals, name);
  const double rate = signals.front().sample_rate;
  std::vector<std::string> headings;
  if (options.time_column) headings.push_back(heading_text(time_name(signals), "s"));
  for (const Signal& signal : signals) {
    headings.push_back(heading_text(signal.quantity, signal.unit));
  }
  std::vector<std::string> comments = {fmt::format("sample_rate: {} Hz", rate)};
  comments.insert(comments.end(), options.provenance.begin(), options.provenance.end());
  write_csv_table(path, headings, comments, signals.front().size(),
                  [&](std::size_t i, std::vector<double>& row) {
                    if (options.time_column) {
                      row.push_back(options.start + static_cast<double>(i) / rate);
                    }
                    for (const Signal& signal : signals) row.push_back(signal.samples[i]);
                  });
}

}  // namespace modcal
