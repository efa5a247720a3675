// Rates by numbers that stand in a file as text.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "libsim/base/error.hpp"
#include "libsim/base/units.hpp"
#include "libsim/base/words.hpp"
#include "libsim/records/csv_grammar.hpp"
#include "libsim/records/tuning.hpp"

namespace modcal {
namespace {

constexpr double kEqual = 8 * std::numeric_limits<double>::epsilon();  // of a division

// 10, 20, 50, 100 Hz and so on are what a period of one digit is meant to tell.
bool is_round(double rate) {
  const double mantissa = rate / std::pow(10.0, std::floor(std::log10(rate)));
  return std::ranges::any_of(std::array{1.0, 2.0, 5.0, 10.0},
                             [mantissa](double x) { return std::abs(mantissa - x) < 1e-9; });
}

// Whether recorders have another rate [Hz] in the interval. Theirs are these numbers times powers
// of two: 51200 = 25 * 2^11, 48000 = 375 * 2^7, 102.4 = 0.1 * 2^10.
bool has_other_usual_rate(double low, double high, double rate) {
  constexpr std::array kBases = {0.1,   1.0,   5.0,    25.0,    125.0,
                                 375.0, 625.0, 3125.0, 11025.0, 15625.0};
  return std::ranges::any_of(kBases, [=](double base) {
    for (double usual = base; usual <= high; usual *= 2.0) {
      if (usual >= low && std::abs(usual / rate - 1.0) > kEqual) return true;
    }
    return false;
  });
}

}  // namespace

std::string too_coarse_text(std::string_view what, double resolution) {
  return fmt::format(
      "{} is printed to {:.3g} s, too coarsely to tell the sample rate; print it with more digits "
      "or state sample_rate",
      what, resolution);
}

double rate_of_period(double period, double resolution) {
  // Of a period that ends in a 5 behind the last digit printed rounding is all of the resolution.
  const double rate = 1.0 / period, whole = std::round(rate);
  const bool is_whole = whole > 0.0 && std::abs(rate - whole) <= 1.0001 * resolution * whole;
  return is_whole ? whole : rate;
}

PrintedRate rate_of_printed_period(std::string_view number, double value, std::string_view what,
                                   std::string_view unit) {
  PrintedDigits digits;
  digits.add(number);
  const double last = digits.resolution(value), off = 0.5 * last / value;
  const double second = to_si(1.0, unit, "s"), period = value * second;
  if (off <= 1.0001 * kCalibratedClock) return {rate_of_period(period, off), {}, off};
  const double rate = rate_of_period(period, kEqual);
  if (rate != std::round(rate)) {
    return {std::numeric_limits<double>::quiet_NaN(), too_coarse_text(what, last * second), off};
  }
  const double low = 1.0 / (period * (1.0 + off));
  const double high = 1.0 / (period * (1.0 - off));
  if (is_round(rate) && !has_other_usual_rate(low, high, rate)) return {rate, {}, off};
  return {rate,
          fmt::format("{} {} {} is printed to {:.3g} s, as all rates from {:.6g} to {:.6g} Hz are; "
                      "{:g} Hz are taken: state sample_rate where it is another one",
                      what, number, unit, last * second, low, high, rate),
          off};
}

bool is_name_of_rate(std::string_view name) {
  constexpr std::array<std::string_view, 9> kNames = {
      "sample_rate",     "samplerate",        "sampling_rate",
      "samplingrate",    "sample_frequency",  "sampling_frequency",
      "samplefrequency", "samplingfrequency", "fs"};
  return std::ranges::find(kNames, name) != kNames.end();
}

std::optional<PrintedRate> rate_in_comment(std::string_view text, const CsvFile& file) {
  const std::size_t mark = text.find_first_of(":=");
  if (mark == std::string_view::npos) return std::nullopt;
  const ColumnHeading heading = parse_heading(text.substr(0, mark));
  std::string key = lower_case(heading.name);
  std::replace(key.begin(), key.end(), ' ', '_');
  const bool is_period = key == "dt" || key == "delta_t";
  if (!is_period && !is_name_of_rate(key)) return std::nullopt;
  const ColumnHeading behind = parse_heading(text.substr(mark + 1));
  const std::string& value = behind.name;
  const std::string_view printed = std::string_view(value).substr(0, value.find(' '));
  const ParsedNumber number = parse_number(printed);
  std::string unit = parse_heading(std::string_view(value).substr(printed.size())).name;
  if (unit.empty()) unit = behind.unit;
  const bool is_one_unit = unit.empty() || heading.unit.empty() || unit == heading.unit;
  if (unit.empty()) unit = heading.unit;
  const std::string_view si = is_period ? "s" : "Hz";
  if (unit.empty()) unit = si;
  const bool usable = number.kind == NumberKind::kNumber && number.value > 0.0 && is_one_unit &&
                      is_unit_of(unit, si);
  // Other words may begin anybody's sentence.
  if (!usable && key != "sample_rate") return std::nullopt;
  MODCAL_REQUIRE(usable,
                 "{}:{}: \"{}\" is no sample rate; write a positive number of hertz, such as "
                 "# sample_rate: 51200 Hz",
                 file.name(), file.line(), trimmed(text.substr(mark + 1)));
  if (!is_period) return PrintedRate{to_si(number.value, unit, si), {}};
  const std::string what = fmt::format("the comment {} on line {}", heading.name, file.line());
  return rate_of_printed_period(printed, number.value, what, unit);
}

}  // namespace modcal
