// The doubts that one force and several have in common.
#pragma once

#include <string>

#include "experiments/kinds/structure/force_doubts.hpp"

namespace modcal::force_doubts {

void reject(std::string why, StudyResult& result);
/// By its name.
void reject_sensor(const std::string& name, StudyResult& result);
/// kPeaked.
bool stands_in_peaks(const StructureForce& found);
/// A force that pushes one way; low: where the table's band begins [Hz].
void doubt_slow_part(const StructureForce& found, const LoadedStructureRecord& loaded, double low,
                     ForceShape stated, StudyResult& result);
/// Pulses where there are none.
void doubt_pulses(const StructureForce& found, ForceShape stated, StudyResult& result);
/// What was not tried, and what table and record do not tell.
void tell_unknowns(const StructureForce& found, const LoadedStructureRecord& loaded,
                   const StructureTable& modes, StudyResult& result);
/// A force behind the window.
void doubt_window(const StructureForce& found, const LoadedStructureRecord& loaded,
                  StudyResult& result);
/// What rang before the record.
void doubt_begin(const StructureForce& found, const LoadedStructureRecord& loaded,
                 const StructureTable& modes, StudyResult& result);

}  // namespace modcal::force_doubts
