// Transfer functions of the string from the contact, with what modes alone leave out.
#pragma once

#include <string>
#include <vector>

#include "libinverse/record.hpp"
#include "libsim/base/options.hpp"
#include "libsim/model/transfer.hpp"

namespace modcal {

/// What a transfer function holds besides the stated modes.
struct TransferOptions {
  /// "on": modes above the highest stated one answer statically; "off": they do not exist, as in a
  /// simulated string of that many modes; "auto": on for recorded data.
  std::string static_remainder = "auto";
  /// The support feels T y_x − E I y_xxx instead of T y_x: g_rn times (1 + B n²).
  bool bending = false;

  void visit(OptionVisitor& visitor);
  /// `recorded`: the data are no simulation.
  StringSupport support(bool recorded) const {
    return {
        .static_remainder = static_remainder == "on" || (static_remainder == "auto" && recorded),
        .bending = bending};
  }
};

struct StringTransfer {
  std::vector<Complex> reaction[2];  ///< by End [N/N]
  std::vector<Complex> receptance;   ///< [m/N]
};

/// H_1, H_2 and the receptance at s_k of the grid; x_c in [0, L] [m]. Throws InvalidInput outside.
StringTransfer string_transfer(const ModalBasis& basis, double contact, const FrequencyGrid& grid,
                               const StringSupport& support, const SensorOptions& sensors);

}  // namespace modcal
