#include "libsim/records/quantities.hpp"

#include <algorithm>
#include <array>

#include "libsim/base/units.hpp"

namespace modcal {
namespace {

constexpr std::array<Quantity, 14> kQuantities = {{{"displacement", 8, "m", 1, 0, 0},
                                                   {"velocity", 11, "m/s", 1, 0, 0},
                                                   {"acceleration", 12, "m/s2", 1, 0, 0},
                                                   {"force", 9, "N", 0, 1, 0},
                                                   {"excitation force", 13, "N", 0, 1, 0},
                                                   {"pressure", 15, "Pa", -2, 1, 0},
                                                   {"stress", 2, "Pa", -2, 1, 0},
                                                   {"strain", 3, "1", 0, 0, 0},
                                                   {"temperature", 5, "K", 0, 0, 1},
                                                   {"moment", 14, "N m", 1, 1, 0},
                                                   {"mass", 16, "kg", -1, 1, 0},
                                                   {"time", 17, "s", 0, 0, 0},
                                                   {"frequency", 18, "Hz", 0, 0, 0},
                                                   {"order", 20, "1", 0, 0, 0}}};

}  // namespace

const Quantity* quantity_of_code(int code) {
  const auto found = std::find_if(kQuantities.begin(), kQuantities.end(),
                                  [code](const Quantity& known) { return known.code == code; });
  return found == kQuantities.end() ? nullptr : &*found;
}

const Quantity* quantity_of_kind(std::string_view kind) {
  const auto found = std::find_if(kQuantities.begin(), kQuantities.end(),
                                  [kind](const Quantity& known) { return known.kind == kind; });
  return found == kQuantities.end() ? nullptr : &*found;
}

const Quantity* quantity_of_unit(std::string_view unit) {
  if (unit.empty()) return nullptr;
  const auto found = std::find_if(
      kQuantities.begin(), kQuantities.end(),
      [unit](const Quantity& known) { return known.unit != "1" && is_unit_of(unit, known.unit); });
  return found == kQuantities.end() ? nullptr : &*found;
}

}  // namespace modcal
