// Transfer functions of the string from the contact, with what modes alone leave out.
#pragma once

#include <array>
#include <vector>

#include "libinverse/record.hpp"
#include "libsim/model/transfer.hpp"

namespace modcal {

struct StringTransfer {
  std::vector<Complex> reaction[2];  ///< by End [N/N]
  std::vector<Complex> receptance;   ///< [m/N]
};

/// H_1, H_2 and the receptance at s_k of the grid; x_c in [0, L] [m]. Throws InvalidInput outside.
StringTransfer string_transfer(const ModalBasis& basis, double contact, const FrequencyGrid& grid,
                               const StringSupport& support, const SensorPair& sensors);

/// When the first wave from the contact arrives at either sensor, x_c/c and (L − x_c)/c with its
/// delay [s].
std::array<double, 2> first_arrivals(const ModalBasis& basis, double contact,
                                     const SensorPair& sensors);

}  // namespace modcal
