#include "libinverse/joint/string_transfer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

namespace modcal::string_transfer_test {
namespace {

ModalBasis string_of(std::int64_t modes) {
  return make_modal_basis({.length = 0.33,
                           .linear_density = 1e-3,
                           .fundamental = 294.0,
                           .inharmonicity = 1.1e-4,
                           .modes = modes});
}

// Modes above the last one bend reactions and receptance all over the band: a constant in their
// place is off by a hundred times as much and more.
TEST(StringTransfer, HoldsTheModesAboveTheLastOneUpToTheBandsEnd) {
  constexpr double kContact = 0.041;
  const FrequencyGrid grid = FrequencyGrid::of_record(4096, 51200.0);
  const ModalBasis few = string_of(60);
  for (const bool bending : {false, true}) {
    const StringTransfer all = string_transfer(string_of(1500), kContact, grid,
                                               {.remainder = true, .bending = bending}, {});
    const StringTransfer found =
        string_transfer(few, kContact, grid, {.remainder = true, .bending = bending}, {});
    const auto end = static_cast<std::size_t>(few.omega[56] / grid.spacing);
    for (std::size_t k = 1; k < end; ++k) {
      ASSERT_LT(std::abs(found.receptance[k] - all.receptance[k]),
                2e-5 * std::abs(all.receptance[0]));
      for (std::size_t r = 0; r < 2; ++r) {
        ASSERT_LT(std::abs(found.reaction[r][k] - all.reaction[r][k]), 2e-5) << k;
      }
    }
  }
}

}  // namespace
}  // namespace modcal::string_transfer_test
