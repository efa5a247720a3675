#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "libsim/base/error.hpp"
#include "libsim/base/units.hpp"
#include "libsim/base/utf8.hpp"
#include "libsim/base/words.hpp"
#include "libsim/records/arrays/array_axis.hpp"
#include "libsim/records/csv_grammar.hpp"

namespace modcal {
namespace {

void add_channels(const Content& content, const std::filesystem::path& path,
                  const NamedArray& array, ArrayAxes& axes, std::vector<StoredChannel>& channels) {
  const bool is_plain = array.is_real() && array.is_table();
  const std::size_t count = is_plain ? array.columns() : 1;
  // Every channel has its entry before a sample is read.
  constexpr std::size_t kMostChannels = 1 << 12;
  const bool is_many = count > kMostChannels;
  for (std::size_t j = 0; j < (is_many ? 1 : count); ++j) {
    StoredChannel channel;
    const Packing packing = packing_of(content, array, j);
    channel.head.name = array.text();
    if (count > 1 && !is_many) channel.head.name += fmt::format("_{}", j + 1);
    channel.head.unit = unit_of(content, array, j);
    channel.place = fmt::format("{}: {}", path.string(), channel.head.name);
    channel.size = is_plain && !is_many ? array.rows() : array.size();
    if (!is_plain || is_many) {
      channel.other_than_time = fmt::format(
          "{}array of {} values", array.is_real() ? "" : "complex ", fmt::join(array.dims, " × "));
    } else if (!packing.fault.empty()) {
      channel.other_than_time = packing.fault;
    } else {
      axes.set(array, channel);
      channel.read = [content, array, j, packing] {
        std::vector<double> samples = content->column(array, j);
        if (packing.is_plain()) return samples;  // to the sign of 0
        for (double& x : samples) x = packing.unpacked(x);
        return samples;
      };
    }
    channels.push_back(std::move(channel));
  }
}

// The values of the j-th column of a table.
std::function<std::vector<Complex>()> values_of(const Content& content, const NamedArray& array,
                                                std::size_t j, const Packing& packing) {
  return [content, array, j, packing] {
    const std::vector<double> parts = content->column(array, j);
    std::vector<Complex> values(array.rows());
    for (std::size_t m = 0; m < values.size(); ++m) {
      values[m] = array.is_real() ? parts[m] : Complex(parts[2 * m], parts[2 * m + 1]);
      if (!packing.is_plain()) values[m] = packing.factor * values[m] + packing.offset;
    }
    return values;
  };
}

void add_functions(const Content& content, const std::filesystem::path& path,
                   const NamedArray& array, std::vector<StoredChannel>& functions) {
  const NamedArray* const told = lines_of(content, array);
  const double hertz = told == nullptr ? 1.0 : unit_in(content, *told, "Hz");
  const auto lines = std::make_shared<std::vector<double>>();
  if (told != nullptr) *lines = content->column(*told, 0);
  for (double& line : *lines) line *= hertz;
  for (std::size_t j = 0; j < array.columns(); ++j) {
    StoredChannel& function = functions.emplace_back();
    function.head.name = array.text();
    if (array.columns() > 1) function.head.name += fmt::format("_{}", j + 1);
    const Packing packing = packing_of(content, array, j);
    function.head.unit = unit_of(content, array, j);
    function.place = fmt::format("{}: {}", path.string(), function.head.name);
    function.size = array.rows();
    function.what = array.is_real() ? FrequencyFunction::kCoherence : FrequencyFunction::kResponse;
    const bool is_step = lines->size() == 1 && lines->front() > 0.0;
    if (!packing.fault.empty()) {
      function.other_than_time = packing.fault;
    } else if (is_step) {
      set_multiples(lines->front(), function, values_of(content, array, j, packing));
    } else if (told == nullptr || std::isnan(hertz)) {
      function.other_than_time = fmt::format(
          "{} values without their lines: state them as a vector f [Hz], or a number df",
          array.rows());
    } else {
      set_lines(lines, function, values_of(content, array, j, packing));
    }
  }
}

// Texts and objects as long as the channels beside them were meant to be one.
void add_others(const Content& content, const std::filesystem::path& path,
                std::vector<StoredChannel>& channels) {
  std::vector<StoredChannel> others;
  for (const NamedArray& array : content->arrays()) {
    const auto is_as_long = [&array](const StoredChannel& channel) {
      return channel.size == array.rows();
    };
    if (array.has_numbers() || array.is_note || !array.is_table() || array.columns() > 1 ||
        std::ranges::none_of(channels, is_as_long)) {
      continue;
    }
    StoredChannel& other = others.emplace_back();
    other.head.name = array.text();
    other.place = fmt::format("{}: {}", path.string(), other.head.name);
    other.size = array.rows();
    other.other_than_time = fmt::format("{} texts or objects in the place of numbers", other.size);
  }
  std::ranges::move(others, std::back_inserter(channels));
}

}  // namespace

std::string NamedArray::text() const {
  return title.empty() ? utf8_or_latin1(fmt::format("{}", fmt::join(path, "."))) : title;
}

double ArrayFile::number_of_text(const NamedArray& array) {
  return parse_number(trimmed(text(array))).value;
}

Recording recording_of(const Content& content, std::string_view kind,
                       const std::filesystem::path& path, const ReadOptions& options) {
  std::vector<StoredChannel> channels;
  ArrayAxes axes(content, options.headers_only);
  for (const NamedArray& array : content->arrays()) {
    if (may_be_channel(content, array)) add_channels(content, path, array, axes, channels);
  }
  MODCAL_REQUIRE(!channels.empty(), "{}: no vector of numbers stands in this {}", path.string(),
                 kind);
  const std::size_t count = channels.size();
  add_others(content, path, channels);
  Recording recording =
      assemble(fmt::format("{}, {} channel{}", kind, count, count == 1 ? "" : "s"),
               std::move(channels), options, path.string());
  for (const auto& sentences : {unapplied_packing(content), units_of_nobody(content)}) {
    for (const std::string& sentence : sentences) {
      recording.warnings.push_back(fmt::format("{}: {}", path.string(), sentence));
    }
  }
  return recording;
}

std::vector<StoredChannel> functions_of(const Content& content, const std::filesystem::path& path) {
  std::vector<StoredChannel> functions;
  for (const NamedArray& array : content->arrays()) {
    constexpr std::size_t kMostFunctions = 1 << 12;
    const bool is_table = array.is_table() && may_be_channel(content, array);
    if (!is_table || is_name_of_lines(array.path.back()) || array.columns() > kMostFunctions) {
      continue;
    }
    add_functions(content, path, array, functions);
  }
  return functions;
}

bool is_name_of_time(const std::string& name) {
  const ColumnHeading heading = parse_column_heading(name);
  return is_one_of(lower_case(heading.name), {"t", "time"}) &&
         (heading.unit.empty() || is_unit_of(heading.unit, "s"));
}
bool is_name_of_lines(const std::string& name) {
  return is_one_of(lower_case(name), {"f", "freq", "freqs", "frequency", "frequencies", "f_hz"});
}

}  // namespace modcal
