// Models of a structure as its table allows them.
#pragma once

#include <cstdint>
#include <optional>

#include "libinverse/structure/blind_fit.hpp"

namespace modcal {

/// Draws from what is not known of a table: deviations of its poles and its sensors' scatter about
/// every mode, what a refinement has left unknown, or measured functions of a further session.
struct DrawnModels {
  const StructureTable& table;
  const std::optional<BlindFit>& refined;
  double contradiction = 1.0;  ///< times which the table's scatter has what the sensors show
  std::uint64_t seed = 1;

  Transfers at(std::size_t draw, const ContourSpectra& spectra) const;
  ModalModel modes(std::size_t draw) const;
};

}  // namespace modcal
