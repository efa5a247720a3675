// What an identified force may be wrong by without its band holding it.
#pragma once

#include "experiments/kinds/structure/structure_files.hpp"
#include "experiments/study/study.hpp"
#include "libinverse/structure/force/structure_force.hpp"

namespace modcal {

/// Warns of what the sensors and the table cannot tell, and rejects a force that sensors
/// contradict, that rises out of its band, or that what rang before the record may be. `stated`:
/// the shape that was asked for.
void doubt_force(const StructureForce& found, const LoadedStructureRecord& loaded,
                 const StructureTable& modes, ForceShape stated, StudyResult& result);

}  // namespace modcal
