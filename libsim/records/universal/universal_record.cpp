#include <cmath>
#include <limits>

#include "libsim/base/error.hpp"
#include "libsim/base/units.hpp"
#include "libsim/records/csv_grammar.hpp"
#include "libsim/records/quantities.hpp"
#include "libsim/records/stored_channels.hpp"
#include "libsim/records/tuning.hpp"
#include "libsim/records/universal/universal_file.hpp"
#include "libsim/records/universal/universal_types.hpp"

namespace modcal {
namespace {

enum SpecificData : int { kTime = 17, kFrequency = 18 };
enum FunctionType : int { kTimeResponse = 1 };
constexpr std::string_view kRateLine = "sample_rate: ";

std::string_view type_name(int type) {
  constexpr std::array<std::string_view, 8> kNames = {"general function",
                                                      "time response",
                                                      "auto spectrum",
                                                      "cross spectrum",
                                                      "frequency response function",
                                                      "transmissibility",
                                                      "coherence",
                                                      "auto correlation"};
  if (type == 9) return "power spectral density";
  return type >= 0 && type < 8 ? kNames[static_cast<std::size_t>(type)]
                               : "function of another type";
}

// The unit by its label; where there is none, SI with the factors of dataset 164.
void set_unit(const UniversalAxis& axis, const std::optional<UniversalUnits>& units,
              RecordedChannel& channel) {
  const Quantity* const stated = quantity_of_code(axis.code);
  const Quantity* const quantity = stated != nullptr ? stated : quantity_of_unit(axis.unit);
  if (quantity != nullptr) channel.kind = quantity->kind;
  channel.unit = axis.unit;
  if (!axis.unit.empty() || quantity == nullptr) return;
  channel.unit = quantity->unit;
  if (!units) return;
  const std::array<int, 3> powers = {quantity->length, quantity->force, quantity->temperature};
  for (std::size_t i = 0; i < 3; ++i) {
    channel.full_scale *= std::pow(units->factors[i], -powers[i]);
  }
}

// A file that modcal wrote has the rate to its last digit in its last ID line.
void set_rate(const UniversalFunction& function, StoredChannel& channel) {
  const double second =
      is_unit_of(function.abscissa.unit, "s") ? to_si(1.0, function.abscissa.unit, "s") : 1.0;
  if (function.is_even) channel.start = function.first * second;
  const std::string& id = function.id_lines[4];
  if (id.starts_with(kRateLine)) {
    const ParsedNumber stated = parse_number(std::string_view(id).substr(kRateLine.size()));
    const double off = stated.value * function.step * second - 1.0;
    if (stated.kind == NumberKind::kNumber && std::abs(off) <= 2 * function.step_resolution) {
      channel.sample_rate = stated.value;
      channel.rate_source = "ID line 5";
      return;
    }
  }
  if (!function.is_even || !(function.step > 0.0)) return;
  channel.sample_rate = rate_of_period(function.step * second, function.step_resolution);
  channel.rate_source = fmt::format("increment {:g} s", function.step * second);
}

// Text has six digits, floats have seven.
double resolution_of(const UniversalFunction& function) {
  if (!function.binary) return 1e-5;
  const bool is_single = !function.is_double || function.abscissa_is_single;
  return is_single ? static_cast<double>(std::numeric_limits<float>::epsilon())
                   : std::numeric_limits<double>::epsilon();
}

// SI factor of a force that is told by the factors of dataset 164 alone.
double force_factor(const UniversalAxis& axis, const std::optional<UniversalUnits>& units) {
  RecordedChannel force;
  UniversalAxis of_force = axis;
  if (axis.code == 0) of_force.code = quantity_of_unit("N")->code;
  set_unit(of_force, units, force);
  return axis.unit.empty() ? force.full_scale : 1.0;
}

// A file that modcal wrote has even lines to their last digit in its last ID line.
EvenLines lines_of(const UniversalFunction& function) {
  EvenLines stated;
  const bool is_ours = read_lines_text(function.id_lines[4], stated);
  const bool agrees =
      std::abs(stated.spacing() / function.step - 1.0) <= 2 * function.step_resolution &&
      std::abs(stated.begin() - function.first) <= 1e-5 * std::abs(function.first);
  return is_ours && agrees ? stated : printed_lines(function.first, function.step);
}

// SI where the factors of dataset 164 alone tell it; of a power its square, whose unit is not told.
void set_function_unit(const UniversalFunction& function,
                       const std::optional<UniversalUnits>& units, StoredChannel& channel) {
  if (channel.what == FrequencyFunction::kCoherence) {
    // A share, whatever its header says of what it is of.
    channel.head.unit.clear();
    channel.head.kind.clear();
    channel.head.full_scale = 1.0;
    return;
  }
  channel.per_unit = function.denominator.unit;
  if (channel.what == FrequencyFunction::kResponse) {
    channel.head.full_scale /= force_factor(function.denominator, units);
  } else {
    channel.head.unit = function.ordinate.unit;
    channel.head.full_scale *= channel.head.full_scale;
  }
}

// A function over frequency that is read; evenness of lines that stand one by one is told later.
void set_function(const std::filesystem::path& path, const UniversalFunction& function,
                  const std::optional<UniversalUnits>& units, StoredChannel& channel) {
  const std::optional<FrequencyFunction> what = what_of_type(function.type);
  const bool is_over_frequency =
      function.abscissa.code == kFrequency || function.abscissa.code <= 1;
  if (!what || !is_over_frequency) return;
  if (function.is_complex != (*what == FrequencyFunction::kResponse)) return;
  const std::string& unit = function.abscissa.unit;
  const double hertz = is_unit_of(unit, "Hz") ? to_si(1.0, unit, "Hz") : 1.0;
  channel.what = *what;
  channel.places = function.places;
  set_function_unit(function, units, channel);
  channel.read_response = [path, function] { return read_universal_values(path, function).values; };
  if (!function.is_even) {
    channel.read_lines = [path, function, hertz] {
      std::vector<double> lines = read_universal_values(path, function).abscissa;
      for (double& line : lines) line *= hertz;
      return lines;
    };
    return;
  }
  EvenLines even = lines_of(function);
  even.times *= hertz;
  channel.read_lines = [even, size = function.size] { return even.hertz(size); };
  const double before = even.begin() / even.spacing();
  if (even.step > 0.0 && before >= 0.0 && before < kMostLinesBefore &&
      std::abs(before - std::round(before)) < 1e-3) {
    channel.lines = even;
  }
}

StoredChannel stored(const std::filesystem::path& path, const UniversalFunction& function,
                     const std::optional<UniversalUnits>& units, const StopToken& stop) {
  StoredChannel channel;
  channel.head.name = function.name;
  set_unit(function.ordinate, units, channel.head);
  channel.size = function.size;
  channel.place = fmt::format("{}: dataset 58{} at line {}", path.string(),
                              function.binary ? "b" : "", function.header.line);
  const bool in_time = function.abscissa.code == kTime ||
                       (function.type == kTimeResponse && function.abscissa.code <= 1);
  if (!in_time || function.is_complex || function.size == 0) {
    channel.other_than_time = fmt::format(
        "{}{} with {} values over {}", function.is_complex ? "complex " : "",
        type_name(function.type), function.size,
        function.abscissa.label.empty() ? "another axis than time" : function.abscissa.label);
    set_function(path, function, units, channel);
    return channel;
  }
  set_rate(function, channel);
  channel.read = [path, function, stop] {
    std::vector<double> samples;
    samples.reserve(function.size);
    for (const auto& value : read_universal_values(path, function, stop).values) {
      samples.push_back(value.real());
    }
    return samples;
  };
  if (!function.is_even) {
    channel.read_times = [path, function, stop] {
      const auto& unit = function.abscissa.unit;
      std::vector<double> times = read_universal_values(path, function, stop).abscissa;
      for (double& time : times) time *= is_unit_of(unit, "s") ? to_si(1.0, unit, "s") : 1.0;
      return times;
    };
    channel.time_resolution = resolution_of(function);
    channel.times_name = channel.place;
  }
  return channel;
}

std::vector<StoredChannel> channels_of(const std::filesystem::path& path, const StopToken& stop) {
  const UniversalFile file = read_universal_headers(path);
  MODCAL_REQUIRE(
      !file.functions.empty(), "{}: no function (dataset 58) stands in it{}{}{}", path.string(),
      file.other_datasets.empty() ? "" : ", only datasets ", fmt::join(file.other_datasets, ", "),
      file.shapes.empty() ? "" : "; a table of modes reads its shapes (shapes: {file:})");
  std::vector<StoredChannel> channels;
  for (const UniversalFunction& function : file.functions) {
    channels.push_back(stored(path, function, file.units, stop));
  }
  return channels;
}

}  // namespace

Recording read_universal(const std::filesystem::path& path, const ReadOptions& options) {
  std::vector<StoredChannel> channels = channels_of(path, options.stop);
  std::string format = fmt::format("universal file, {} function{}", channels.size(),
                                   channels.size() == 1 ? "" : "s");
  return assemble(std::move(format), std::move(channels), options, path.string());
}

std::vector<StoredChannel> universal_functions(const std::filesystem::path& path) {
  std::vector<StoredChannel> channels = channels_of(path, {});
  for (StoredChannel& channel : channels) {
    if (!channel.read_response || channel.lines.step > 0.0) continue;
    const auto lines = std::make_shared<const std::vector<double>>(channel.read_lines());
    set_lines(lines, channel, std::exchange(channel.read_response, nullptr));
  }
  return channels;
}

}  // namespace modcal
