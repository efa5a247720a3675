#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libsim/base/error.hpp"
#include "libsim/base/units.hpp"
#include "libsim/base/words.hpp"
#include "libsim/records/csv_grammar.hpp"

namespace modcal {
namespace {

constexpr double kGap = 1.5;           // median steps
constexpr double kJitter = 0.01;       // steps
constexpr double kCoarse = 0.25;       // steps; beyond, a missing sample cannot be told
constexpr std::size_t kFindings = 10;  // enough to see what is wrong

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
  const double longest = kGap * (nominal > 0.0 ? nominal : mean_step) + resolution;
  for (std::size_t i = 1; i < t.size() && findings.size() < kFindings; ++i) {
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

double snapped_rate(double step, double duration, double resolution) {
  const double rate = 1.0 / step;
  const double whole = std::round(rate);
  const double uncertainty = resolution / duration + 8 * std::numeric_limits<double>::epsilon();
  return whole >= 1.0 && std::abs(rate - whole) <= uncertainty * rate ? whole : rate;
}

bool holds_instants(const ColumnHeading& heading) {
  const std::string name = lower_case(heading.name);
  return (heading.unit.empty() && (name == "t" || name == "time")) || is_unit_of(heading.unit, "s");
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
  axis.coarse = resolution > kCoarse * step && axis.jitter > kJitter * step;
  find_gaps(t, step, resolution, axis.coarse, axis.findings);
  axis.coarse = axis.coarse && axis.findings.empty();
  if (axis.coarse) return axis;
  // Rounding of i Δt and of the differences; matters for instants far from zero.
  const double rounding = 4 * std::numeric_limits<double>::epsilon() *
                          std::max(std::abs(t.front()), std::abs(t.back()));
  axis.rate_error = (resolution + rounding + axis.jitter) / duration;
  axis.sample_rate = snapped_rate(step, duration, resolution + rounding);
  if (axis.findings.empty() && axis.jitter > kJitter * step + resolution + rounding) {
    axis.findings.push_back(
        {axis.jitter_sample,
         fmt::format("sampling is not uniform: {:.9g} s is {:.3g} s ({:.3g} sampling periods) off "
                     "the uniform grid; resample the record, or state sample_rate if its time "
                     "column is not to be trusted",
                     t[axis.jitter_sample], axis.jitter, axis.jitter / step)});
  }
  return axis;
}

ColumnHeading parse_column_heading(std::string_view text) {
  ColumnHeading heading = parse_heading(text);
  constexpr const char* kMarks = "/_. ";
  const std::size_t mark = heading.name.find_first_of(kMarks);
  const std::size_t start = heading.name.find_first_not_of(kMarks, mark);
  if (!heading.unit.empty() || mark >= start || start == std::string::npos) return heading;
  const std::string name = lower_case(heading.name.substr(0, mark));
  const std::string unit = heading.name.substr(start);
  const bool has_time = (name == "t" || name == "time") && is_unit_of(unit, "s");
  if (has_time) return {heading.name.substr(0, mark), unit};
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

std::optional<double> rate_in_comment(std::string_view text, const CsvFile& file) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) return std::nullopt;
  std::string key = lower_case(parse_heading(text.substr(0, colon)).name);
  std::replace(key.begin(), key.end(), ' ', '_');
  if (key != "sample_rate") return std::nullopt;
  const std::string value = parse_heading(text.substr(colon + 1)).name;
  const std::size_t number_end = std::min(value.find(' '), value.size());
  const ParsedNumber number = parse_number(std::string_view(value).substr(0, number_end));
  const std::string unit = parse_heading(std::string_view(value).substr(number_end)).name;
  const bool usable = number.kind == NumberKind::kNumber && number.value > 0.0 &&
                      (unit.empty() || is_unit_of(unit, "Hz"));
  MODCAL_REQUIRE(usable,
                 "{}:{}: \"{}\" is no sample rate; write a positive number of hertz, such as "
                 "# sample_rate: 51200 Hz",
                 file.name(), file.line(), value);
  return unit.empty() ? number.value : to_si(number.value, unit, "Hz");
}

}  // namespace modcal
