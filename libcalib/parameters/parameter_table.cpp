#include "libcalib/parameters/parameter_table.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <vector>

#include "libcalib/parameters/stiff_string_fit.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

using std::numbers::pi;

double whole(double /*inharmonicity*/, double /*n*/) { return 1.0; }

double law_of(const ModelPoint& model, double StiffStringFit::*number) {
  return fit_stiff_string(frequencies_of(model.basis)).*number;
}

OptionInfo option(std::string_view key, std::string_view meaning, std::string_view unit,
                  const Range& range) {
  return {.key = key, .meaning = meaning, .unit = unit, .range = range};
}

// The row of a number of the sensor, but for what it is called and how far it goes.
template <std::size_t i>
ParameterType sensor_row(ParameterType row) {
  row.kind = ParameterKind::kSensor;
  row.index = i;
  row.moves = Moves::kSensor;
  row.may_be_own = true;
  row.range = [](ParameterRanges& ranges) -> double& { return ranges.sensors[i]; };
  row.at = [](ModelPoint& model, std::size_t) { return &(model.sensors.*Sensor::value_of(i)); };
  return row;
}

const ParameterType kTable[] = {
    {.kind = ParameterKind::kFundamental,
     .name = "f0",
     .unit = "Hz",
     .meaning = "fundamental of the string without its stiffness",
     .moves = Moves::kFrequencies,
     .logarithmic = true,
     .range_kind = RangeKind::kShare,
     .range_option =
         option("frequency_range", "how far f_n and f0 may move, relative to their initial values",
                "1", Range::open(0.0, 1.0)),
     .range = [](ParameterRanges& ranges) -> double& { return ranges.frequency; },
     .share = whole,
     .initial =
         [](const ModelPoint& model) { return law_of(model, &StiffStringFit::fundamental); }},
    {.kind = ParameterKind::kInharmonicity,
     .name = "B",
     .unit = "1",
     .meaning = "inharmonicity: f_n = n f_0 √(1 + B n²)",
     .moves = Moves::kFrequencies,
     .range_kind = RangeKind::kDistance,
     // The highest mode moves by 0.5 B N² of its frequency: a step of 1e-5 is sensible for any N up
     // to some hundred.
     .scale = 1e-5,
     .range_option = option("inharmonicity_range", "how far B may move", "1", Range::positive()),
     .range = [](ParameterRanges& ranges) -> double& { return ranges.inharmonicity; },
     .share = [](double b, double n) { return 0.5 * n * n / (1.0 + b * n * n); },
     .initial =
         [](const ModelPoint& model) { return law_of(model, &StiffStringFit::inharmonicity); }},
    {.kind = ParameterKind::kContact,
     .name = "x_c",
     .unit = "m",
     .meaning = "position of the bow",
     .moves = Moves::kContact,
     .may_be_own = true,
     .range_kind = RangeKind::kDistance,
     .range_option = option("contact_range", "how far x_c may move", "m", Range::positive()),
     .range = [](ParameterRanges& ranges) -> double& { return ranges.contact; },
     .at = [](ModelPoint& model, std::size_t) { return &model.contact; }},
    {.kind = ParameterKind::kFrequency,
     .name = "f_",
     .unit = "Hz",
     .meaning = "frequency of one mode",
     .moves = Moves::kFrequencies,
     .of_mode = true,
     .logarithmic = true,
     .per_unit = 2.0 * pi,
     .range_kind = RangeKind::kShare,
     .range = [](ParameterRanges& ranges) -> double& { return ranges.frequency; },
     .share = whole,
     .at = [](ModelPoint& model, std::size_t n) { return &model.basis.omega[n]; }},
    {.kind = ParameterKind::kDampingRatio,
     .name = "zeta_",
     .unit = "1",
     .meaning = "damping ratio of one mode",
     .moves = Moves::kDamping,
     .of_mode = true,
     .logarithmic = true,
     .range_kind = RangeKind::kShare,
     .range_option =
         option("damping_range",
                "how far zeta_n and their factor may move, relative to their initial values", "1",
                Range::open(0.0, 1.0)),
     .range = [](ParameterRanges& ranges) -> double& { return ranges.damping; },
     .share = whole,
     .at = [](ModelPoint& model, std::size_t n) { return &model.basis.zeta[n]; }},
    {.kind = ParameterKind::kDampingFactor,
     .name = "damping",
     .unit = "1",
     .meaning = "factor c of the damping ratios: ζ_n = c nᵖ ζ_n(initial)",
     .moves = Moves::kDamping,
     .logarithmic = true,
     .may_be_own = true,
     .range_kind = RangeKind::kShare,
     .range = [](ParameterRanges& ranges) -> double& { return ranges.damping; },
     .share = whole,
     .initial = [](const ModelPoint&) { return 1.0; }},
    {.kind = ParameterKind::kDampingPower,
     .name = "damping_power",
     .unit = "1",
     .meaning = "exponent p of the damping ratios: ζ_n = c nᵖ ζ_n(initial)",
     .moves = Moves::kDamping,
     .range_kind = RangeKind::kDistance,
     .scale = 0.1,
     .range_option =
         option("power_range", "how far the exponent of the mode number in zeta_n may move", "1",
                Range::positive()),
     .range = [](ParameterRanges& ranges) -> double& { return ranges.power; },
     .share = [](double, double n) { return std::log(n); },
     .initial = [](const ModelPoint&) { return 0.0; }},
    sensor_row<Sensor::kGain>(
        {.name = "gain",
         .unit = "1",
         .meaning = "gain of the sensor at x = L over that at x = 0",
         .logarithmic = true,
         .stated = Range::positive(),
         .farthest = 0.7,  // half the gain
         .digits = 5,
         .range_kind = RangeKind::kShare,
         .range_option =
             option("gain_range", "how far the gain may move, relative to its initial value", "1",
                    Range::open(0.0, 1.0))}),
    sensor_row<Sensor::kDelay>({.name = "delay",
                                .unit = "s",
                                .meaning = "delay of the sensor at x = L after that at x = 0",
                                .stated = Range::any(),
                                .farthest = 1e-2,
                                .digits = 4,
                                .range_kind = RangeKind::kDistance,
                                .range_option = option("delay_range", "how far the delay may move",
                                                       "s", Range::positive())}),
    // A corner below 0 is no filter, but a fit may pass there.
    sensor_row<Sensor::kCorner>(
        {.name = "corner",
         .unit = "Hz",
         .meaning = "corner of the high pass of the sensor at x = L",
         .per_unit = 2.0 * pi,
         .stated = Range::non_negative(),
         .farthest = 2.0 * pi * 50.0,
         .digits = 3,
         .range_kind = RangeKind::kRise,
         .range_option =
             option("corner_range", "how far the corner may rise", "Hz", Range::positive())})};

constexpr auto kFirstSensor = static_cast<std::size_t>(ParameterKind::kSensor);
static_assert(std::size(kTable) == kFirstSensor + Sensor::kCount, "the rows stand by their kind");

// A number >= 1 that is all of the text; 0 for other text.
std::size_t number_of(std::string_view text) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc{} && end == text.data() + text.size() ? number : 0;
}

}  // namespace

std::span<const ParameterType> parameter_table() { return kTable; }

const ParameterType& type_of(const ParameterName& name) {
  const bool sensor = name.kind == ParameterKind::kSensor;
  return kTable[static_cast<std::size_t>(name.kind) + (sensor ? name.index : 0)];
}

std::optional<ParameterName> parse_parameter(std::string_view text) {
  ParameterName name;
  if (const std::size_t space = text.rfind(' '); space != std::string_view::npos) {
    const std::size_t record = number_of(text.substr(space + 1));
    if (record == 0) return std::nullopt;
    name.record = record - 1;
    text = text.substr(0, space);
  }
  for (const ParameterType& type : kTable) {
    const std::size_t mode =
        type.of_mode && text.starts_with(type.name) ? number_of(text.substr(type.name.size())) : 0;
    if (type.of_mode ? mode == 0 : text != type.name) continue;
    name.kind = type.kind;
    name.index = type.of_mode ? mode - 1 : type.index;
    return name;
  }
  return std::nullopt;
}

ParameterName require_parameter(std::string_view text, std::size_t modes) {
  const std::optional<ParameterName> name = parse_parameter(text);
  const std::vector<std::string_view> sensors = sensor_names();
  MODCAL_REQUIRE(name && (!type_of(*name).of_mode || name->index < modes),
                 "unknown parameter \"{}\": state f0, B, x_c, f_1 ... f_{}, zeta_1 ... zeta_{}, "
                 "damping, damping_power, {} or {}",
                 text, modes, modes, fmt::join(sensors.begin(), sensors.end() - 1, ", "),
                 sensors.back());
  return *name;
}

std::string text_of(const ParameterName& name) {
  const ParameterType& type = type_of(name);
  std::string text(type.name);
  if (type.of_mode) text += std::to_string(name.index + 1);
  return name.record == 0 ? text : fmt::format("{} {}", text, name.record + 1);
}

double value_of(const ParameterName& name, const ModelPoint& model) {
  const ParameterType& type = type_of(name);
  if (!type.at) return type.initial(model);
  ModelPoint copy = model;
  return *type.at(copy, name.index) / type.per_unit;
}

double ParameterType::coordinate(double value) const {
  return logarithmic ? std::log(value) : per_unit * value;
}

double ParameterType::moved(double from, double change) const {
  return logarithmic ? from * std::exp(change) : from + change;
}

double ParameterType::change(double from, double to) const {
  return logarithmic ? std::log(to / from) : to - from;
}

std::string_view unit_of_parameter(std::string_view text) {
  const std::optional<ParameterName> name = parse_parameter(text);
  return name ? type_of(*name).unit : "1";
}

std::string_view meaning_of_parameter(std::string_view text) {
  const std::optional<ParameterName> name = parse_parameter(text);
  return name ? type_of(*name).meaning : "";
}

const ParameterType& sensor_type(std::size_t index) { return kTable[kFirstSensor + index]; }

double sensor_value(std::size_t index, const Sensor& sensor) {
  return sensor.*Sensor::value_of(index) / sensor_type(index).per_unit;
}

std::vector<std::string_view> sensor_names() {
  std::vector<std::string_view> names;
  for (std::size_t i = 0; i < Sensor::kCount; ++i) names.push_back(sensor_type(i).name);
  return names;
}

}  // namespace modcal
