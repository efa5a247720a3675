#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libsim/base/error.hpp"
#include "libsim/base/units.hpp"
#include "libsim/base/words.hpp"
#include "libsim/records/csv_grammar.hpp"
#include "libsim/records/recording.hpp"
#include "libsim/records/tuning.hpp"

namespace modcal {
namespace {

double median_step(std::span<const double> t) {
  std::vector<double> steps(t.size() - 1);
  for (std::size_t i = 0; i + 1 < t.size(); ++i) steps[i] = t[i + 1] - t[i];
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle;
}

void find_gaps(std::span<const double> t, double mean_step, double resolution, bool coarse,
               std::vector<TimeFinding>& findings) {
  const double nominal = median_step(t);
  if (nominal < 0.0) {
    findings.push_back({1,
                        fmt::format("time falls from {:.9g} s to {:.9g} s, and so in most rows: "
                                    "they stand in reverse; turn them around",
                                    t[0], t[1]),
                        true});
    return;
  }
  const double longest = kTimeGap * (nominal > 0.0 ? nominal : mean_step) + resolution;
  for (std::size_t i = 1; i < t.size() && findings.size() < Recording::kMaxProblems; ++i) {
    const double step = t[i] - t[i - 1];
    // Coarse printing makes neighbors equal.
    if (!(coarse ? step >= 0.0 : step > 0.0)) {
      findings.push_back({i,
                          fmt::format("time goes from {:.9g} s to {:.9g} s; sampling instants "
                                      "must increase: sort the rows of the file by time",
                                      t[i - 1], t[i]),
                          true});
    } else if (step > longest) {
      findings.push_back(
          {i,
           fmt::format("a gap of {:.6g} s before {:.9g} s where the steps are {:.6g} s; cut "
                       "what is before or behind the gap out of the file",
                       step, t[i], nominal),
           true});
    }
  }
}

void measure_jitter(std::span<const double> t, double step, TimeAxis& axis) {
  axis.jitter = 0.0;
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double deviation = std::abs(t[i] - t.front() - static_cast<double>(i) * step);
    if (deviation > axis.jitter) {
      axis.jitter = deviation;
      axis.jitter_sample = i;
    }
  }
}

// Of a division and of the difference of two instants.
constexpr double kRounding = 8 * std::numeric_limits<double>::epsilon();

double whole_within(double rate, double uncertainty) {
  const double whole = std::round(rate);
  return whole >= 1.0 && std::abs(rate - whole) <= uncertainty * rate ? whole : rate;
}

// One over the step in whole units of the printed resolution, where every instant is a multiple of
// it: a column 0.003, 0.006, 0.009 states its step, and its rate is no whole number of hertz. A
// step that was rounded to be printed is off by half a unit at the second or third instant, unless
// it is within half a unit over the number of instants. NaN: there is no such step.
double rate_of_decimal_step(std::span<const double> t, double step, double resolution,
                            double duration) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const double units = std::round(step / resolution), decimal = units * resolution;
  const double rounding = kRounding * std::max(std::abs(t.front()), std::abs(t.back()));
  // Doubles of all digits are multiples of anything.
  if (!(units >= 1.0) || resolution <= rounding) return kNone;
  for (std::size_t i = 0; i < t.size(); ++i) {
    if (std::abs(t[i] - t.front() - static_cast<double>(i) * decimal) > rounding) return kNone;
  }
  // Both are whole numbers then; their quotient is rounded once.
  const double per_second = whole_within(1.0 / resolution, kRounding);
  return whole_within(per_second / units, rounding / duration + kRounding);
}

// Whether instants that were printed to `resolution` lie on a grid of this rate: rounding moves
// them within one unit.
bool lie_on_grid(std::span<const double> t, double rate, double resolution) {
  double least = t[0], most = t[0];
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double origin = t[i] - static_cast<double>(i) / rate;
    least = std::min(least, origin);
    most = std::max(most, origin);
    if (most - least > resolution) return false;
  }
  return true;
}

// The whole number of hertz nearest to the mean rate on whose grid the instants lie. First and last
// instant alone leave room for several; those between them tell which.
double snapped_rate(std::span<const double> t, double step, double duration, double resolution) {
  const double rate = 1.0 / step, nearest = std::round(rate);
  const double most_off = (resolution / duration + kRounding) * rate;
  const double side = rate < nearest ? -1.0 : 1.0;
  // Nearest first, one side and the other in turn.
  for (int i = 0; i < kMostRatesTried; ++i) {
    const int away = (i + 1) / 2;
    const double whole = nearest + (i % 2 == 0 ? -side : side) * away;
    if (!(std::abs(whole - rate) <= most_off)) break;
    if (whole >= 1.0 && lie_on_grid(t, whole, resolution)) return whole;
  }
  return rate;
}

bool is_time_word(const std::string& text) {
  const std::string name = lower_case(text);
  return name == "t" || name == "time";
}

// Behind the name of a time S is a second, not a siemens.
std::string unit_of_time(const std::string& unit) {
  const std::string small = lower_case(unit);
  return !is_unit_of(unit, "s") && is_unit_of(small, "s") ? small : unit;
}

bool holds_instants(const ColumnHeading& heading) {
  return (heading.unit.empty() && is_time_word(heading.name)) || is_unit_of(heading.unit, "s");
}

}  // namespace

TimeAxis examine_time_axis(std::span<const double> t, double resolution) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  TimeAxis axis{kNaN, kNaN, 0, kNaN, false, {}};
  if (t.size() < 2) return axis;
  const double duration = t.back() - t.front();
  const double step = duration / static_cast<double>(t.size() - 1);
  if (!(step > 0.0)) {
    find_gaps(t, step, resolution, false, axis.findings);
    return axis;
  }
  measure_jitter(t, step, axis);
  axis.coarse = resolution > kCoarseTime * step && axis.jitter > kTimeJitter * step;
  find_gaps(t, step, resolution, axis.coarse, axis.findings);
  axis.coarse = axis.coarse && axis.findings.empty();
  if (axis.coarse) return axis;
  // Rounding of i Δt and of the differences; matters for instants far from zero.
  const double rounding = 4 * std::numeric_limits<double>::epsilon() *
                          std::max(std::abs(t.front()), std::abs(t.back()));
  axis.rate_error = (resolution + rounding + axis.jitter) / duration;
  axis.sample_rate = rate_of_decimal_step(t, step, resolution, duration);
  if (std::isnan(axis.sample_rate)) {
    axis.sample_rate = snapped_rate(t, step, duration, resolution + rounding);
  }
  if (axis.findings.empty() && axis.jitter > kTimeJitter * step + resolution + rounding) {
    axis.findings.push_back(
        {axis.jitter_sample,
         fmt::format("sampling is not uniform: {:.9g} s is {:.3g} s ({:.3g} sampling periods) off "
                     "the uniform grid; resample the record, or state sample_rate if its time "
                     "column is not to be trusted",
                     t[axis.jitter_sample], axis.jitter, axis.jitter / step)});
  }
  return axis;
}

namespace {

// A number behind a heading tells it from another one of the same text: "Time (s) 2".
ColumnHeading parse_numbered_heading(std::string_view text) {
  const std::size_t end = text.find_last_not_of("0123456789");
  const bool has_number = end != std::string_view::npos && end + 1 < text.size();
  const std::size_t bracket = has_number ? text.find_last_not_of(" ._", end) : text.npos;
  if (bracket == std::string_view::npos || (text[bracket] != ')' && text[bracket] != ']')) {
    return parse_heading(text);
  }
  ColumnHeading heading = parse_heading(text.substr(0, bracket + 1));
  if (!holds_instants(heading)) return parse_heading(text);
  heading.name += text.substr(bracket + 1);
  return heading;
}

}  // namespace

ColumnHeading parse_column_heading(std::string_view text) {
  ColumnHeading heading = parse_numbered_heading(trimmed(text));
  if (is_time_word(heading.name)) heading.unit = unit_of_time(heading.unit);
  constexpr const char* kMarks = "/_. ";
  const std::size_t mark = heading.name.find_first_of(kMarks);
  const std::size_t start = heading.name.find_first_not_of(kMarks, mark);
  if (!heading.unit.empty() || mark >= start || start == std::string::npos) return heading;
  const std::string name = heading.name.substr(0, mark);
  const std::string unit = unit_of_time(heading.name.substr(start));
  if (is_time_word(name) && is_unit_of(unit, "s")) return {name, unit};
  const std::size_t stroke = heading.name.rfind('/');
  if (stroke == std::string::npos || stroke == 0) return heading;
  const std::string force = heading.name.substr(stroke + 1);
  return is_unit_of(force, "N") ? ColumnHeading{heading.name.substr(0, stroke), force} : heading;
}

TimeColumns::TimeColumns(std::span<const ColumnHeading> headings) {
  for (std::size_t i = 0; i < headings.size(); ++i) {
    if (holds_instants(headings[i])) columns_.push_back(i);
  }
  stand_behind_ =
      !columns_.empty() && columns_.front() > 0 && columns_.back() + 1 == headings.size();
}

bool TimeColumns::contains(std::size_t column) const {
  return std::ranges::binary_search(columns_, column);
}

std::optional<std::size_t> TimeColumns::instants_of(std::size_t column) const {
  if (columns_.empty()) return std::nullopt;
  if (stand_behind_) return *std::ranges::lower_bound(columns_, column);
  const auto behind = std::ranges::upper_bound(columns_, column);
  return behind == columns_.begin() ? columns_.front() : *(behind - 1);
}

}  // namespace modcal
