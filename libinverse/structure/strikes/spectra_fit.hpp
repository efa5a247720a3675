// Modes from the spectra of strikes, or from response functions, on a contour.
#pragma once

#include "libinverse/structure/strikes/close_pair.hpp"
#include "libinverse/structure/strikes/strike_fit.hpp"

namespace modcal {

/// The fit of fit_strikes(). records: of the forces; empty: of response functions, which have none.
/// late: of each strike, or of none.
StrikeFit fit_spectra(std::vector<StructureRecord> records, std::vector<ContourSpectra> spectra,
                      std::vector<LateStrike> late, const std::vector<SensorKind>& kinds,
                      const StrikeFitOptions& options);

}  // namespace modcal
