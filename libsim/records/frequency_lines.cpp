#include "libsim/records/frequency_lines.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "libsim/records/csv_grammar.hpp"

namespace modcal {
namespace {

bool gives(const EvenLines& even, std::span<const double> hertz) {
  for (std::size_t m = 0; m < hertz.size(); ++m) {
    if (even.line(m) != hertz[m]) return false;
  }
  return true;
}

}  // namespace

std::vector<double> EvenLines::hertz(std::size_t count) const {
  std::vector<double> lines(count);
  for (std::size_t m = 0; m < count; ++m) lines[m] = line(m);
  return lines;
}

EvenLines printed_lines(double first, double step) {
  // Powers of ten up to here are doubles.
  double per = 1.0;
  for (int digits = 0; digits <= std::numeric_limits<double>::digits10; ++digits, per *= 10.0) {
    const EvenLines whole{
        .first = std::nearbyint(first * per), .step = std::nearbyint(step * per), .per = per};
    if (whole.begin() == first && whole.spacing() == step) return whole;
  }
  return {.first = first, .step = step};
}

std::optional<EvenLines> even_lines(std::span<const double> hertz) {
  if (hertz.size() < 2) return std::nullopt;
  const double first = hertz.front();
  const double quotient = (hertz.back() - first) / static_cast<double>(hertz.size() - 1);
  if (!(quotient > 0.0) || !std::isfinite(quotient)) return std::nullopt;
  // The fewest digits first: a quotient of rounded lines may be off by its own last one.
  std::vector<double> steps;
  for (int digits = 0; digits < std::numeric_limits<double>::digits10; ++digits) {
    steps.push_back(parse_number(fmt::format("{:.{}e}", quotient, digits)).value);
  }
  for (const double towards : {quotient, 0.0, 2.0 * quotient}) {
    steps.push_back(std::nextafter(quotient, towards));
  }
  for (const double step : steps) {
    const EvenLines sums{.first = first, .step = step};
    const EvenLines multiples{.first = std::round(first / step), .step = 1.0, .times = step};
    for (const EvenLines& even : {printed_lines(first, step), sums, multiples}) {
      if (gives(even, hertz)) return even;
    }
  }
  return std::nullopt;
}

}  // namespace modcal
