#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "experiments/report/encoding.hpp"
#include "experiments/report/html_page.hpp"

namespace modcal::report {
namespace {

using Json = nlohmann::ordered_json;

// The script reads the bytes with typed arrays, which are little-endian wherever browsers run.
static_assert(std::endian::native == std::endian::little);
constexpr std::size_t kShortArray = 128;

template <typename Number>
std::string bytes_of(std::span<const double> values, double offset) {
  std::vector<unsigned char> bytes(values.size() * sizeof(Number));
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto number = static_cast<Number>(values[i] - offset);
    std::memcpy(&bytes[i * sizeof(Number)], &number, sizeof(Number));
  }
  return base64(bytes);
}

// float32 about `offset` holds the values: none overflows or falls below its normal numbers.
bool fits_float(std::span<const double> values, double offset) {
  return std::all_of(values.begin(), values.end(), [offset](double value) {
    const double size = std::abs(value - offset);
    return std::isnan(value) || size == 0.0 ||
           (size >= std::numeric_limits<float>::min() && size <= std::numeric_limits<float>::max());
  });
}

// Collects arrays so that equal ones are written once.
class ArrayPool {
 public:
  /// `exact`: short arrays keep every bit.
  std::size_t add(const std::vector<double>& values, double offset, bool exact = true) {
    Json array;
    if ((exact && values.size() <= kShortArray) || !fits_float(values, offset)) {
      array = {{"t", "f8"}, {"d", bytes_of<double>(values, 0.0)}};
    } else {
      array = {{"t", "f4"}, {"o", offset}, {"d", bytes_of<float>(values, offset)}};
    }
    const auto [place, is_new] = places_.try_emplace(array.dump(), arrays_.size());
    if (is_new) arrays_.push_back(std::move(array));
    return place->second;
  }
  Json take() { return std::move(arrays_); }

 private:
  Json arrays_ = Json::array();
  std::map<std::string, std::size_t> places_;
};

std::string_view style_name(SeriesStyle style) {
  static constexpr std::array<std::string_view, 4> kNames = {"line", "points", "line_with_points",
                                                             "dashed"};
  return kNames.at(static_cast<std::size_t>(style));
}

Json tags_json(const Tags& tags) {
  Json json = Json::object();
  for (const Tag& tag : tags) json[tag.facet] = tag.values;
  return json;
}

std::vector<double> reordered(const std::vector<double>& values,
                              const std::vector<std::size_t>& order) {
  std::vector<double> result;
  result.reserve(values.size());
  for (const std::size_t i : order) result.push_back(values[i]);
  return result;
}

// Places in ascending x of the samples in their own order: the path of a curve that turns back.
std::vector<double> path_through(const std::vector<std::size_t>& order) {
  std::vector<double> path(order.size());
  for (std::size_t place = 0; place < order.size(); ++place) {
    path[order[place]] = static_cast<double>(place);
  }
  return path;
}

Json series_json(const DrawnSeries& drawn, ArrayPool& pool) {
  const Series& series = *drawn.source;
  Json json = {{"label", series.label},
               {"style", style_name(series.style)},
               {"ink", ink_of(series.color).name},
               {"shape", ink_of(series.color).shape}};
  std::vector<std::size_t> order(drawn.x.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const bool ascending = std::is_sorted(drawn.x.begin(), drawn.x.end());
  if (!ascending) {
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return drawn.x[a] < drawn.x[b]; });
  }
  const double offset = drawn.x.empty() ? 0.0 : drawn.x[order.front()];
  const bool exact = !series.hidden;
  json["x"] = pool.add(reordered(drawn.x, order), offset, exact);
  json["y"] = pool.add(reordered(drawn.y, order), 0.0, exact);
  if (!drawn.low.empty()) {
    json["low"] = pool.add(reordered(drawn.low, order), 0.0, exact);
    json["high"] = pool.add(reordered(drawn.high, order), 0.0, exact);
  }
  // Whole numbers below 2^24 survive as float32.
  if (!drawn.tasks.empty()) json["task"] = pool.add(reordered(drawn.tasks, order), 0.0, false);
  if (!series.tags.empty()) json["tags"] = tags_json(series.tags);
  if (!ascending && series.style != SeriesStyle::kPoints) {
    json["path"] = pool.add(path_through(order), 0.0);
  }
  return json;
}

Json axis_json(const Axis& axis) {
  return {{"label", axis.label}, {"text", axis.text()}, {"log", axis.logarithmic}};
}

Json map_json(const CategoryMap& map, ArrayPool& pool) {
  Json categories = Json::array();
  for (const Category& category : map.categories) {
    categories.push_back({{"label", category.label}, {"ink", ink_of(category.color).name}});
  }
  return {{"x", pool.add(map.x_edges, map.x_edges.front())},
          {"y", pool.add(map.y_edges, map.y_edges.front())},
          {"cells", pool.add(std::vector<double>(map.cells.begin(), map.cells.end()), 0.0)},
          {"categories", std::move(categories)}};
}

Json panel_json(const DrawnPanel& drawn, ArrayPool& pool) {
  const Panel& panel = *drawn.source;
  Json json = {{"x", axis_json(panel.x)}, {"y", axis_json(panel.y)}};
  json["x"]["window"] = drawn.x_window;
  json["y"]["window"] = drawn.y_fixed ? Json(drawn.y_window) : Json();
  json["y"]["unit"] = panel.y.unit == "1" ? "" : panel.y.unit;
  json["x"]["unit"] = panel.x.unit == "1" ? "" : panel.x.unit;
  json["series"] = Json::array();
  for (const DrawnSeries& series : drawn.series) {
    if (series.has_values()) json["series"].push_back(series_json(series, pool));
  }
  if (panel.map) json["map"] = map_json(*panel.map, pool);
  json["markers"] = Json::array();
  for (const Marker& marker : panel.markers) {
    json["markers"].push_back({{"vertical", marker.direction == Marker::Direction::kVertical},
                               {"value", marker.value},
                               {"label", marker.label},
                               {"ink", ink_of(marker.color).name}});
  }
  return json;
}

}  // namespace

std::string chart_data_json(std::span<const DrawnFigure> figures, const std::string& replay) {
  ArrayPool pool;
  Json list = Json::array();
  for (const DrawnFigure& figure : figures) {
    Json panels = Json::array();
    for (const DrawnPanel& panel : figure.panels) panels.push_back(panel_json(panel, pool));
    list.push_back({{"id", figure.source->id}, {"panels", std::move(panels)}});
  }
  Json data = {{"arrays", pool.take()}, {"figures", std::move(list)}};
  if (!replay.empty()) data["replay"] = replay;
  std::string escaped;
  for (const char c : data.dump(-1, ' ', false, Json::error_handler_t::replace)) {
    if (c == '<') {
      escaped += "\\u003c";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

std::string tags_text(const Tags& tags) {
  return tags_json(tags).dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace modcal::report
