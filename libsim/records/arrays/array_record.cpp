#include <fmt/ranges.h>

#include <cmath>
#include <optional>

#include "libsim/base/error.hpp"
#include "libsim/base/units.hpp"
#include "libsim/base/utf8.hpp"
#include "libsim/base/words.hpp"
#include "libsim/records/arrays/array_file.hpp"
#include "libsim/records/stored_channels.hpp"
#include "libsim/records/tuning.hpp"

namespace modcal {
namespace {

using Content = std::shared_ptr<ArrayFile>;

std::string last_of(const NamedArray& array) { return lower_case(array.path.back()); }

bool is_one_of(const std::string& name, std::initializer_list<std::string_view> names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// How many names lead to the structure that `of` stands in, where the other is all of it or stands
// in it, too; the axis of a signal often stands in a structure x_values beside it.
std::optional<std::size_t> scope(const NamedArray& array, const NamedArray& of) {
  std::size_t depth = of.path.size() - 1;
  if (depth > 0 && of.path[depth - 1] == "x_values") --depth;
  const bool inside =
      array.path.size() >= depth &&
      std::equal(of.path.begin(), of.path.begin() + static_cast<long>(depth), array.path.begin());
  return inside ? std::optional(depth) : std::nullopt;
}

// The one that tells of an array, from the nearest structure; null: none.
template <typename Tells>
const NamedArray* nearest(const std::vector<NamedArray>& arrays, const NamedArray& array,
                          Tells tells) {
  const NamedArray* best = nullptr;
  for (const NamedArray& other : arrays) {
    if (!tells(other) || !scope(array, other)) continue;
    if (best == nullptr || *scope(array, other) > *scope(array, *best)) best = &other;
  }
  return best;
}

bool is_time(const NamedArray& array) { return is_name_of_time(array.path.back()); }
bool is_rate(const NamedArray& array) {
  return array.size() == 1 && array.is_real() &&
         is_one_of(last_of(array), {"sample_rate", "samplerate", "sampling_rate", "samplingrate",
                                    "sample_frequency", "sampling_frequency", "fs"});
}
bool is_period(const NamedArray& array) {
  return array.size() == 1 && array.is_real() &&
         is_one_of(last_of(array),
                   {"dt", "ts", "increment", "wf_increment", "sample_period", "delta_t"});
}

bool is_lines(const NamedArray& array) { return is_name_of_lines(array.path.back()); }
bool is_line_step(const NamedArray& array) {
  return array.size() == 1 && array.is_real() &&
         is_one_of(last_of(array), {"df", "delta_f", "frequency_step", "frequency_resolution"});
}

// Right below the array, as an attribute is.
bool is_below(const NamedArray& other, const NamedArray& array) {
  return other.path.size() == array.path.size() + 1 &&
         std::equal(array.path.begin(), array.path.end(), other.path.begin());
}

// A text `unit` right below the array, or one called "dt_unit" beside dt.
std::string unit_of(const Content& content, const NamedArray& array) {
  if (!array.unit.empty()) return array.unit;
  const std::string name = last_of(array);
  for (const NamedArray& other : content->arrays()) {
    if (other.holds != NamedArray::Holds::kText) continue;
    const std::string its = last_of(other);
    const bool is_attribute =
        is_below(other, array) &&
        is_one_of(its, {"unit", "units", "unit_string", "ni_unitdescription"});
    const bool is_beside = other.path.size() == array.path.size() &&
                           std::equal(array.path.begin(), array.path.end() - 1, other.path.begin());
    if (is_attribute || (is_beside && (its == name + "_unit" || its == name + "_units"))) {
      return content->text(other);
    }
  }
  return {};
}

// What one unit of the array is in SI; NaN where it is of another dimension.
double unit_in(const Content& content, const NamedArray& array, std::string_view si) {
  const std::string unit = unit_of(content, array);
  if (unit.empty()) return 1.0;
  return is_unit_of(unit, si) ? to_si(1.0, unit, si) : std::numeric_limits<double>::quiet_NaN();
}

double rate_told_by(const Content& content, const NamedArray& told) {
  const double value = content->number(told);
  if (is_rate(told)) return value * unit_in(content, told, "Hz");
  return rate_of_period(value * unit_in(content, told, "s"),
                        std::numeric_limits<double>::epsilon());
}

void set_times(const Content& content, const NamedArray& time, StoredChannel& channel) {
  const double second = unit_in(content, time, "s");
  if (std::isnan(second)) return;
  channel.rate_source = time.text();
  channel.read_times = [content, time, second] {
    std::vector<double> times = content->column(time, 0);
    for (double& instant : times) instant *= second;
    return times;
  };
  channel.time_resolution = time.is_single
                                ? static_cast<double>(std::numeric_limits<float>::epsilon())
                                : std::numeric_limits<double>::epsilon();
}

// A number tells the rate unless instants stand nearer; whatever else tells it must agree.
void set_rate(const Content& content, const NamedArray& array, StoredChannel& channel) {
  const std::vector<NamedArray>& arrays = content->arrays();
  const auto tells = [](const NamedArray& other) { return is_rate(other) || is_period(other); };
  const NamedArray* const told = nearest(arrays, array, tells);
  const NamedArray* const time = nearest(arrays, array, [&array](const NamedArray& other) {
    return is_time(other) && other.is_real() && other.is_table() && other.columns() == 1 &&
           other.rows() == array.rows();
  });
  if (time != nullptr) set_times(content, *time, channel);
  if (told == nullptr || (time != nullptr && *scope(array, *time) > *scope(array, *told))) return;
  channel.sample_rate = rate_told_by(content, *told);
  channel.rate_source = fmt::format("{} = {:.9g}", told->text(), content->number(*told));
  channel.is_rate_stated = true;
  for (const NamedArray& other : arrays) {
    if (!tells(other) || scope(array, other) != scope(array, *told)) continue;
    const double rate = rate_told_by(content, other);
    if (!(std::abs(rate / channel.sample_rate - 1.0) > kSameRate)) continue;
    channel.contradiction =
        fmt::format("{} says {:.9g} Hz, {} = {:.9g} says {:.9g} Hz", channel.rate_source,
                    channel.sample_rate, other.text(), content->number(other), rate);
  }
}

// What stored numbers are to be multiplied by and added to (scale_factor and add_offset below it,
// as netCDF has them).
constexpr std::pair<double, double> kPlain{1.0, 0.0};
std::pair<double, double> packing_of(const Content& content, const NamedArray& array) {
  std::pair<double, double> packing = kPlain;
  for (const NamedArray& other : content->arrays()) {
    if (!is_below(other, array) || other.size() != 1 || !other.is_real()) continue;
    if (last_of(other) == "scale_factor") packing.first = content->number(other);
    if (last_of(other) == "add_offset") packing.second = content->number(other);
  }
  return packing;
}

void add_channels(const Content& content, const std::filesystem::path& path,
                  const NamedArray& array, std::vector<StoredChannel>& channels) {
  const bool is_plain = array.is_real() && array.is_table();
  const std::size_t count = is_plain ? array.columns() : 1;
  const std::pair<double, double> packing = packing_of(content, array);
  // Every channel has its entry before a sample is read.
  constexpr std::size_t kMostChannels = 1 << 12;
  const bool is_many = count > kMostChannels;
  for (std::size_t j = 0; j < (is_many ? 1 : count); ++j) {
    StoredChannel channel;
    channel.head.name = array.text();
    if (count > 1 && !is_many) channel.head.name += fmt::format("_{}", j + 1);
    channel.head.unit = unit_of(content, array);
    channel.place = fmt::format("{}: {}", path.string(), channel.head.name);
    channel.size = is_plain && !is_many ? array.rows() : array.size();
    if (!is_plain || is_many) {
      channel.other_than_time = fmt::format(
          "{}array of {} values", array.is_real() ? "" : "complex ", fmt::join(array.dims, " × "));
    } else {
      set_rate(content, array, channel);
      channel.read = [content, array, j, packing] {
        std::vector<double> samples = content->column(array, j);
        if (packing == kPlain) return samples;  // to the sign of 0
        for (double& x : samples) x = packing.first * x + packing.second;
        return samples;
      };
    }
    channels.push_back(std::move(channel));
  }
}

// The vector of lines, or the number that they are multiples of; null: nothing tells them.
const NamedArray* lines_of(const Content& content, const NamedArray& array) {
  const std::vector<NamedArray>& arrays = content->arrays();
  const NamedArray* const lines = nearest(arrays, array, [&array](const NamedArray& other) {
    return is_lines(other) && other.is_real() && other.is_table() && other.columns() == 1 &&
           other.rows() == array.rows();
  });
  return lines != nullptr ? lines : nearest(arrays, array, is_line_step);
}

// The values of the j-th column of a table.
std::function<std::vector<Complex>()> values_of(const Content& content, const NamedArray& array,
                                                std::size_t j) {
  return [content, array, j] {
    const std::vector<double> parts = content->column(array, j);
    std::vector<Complex> values(array.rows());
    for (std::size_t m = 0; m < values.size(); ++m) {
      values[m] = array.is_real() ? parts[m] : Complex(parts[2 * m], parts[2 * m + 1]);
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
    function.head.unit = unit_of(content, array);
    function.place = fmt::format("{}: {}", path.string(), function.head.name);
    function.size = array.rows();
    function.what = array.is_real() ? FrequencyFunction::kCoherence : FrequencyFunction::kResponse;
    const bool is_step = lines->size() == 1 && lines->front() > 0.0;
    if (is_step) {
      set_multiples(lines->front(), function, values_of(content, array, j));
    } else if (told == nullptr || std::isnan(hertz)) {
      function.other_than_time = fmt::format(
          "{} values without their lines: state them as a vector f [Hz], or a number df",
          array.rows());
    } else {
      set_lines(lines, function, values_of(content, array, j));
    }
  }
}

}  // namespace

std::string NamedArray::text() const {
  return title.empty() ? utf8_or_latin1(fmt::format("{}", fmt::join(path, "."))) : title;
}

Recording recording_of(const Content& content, std::string_view kind,
                       const std::filesystem::path& path, const ReadOptions& options) {
  std::vector<StoredChannel> channels;
  for (const NamedArray& array : content->arrays()) {
    const bool may_be_channel = array.has_numbers() && array.size() > 1;
    if (may_be_channel && !is_time(array)) add_channels(content, path, array, channels);
  }
  MODCAL_REQUIRE(!channels.empty(), "{}: no vector of numbers stands in this {}", path.string(),
                 kind);
  const std::size_t count = channels.size();
  return assemble(fmt::format("{}, {} channel{}", kind, count, count == 1 ? "" : "s"),
                  std::move(channels), options, path.string());
}

std::vector<StoredChannel> functions_of(const Content& content, const std::filesystem::path& path) {
  std::vector<StoredChannel> functions;
  for (const NamedArray& array : content->arrays()) {
    constexpr std::size_t kMostFunctions = 1 << 12;
    const bool is_table = array.has_numbers() && array.is_table();
    if (!is_table || is_lines(array) || array.columns() > kMostFunctions) continue;
    add_functions(content, path, array, functions);
  }
  return functions;
}

bool is_name_of_time(const std::string& name) { return is_one_of(lower_case(name), {"t", "time"}); }
bool is_name_of_lines(const std::string& name) {
  return is_one_of(lower_case(name), {"f", "freq", "freqs", "frequency", "frequencies", "f_hz"});
}

}  // namespace modcal
