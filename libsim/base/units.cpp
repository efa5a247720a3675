#include "libsim/base/units.hpp"

#include <udunits2.h>

#include <cmath>
#include <limits>
#include <memory>
#include <mutex>

#include "libsim/base/words.hpp"

namespace modcal {
namespace {

struct Deleter {
  void operator()(ut_system* system) const { ut_free_system(system); }
  void operator()(ut_unit* unit) const { ut_free(unit); }
  void operator()(cv_converter* converter) const { cv_free(converter); }
};
template <typename T>
using Owned = std::unique_ptr<T, Deleter>;

using UnitSystem = Owned<ut_system>;
using Unit = Owned<ut_unit>;
using Converter = Owned<cv_converter>;

std::mutex& library_mutex() {
  static std::mutex mutex;
  return mutex;
}

ut_system* unit_system() {
  static const UnitSystem system = [] {
    ut_set_error_message_handler(ut_ignore);
    return UnitSystem(ut_read_xml(nullptr));
  }();
  MODCAL_REQUIRE(system != nullptr,
                 "the unit database of UDUNITS-2 cannot be read; install libudunits2-data");
  return system.get();
}

// UDUNITS-2 also reads numbers ("20 m", "m 0.5") and time stamps ("s since 2000"). A digit is an
// exponent here (right behind a letter, a sign or another digit), or the 1 of "1/s".
bool is_plain_unit(std::string_view text) {
  if (text.empty()) return false;
  if (text.starts_with("1/")) text.remove_prefix(2);
  if (text == "1") return true;
  char previous = ' ';
  for (const char letter : text) {
    const bool digit = letter >= '0' && letter <= '9';
    if (digit && std::string_view(" */.(%").find(previous) != std::string_view::npos) return false;
    if (letter == '@' || letter == ',' || letter == '"') return false;
    previous = letter;
  }
  return true;
}

Unit parse(std::string_view text) {
  if (!is_plain_unit(text)) return nullptr;
  return Unit(ut_parse(unit_system(), std::string(text).c_str(), UT_UTF8));
}

bool has_angle(const ut_unit* unit) {
  std::array<char, 256> text{};
  const int length = ut_format(unit, text.data(), text.size() - 1, UT_ASCII | UT_DEFINITION);
  return length > 0 && std::string_view(text.data()).find("rad") != std::string_view::npos;
}

bool same_dimension(const Unit& from, const Unit& to) {
  const Unit ratio(ut_divide(from.get(), to.get()));
  return ratio && ut_is_dimensionless(ratio.get()) != 0 && !has_angle(ratio.get());
}

// Of two units of one name that of the dimension asked for: sensors of acceleration count in g.
Unit parse_towards(std::string_view text, const Unit& to) {
  static constexpr std::array<std::pair<std::string_view, const char*>, 1> kSecond = {
      {{"g", "gravity"}}};
  Unit unit = parse(text);
  for (const auto& [name, second] : kSecond) {
    if (name == text && to && unit && !same_dimension(unit, to)) return parse(second);
  }
  return unit;
}

std::optional<int> decimal_exponent(double factor) {
  if (!(factor > 0.0)) return std::nullopt;
  const double exponent = std::round(std::log10(factor));
  // UDUNITS-2 multiplies a few prefixes and definitions: some units in the last place.
  const double tolerance = 8 * std::numeric_limits<double>::epsilon();
  if (!(std::abs(exponent) <= 300) || std::abs(factor / std::pow(10.0, exponent) - 1) > tolerance) {
    return std::nullopt;
  }
  return static_cast<int>(exponent);
}

}  // namespace

bool is_unit(std::string_view unit) {
  const std::lock_guard lock(library_mutex());
  return parse(unit) != nullptr;
}

std::optional<UnitScale> unit_scale(std::string_view unit, std::string_view si_unit) {
  const std::lock_guard lock(library_mutex());
  const Unit to = parse(si_unit);
  const Unit from = parse_towards(unit, to);
  if (!from || !to || !same_dimension(from, to)) return std::nullopt;
  const Converter convert(ut_get_converter(from.get(), to.get()));
  if (!convert) return std::nullopt;
  UnitScale scale;
  scale.offset = cv_convert_double(convert.get(), 0.0);
  scale.factor = cv_convert_double(convert.get(), 1.0) - scale.offset;
  if (!std::isfinite(scale.factor) || !std::isfinite(scale.offset)) return std::nullopt;
  if (scale.offset == 0.0) scale.decimal_exponent = decimal_exponent(scale.factor);
  return scale;
}

bool is_unit_of(std::string_view unit, std::string_view si_unit) {
  return unit_scale(unit, si_unit).has_value();
}

double to_si(double value, std::string_view unit, std::string_view si_unit) {
  const auto scale = unit_scale(unit, si_unit);
  MODCAL_REQUIRE(scale.has_value(), "\"{}\" is not a unit that can be converted to {}", unit,
                 si_unit);
  return scale->factor * value + scale->offset;
}

std::string nearest_unit(std::string_view unit, std::string_view si_unit) {
  if (si_unit == "1") return nearest_name(unit, {"%"});
  std::vector<std::string> names = {std::string(si_unit)};
  for (const char* prefix : {"k", "m", "u", "c", "M", "G", "n"}) {
    names.push_back(std::string(prefix) + std::string(si_unit));
    if (!is_unit_of(names.back(), si_unit)) names.pop_back();
  }
  if (si_unit == "kg/m") names.emplace_back("g/m");
  if (si_unit == "kg") names.emplace_back("g");
  return nearest_name(unit, names);
}

std::string unit_example(std::string_view si_unit) {
  static constexpr std::array<std::pair<std::string_view, std::string_view>, 11> kExamples = {{
      {"1", "2 %"},
      {"m", "30 mm"},
      {"s", "1 us"},
      {"Hz", "51.2 kHz"},
      {"N", "0.98 N"},
      {"kg", "3 g"},
      {"kg/m", "3.1 g/m"},
      {"m/s", "0.1 m/s"},
      {"s/m", "5 s/m"},
      {"N/m", "1e5 N/m"},
      {"1/s", "200 1/s"},
  }};
  for (const auto& [unit, example] : kExamples) {
    if (unit == si_unit) return std::string(example);
  }
  return fmt::format("1 {}", si_unit);
}

}  // namespace modcal
