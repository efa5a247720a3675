// What forces at several contacts at once may be wrong by.
#include <algorithm>
#include <cmath>

#include "experiments/kinds/structure/force_doubt_parts.hpp"
#include "libinverse/structure/tuning.hpp"

namespace modcal {

using namespace force_doubts;

namespace {

// Each contact sees the sensors by the errors of its own table. What they leave is noise or another
// contact, as a change of the structure is not looked for.
void doubt_sensors_of_all(const std::vector<ContactForce>& forces,
                          const LoadedStructureRecord& loaded, StudyResult& result) {
  const auto left = [&](const ContactForce& f) {
    return contradiction_of(f.found.sensor_left, forces.size());
  };
  const StructureForce& found = std::ranges::max_element(forces, {}, left)->found;
  const bool is_beyond = std::ranges::any_of(
      forces, [](const ContactForce& f) { return f.found.misfit > kBeyond * kBeyond; });
  const double power = contradiction_of(found.sensor_left, forces.size());
  if (!is_beyond || power < kContradictionOfContacts * kContradictionOfContacts) return;
  if (const std::optional<std::size_t> odd = odd_one_out(found.predicted)) {
    return reject_sensor(loaded.names[*odd], result);
  }
  const auto worst = std::ranges::max_element(found.sensor_left);
  reject(
      fmt::format("rejected: no forces at these {} contacts explain the responses together, {:.0f} "
                  "% of {} is left: compare the places of the contacts, order, sign and unit of "
                  "the channels with those of the tables; where that is the sensors' noise, "
                  "state its level as noise: of their sensors in the table",
                  forces.size(), 100.0 * *worst,
                  loaded.names[static_cast<std::size_t>(worst - found.sensor_left.begin())]),
      result);
}

bool is_told(const ContactForce& contact) {
  const StructureForce& found = contact.found;
  for (std::size_t j = 0; j < found.force.size(); ++j) {
    if (std::abs(found.force[j]) > kToldBeside * found.deviation[j]) return true;
  }
  return false;
}

// Blows at one contact and at another hide each other's pulses.
void doubt_peaks_beside(const StructureForce& found, ForceShape stated, StudyResult& result) {
  if (stated != ForceShape::kAuto || found.shape != ForceShape::kSmooth) return;
  if (found.untried > 0.0 || !stands_in_peaks(found)) return;
  reject(
      "rejected: the force stands in peaks, as one of blows, whose height a smooth force does not "
      "tell: state shape: impacts",
      result);
}

}  // namespace

void doubt_forces(const std::vector<ContactForce>& forces, const LoadedStructureRecord& loaded,
                  const std::vector<StructureTable>& contacts, ForceShape stated,
                  StudyResult& result) {
  const StructureForce& first = forces.front().found;
  if (forces.size() == 1) return doubt_force(first, loaded, contacts.front(), stated, result);
  for (std::size_t p = 0; p < forces.size(); ++p) {
    const StructureForce& found = forces[p].found;
    StudyResult own;
    if (!is_told(forces[p])) {
      own.warn("no force is told there beside the others: what its band holds may act");
    } else {
      doubt_slow_part(found, loaded, contacts[p].low, stated, own);
      tell_unknowns(found, loaded, contacts[p], own);
      doubt_peaks_beside(found, stated, own);
    }
    for (const std::string& text : own.warnings) {
      result.warn(fmt::format("{}: {}", forces[p].table, text));
    }
    if (own.status != report::Status::kFailed) continue;
    result.status = report::Status::kFailed;
    result.answer = fmt::format("{} ({})", own.answer, forces[p].table);
  }
  if (std::ranges::none_of(forces, is_told)) {
    reject(
        "rejected: no force is told at any of the contacts: the responses are noise, or forces "
        "below the tables' band, or the contacts are too alike for these sensors",
        result);
  }
  doubt_window(first, loaded, result);
  doubt_sensors_of_all(forces, loaded, result);
  const auto measured = std::ranges::find_if(
      contacts, [](const StructureTable& table) { return !table.measured.empty(); });
  doubt_begin(first, loaded, measured == contacts.end() ? contacts.front() : *measured, result);
}

}  // namespace modcal
