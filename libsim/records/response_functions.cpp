#include "libsim/records/response_functions.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>

#include "libsim/base/error.hpp"
#include "libsim/base/units.hpp"
#include "libsim/records/stored_channels.hpp"
#include "libsim/records/tuning.hpp"

namespace modcal {
namespace {

// "g/lbf" is an acceleration over a force, where a library of units has a mass over one.
std::pair<std::string, std::string> units_of_quotient(const std::string& unit) {
  const std::size_t stroke = unit.rfind('/');
  if (stroke == std::string::npos || !is_unit_of(unit.substr(stroke + 1), "N")) return {unit, {}};
  std::string response = unit.substr(0, stroke);
  if (response.starts_with('(') && response.ends_with(')')) {
    response = response.substr(1, response.size() - 2);
  }
  return {response, unit.substr(stroke + 1)};
}

ResponseFunction head_of(const StoredChannel& channel, const std::string& name) {
  const auto [unit, per_unit] = channel.per_unit.empty()
                                    ? units_of_quotient(channel.head.unit)
                                    : std::pair(channel.head.unit, channel.per_unit);
  return {.name = name,
          .kind = channel.head.kind,
          .unit = unit,
          .per_unit = per_unit,
          .full_scale = channel.head.full_scale,
          .values = {}};
}

// Whether the first one lies a whole number of steps from 0, to a hundredth.
bool is_even(std::span<const double> hertz, double step) {
  const double before = step > 0.0 ? std::round(hertz.front() / step) : -1.0;
  if (!(before >= 0.0 && before < kMostLinesBefore)) return false;
  for (std::size_t m = 0; m < hertz.size(); ++m) {
    if (!(std::abs(hertz[m] - (before + static_cast<double>(m)) * step) < 0.01 * step)) {
      return false;
    }
  }
  return true;
}

}  // namespace

std::string_view text_of(FrequencyFunction what) {
  constexpr std::array<std::string_view, 4> kTexts = {"response function", "coherence",
                                                      "auto spectrum", "power spectral density"};
  return kTexts[static_cast<std::size_t>(what)];
}

std::string FileFunction::whole_unit() const {
  if (per_unit.empty()) return unit;
  const bool is_quotient = unit.find('/') != std::string::npos;
  return is_quotient ? fmt::format("({})/{}", unit, per_unit)
                     : fmt::format("{}/{}", unit, per_unit);
}

void set_lines(const std::shared_ptr<const std::vector<double>>& hertz, StoredChannel& channel,
               std::function<std::vector<Complex>()> read) {
  const std::span<const double> lines = *hertz;
  const bool increase =
      lines.size() > 1 &&
      std::ranges::all_of(lines, [](double line) { return std::isfinite(line); }) &&
      std::ranges::adjacent_find(lines, std::greater_equal<>()) == lines.end();
  const double count = static_cast<double>(lines.size());
  const double step = increase ? (lines.back() - lines.front()) / (count - 1.0) : 0.0;
  if (!is_even(lines, step)) {
    channel.other_than_time = fmt::format("{} lines that are not even", lines.size());
  } else {
    const EvenLines nearly{.first = std::round(lines.front() / step) * step, .step = step};
    channel.lines = even_lines(lines).value_or(nearly);
  }
  if (!increase) return;
  channel.read_lines = [hertz] { return *hertz; };
  channel.read_response = std::move(read);
}

void set_multiples(double distance, StoredChannel& channel,
                   std::function<std::vector<Complex>()> read) {
  channel.lines = {.first = 0.0, .step = distance};
  channel.read_lines = [lines = channel.lines, size = channel.size] { return lines.hertz(size); };
  channel.read_response = std::move(read);
}

ResponseFunctions assemble_responses(const std::vector<StoredChannel>& stored,
                                     const std::vector<std::string>& channels,
                                     FrequencyFunction wanted, const std::string& file) {
  const std::vector<std::string> names = different_names(stored);
  const std::vector<std::size_t> chosen = find_channels(names, channels, file);
  ResponseFunctions result;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const StoredChannel& channel = stored[chosen[i]];
    if (!channel.read_response || channel.what != wanted || !(channel.lines.step > 0.0)) {
      throw WrongChannel(i,
                         fmt::format("{}: channel \"{}\" is no {} over even lines but has {}", file,
                                     names[chosen[i]], text_of(wanted), grid_text(channel)));
    }
    const StoredChannel& one = stored[chosen[0]];
    if (channel.size != one.size || channel.lines.begin() != one.lines.begin() ||
        channel.lines.spacing() != one.lines.spacing()) {
      throw WrongChannel(
          i, fmt::format("{}: channel \"{}\" has {} lines from {:g} Hz, {:g} Hz apart, \"{}\" has "
                         "{} from {:g} Hz, {:g} Hz apart: one model needs one grid",
                         file, names[chosen[i]], channel.size, channel.lines.begin(),
                         channel.lines.spacing(), names[chosen[0]], one.size, one.lines.begin(),
                         one.lines.spacing()));
    }
    const auto before = static_cast<std::size_t>(std::llround(one.lines.first / one.lines.step));
    std::vector<Complex> values(before, std::numeric_limits<double>::quiet_NaN());
    const std::vector<Complex> read = channel.read_response();
    values.insert(values.end(), read.begin(), read.end());
    result.grid = {.spacing = 2.0 * std::numbers::pi * one.lines.spacing(), .bins = values.size()};
    result.functions.push_back(head_of(channel, names[chosen[i]]));
    result.functions.back().values = std::move(values);
  }
  return result;
}

FileFunctions assemble_functions(const std::vector<StoredChannel>& stored,
                                 const std::string& file) {
  const std::vector<std::string> names = different_names(stored);
  FileFunctions result;
  for (std::size_t i = 0; i < stored.size(); ++i) {
    const StoredChannel& channel = stored[i];
    if (!channel.read_response) {
      result.warnings.push_back(fmt::format("{}: \"{}\" [{}] is left out: {}", file, names[i],
                                            channel.head.unit, grid_text(channel)));
      continue;
    }
    FileFunction& function = result.functions.emplace_back();
    static_cast<ResponseFunction&>(function) = head_of(channel, names[i]);
    function.what = channel.what;
    function.places = channel.places;
    function.hertz = channel.read_lines();
    function.values = channel.read_response();
    // Units that a file tells by factors alone are SI.
    const double scale = std::exchange(function.full_scale, 1.0);
    if (scale == 1.0) continue;
    for (Complex& value : function.values) value *= scale;
  }
  return result;
}

}  // namespace modcal
