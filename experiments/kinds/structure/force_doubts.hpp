// What an identified force may be wrong by without its band holding it.
#pragma once

#include "experiments/kinds/structure/force_outcome.hpp"
#include "experiments/study/study.hpp"

namespace modcal {

/// Warns of what the sensors and the table cannot tell, and rejects a force that sensors
/// contradict, that rises out of its band, or that what rang before the record may be. `stated`:
/// the shape that was asked for.
void doubt_force(const StructureForce& found, const LoadedStructureRecord& loaded,
                 const StructureTable& modes, ForceShape stated, StudyResult& result);

/// The same of several contacts at once, each by its name. One at which no force is told is an
/// answer, if one is told at another.
void doubt_forces(const std::vector<ContactForce>& forces, const LoadedStructureRecord& loaded,
                  const std::vector<StructureTable>& contacts, ForceShape stated,
                  StudyResult& result);

}  // namespace modcal
