#include "experiments/config/units.hpp"

#include <udunits2.h>

#include <memory>
#include <mutex>
#include <string>

#include "libsim/base/error.hpp"

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

Unit parse(std::string_view text) {
  return Unit(ut_parse(unit_system(), std::string(text).c_str(), UT_UTF8));
}

Converter converter(std::string_view unit, std::string_view si_unit) {
  const Unit from = unit.empty() ? nullptr : parse(unit);
  const Unit to = parse(si_unit);
  if (!from || !to) return nullptr;
  // UDUNITS also converts to the reciprocal dimension (s to Hz); that is not meant here.
  const Unit ratio(ut_divide(from.get(), to.get()));
  if (!ratio || ut_is_dimensionless(ratio.get()) == 0) return nullptr;
  return Converter(ut_get_converter(from.get(), to.get()));
}

}  // namespace

bool is_unit_of(std::string_view unit, std::string_view si_unit) {
  const std::lock_guard lock(library_mutex());
  return converter(unit, si_unit) != nullptr;
}

bool is_unit(std::string_view unit) {
  const std::lock_guard lock(library_mutex());
  return parse(unit) != nullptr;
}

double to_si(double value, std::string_view unit, std::string_view si_unit) {
  const std::lock_guard lock(library_mutex());
  const Converter convert = converter(unit, si_unit);
  MODCAL_REQUIRE(convert != nullptr, "\"{}\" is not a unit that can be converted to {}", unit,
                 si_unit);
  return cv_convert_double(convert.get(), value);
}

}  // namespace modcal
