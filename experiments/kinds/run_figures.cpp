// What is drawn of the runs of a list.
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "experiments/kinds/run_summary.hpp"
#include "libsim/base/units.hpp"

namespace modcal {
namespace {

// What a search started from and how its parameters hang together tell nothing of the axes.
bool is_answer(const std::string& name) {
  return !name.ends_with(".initial") && !name.starts_with("correlation");
}

// A cell that is added to a list has no value on some axes.
std::string shown(const std::string& value) { return value.empty() ? "as stated" : value; }

struct AxisNumber {
  double value = 0.0;
  std::string unit;
};

std::optional<AxisNumber> number_in(const std::string& text) {
  AxisNumber number;
  const char* last = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), last, number.value);
  if (error != std::errc()) return std::nullopt;
  number.unit.assign(end, last);
  number.unit.erase(0, number.unit.find_first_not_of(' '));
  return number;
}

// Of a pure number or one in another unit of the same dimension; nothing where the SI unit of a
// bare number is not known here.
std::optional<double> value_in(const AxisNumber& number, const std::string& unit) {
  if (number.unit == unit) return number.value;
  const auto scale = unit_scale(number.unit.empty() ? "1" : number.unit, unit.empty() ? "1" : unit);
  if (!scale) return std::nullopt;
  return scale->factor * number.value + scale->offset;
}

}  // namespace

std::vector<report::Table> RunSummary::maps() const {
  constexpr std::size_t kMostMaps = 6;
  std::vector<report::Table> maps;
  if (setting_axes_.size() != 2) return maps;
  for (const std::string& name : shown_first()) {
    report::Table map = this->map(name, maps.size() + 1);
    if (!map.rows.empty()) maps.push_back(std::move(map));
    if (maps.size() == kMostMaps) break;
  }
  return maps;
}

report::Figure RunSummary::figure() const {
  constexpr std::size_t kMostPanels = 6;
  report::Figure figure{.id = "against_axis", .title = "Results over the axes", .columns = 3};
  std::size_t differ = 0;
  for (std::size_t axis = 0; axis < setting_axes_.size() && differ == 0; ++axis) {
    std::string unit;
    const std::vector<double> x = numbers_of(axis, unit);
    if (x.empty()) continue;
    for (const std::string& name : shown_first()) {
      std::vector<report::Series> series = series_of(name, axis, x);
      if (series.empty() || ++differ > kMostPanels) continue;
      figure.panels.push_back({.x = {.label = axes_[setting_axes_[axis]], .unit = unit},
                               .y = {.label = name, .unit = unit_of(name)},
                               .series = std::move(series)});
    }
  }
  figure.caption = tasks_.size() > settings_.size()
                       ? "Median and band from 10 % to 90 % of the draws."
                       : "One draw of each setting.";
  if (differ > kMostPanels) {
    figure.caption += fmt::format(" The first {} of {} numbers that differ; all: settings.csv.",
                                  kMostPanels, differ);
  }
  return figure;
}

std::vector<std::string> RunSummary::shown_first() const {
  std::vector<std::string> names = names_;
  std::stable_partition(names.begin(), names.end(), is_answer);
  return names;
}

report::Tags RunSummary::tags_of(const Setting& setting, std::size_t except) const {
  report::Tags tags;
  for (std::size_t i = 0; i < setting.values.size(); ++i) {
    if (i != except) tags.push_back({axes_[setting_axes_[i]], {shown(setting.values[i])}});
  }
  return tags;
}

report::Table RunSummary::map(const std::string& name, std::size_t number) const {
  std::vector<std::string> rows, columns;
  std::map<std::pair<std::string, std::string>, double> medians;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  const auto note = [](std::vector<std::string>& list, const std::string& value) {
    if (std::ranges::count(list, value) == 0) list.push_back(value);
  };
  for (const Setting& setting : settings_) {
    const Sample& sample = sample_of(setting, name);
    const std::pair place = {shown(setting.values[0]), shown(setting.values[1])};
    note(rows, place.first);
    note(columns, place.second);
    if (sample.values.empty()) continue;
    const double median = medians[place] = sample.median();
    low = std::min(low, median);
    high = std::max(high, median);
  }
  const std::string title = report::Axis{.label = name, .unit = unit_of(name)}.text();
  const std::string& of_rows = axes_[setting_axes_[0]];
  report::Table table{
      .id = fmt::format("map_{}", number),
      .title = title,
      .caption = fmt::format("Medians; rows: {}, columns: {}.", of_rows, axes_[setting_axes_[1]])};
  if (!(low < high)) return table;
  // Decades would leave one cell dark.
  const bool by_decades = low > 0.0 && high > 100.0 * low;
  const auto place = [by_decades](double x) { return by_decades ? std::log(x) : x; };
  for (const std::string& row : rows) {
    report::add_row(table, [&](report::RowWriter& writer) {
      writer({.key = fmt::format("{} by {}", title, of_rows), .name = of_rows}, row);
      for (const std::string& column : columns) {
        const auto found = medians.find({row, column});
        report::Cell cell = found == medians.end() ? report::Cell() : found->second;
        if (found != medians.end()) {
          cell.heat = (place(found->second) - place(low)) / (place(high) - place(low));
        }
        writer.cell({.key = column}, std::move(cell));
      }
    });
  }
  return table;
}

std::vector<double> RunSummary::numbers_of(std::size_t axis, std::string& unit) const {
  std::vector<double> numbers;
  bool is_first = true;
  for (const Setting& setting : settings_) {
    const std::string& text = setting.values[axis];
    if (text.empty()) {
      numbers.push_back(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    const std::optional<AxisNumber> number = number_in(text);
    if (!number) return {};
    if (std::exchange(is_first, false)) unit = number->unit;
    const std::optional<double> value = value_in(*number, unit);
    if (!value) return {};
    numbers.push_back(*value);
  }
  return is_first ? std::vector<double>() : numbers;
}

std::vector<report::Series> RunSummary::series_of(const std::string& name, std::size_t axis,
                                                  const std::vector<double>& x) const {
  std::vector<report::Series> series;
  std::map<std::vector<std::string>, std::size_t> known;
  std::set<double> medians;
  for (std::size_t s = 0; s < settings_.size(); ++s) {
    const Sample& sample = sample_of(settings_[s], name);
    if (sample.values.empty() || std::isnan(x[s])) continue;
    std::vector<std::string> others = settings_[s].values;
    for (std::size_t i = 0; i < others.size(); ++i) {
      const std::string& path = axes_[setting_axes_[i]];
      others[i] = path.substr(path.rfind('.') + 1) + " " + shown(others[i]);
    }
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(axis));
    const auto [place, is_new] = known.try_emplace(others, series.size());
    if (is_new) {
      const auto color = std::min<std::size_t>(series.size() + 1, report::kColorRoles - 1);
      series.push_back(
          {.label = others.empty() ? "median" : fmt::format("{}", fmt::join(others, ", ")),
           .style = report::SeriesStyle::kLineWithPoints,
           .color = static_cast<report::ColorRole>(color),
           .tags = tags_of(settings_[s], axis)});
    }
    add_band(series[place->second], x[s], Spread::of(sample));
    medians.insert(sample.median());
  }
  if (medians.size() < 2) series.clear();
  return series;
}

}  // namespace modcal
