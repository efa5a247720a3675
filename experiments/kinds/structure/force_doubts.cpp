#include "experiments/kinds/structure/force_doubts.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "experiments/kinds/structure/force_doubt_parts.hpp"
#include "libinverse/structure/tuning.hpp"
#include "libsim/records/levels.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace force_doubts {

void reject(std::string why, StudyResult& result) {
  result.status = report::Status::kFailed;
  result.warn(result.answer = std::move(why));
}

// What rang before the record is told by modes, and from the force by two sensors.
void doubt_begin(const StructureForce& found, const LoadedStructureRecord& loaded,
                 const StructureTable& modes, StudyResult& result) {
  std::string why;
  if (found.rang && loaded.kinds.size() == 1 && found.shape == ForceShape::kSmooth) {
    why =
        "rejected: the structure may ring when the record begins, and one sensor does not tell "
        "that from a smooth force: begin the record at rest, with a quiet part, or record a second "
        "sensor";
  }
  // Of what rings about a half stands above this share of its rms at any instant.
  constexpr double kBegins = 0.5;
  for (std::size_t k = 0; k < loaded.kinds.size() && !modes.measured.empty(); ++k) {
    const std::vector<double>& response = loaded.record.responses[k];
    const double first = response.front(), rms = measure_levels(response).rms;
    if (std::abs(first) < kBegins * rms) continue;
    why = fmt::format(
        "rejected: {} begins at {:.2g} times its rms, and response functions do not tell what rang "
        "before: begin the record at rest, or fit modes to the functions",
        loaded.names[k], std::abs(first) / rms);
    break;
  }
  if (!why.empty()) reject(std::move(why), result);
}

// A structure changes little; what would have to change it all is another one, or another place.
bool doubt_change(const StructureForce& found, const LoadedStructureRecord& loaded,
                  StudyResult& result) {
  if (!found.refined || !found.refined->allowed.is_found) return false;
  const StructureChange& change = found.refined->allowed;
  std::string what;
  const std::vector<double> gains = found.refined->gains();
  const auto farthest = std::ranges::max_element(gains, {}, [](double g) { return std::abs(g); });
  if (std::abs(*farthest) > kOtherGain) {
    what = fmt::format("{} reads {:.3g} times what the others tell",
                       loaded.names[static_cast<std::size_t>(farthest - gains.begin())],
                       1.0 + *farthest);
  } else if (change.is_at_bound(&StructureChange::residue)) {
    what = fmt::format("modal constants have changed by {:.2g} % and more", 100.0 * change.residue);
  } else if (change.is_at_bound(&StructureChange::frequency)) {
    what = fmt::format("frequencies have changed by {:.2g} % and more", 100.0 * change.frequency);
  } else {
    return false;
  }
  reject(fmt::format("rejected: no force explains the responses together, unless {}: compare "
                     "order, sign, gain, unit and delay of the channels and the place of the "
                     "contact with those of the table; where it is the structure, fit its modes "
                     "again",
                     what),
         result);
  return true;
}

void reject_sensor(const std::string& name, StudyResult& result) {
  reject(fmt::format("rejected: {} contradicts the other sensors, which agree without it: look for "
                     "a gap, a gain, a delay, another sign or noise in it",
                     name),
         result);
}

// Sensors that contradict each other refuse the answer.
void doubt_sensors(const StructureForce& found, const LoadedStructureRecord& loaded,
                   StudyResult& result) {
  if (found.told < 1.0) return;  // sensors that hear nothing contradict nobody
  if (doubt_change(found, loaded, result)) return;
  const auto worst = std::ranges::max_element(found.sensor_left);
  if (contradiction_of(found.sensor_left) < kContradiction * kContradiction) return;
  if (const std::optional<std::size_t> odd = odd_one_out(found.predicted)) {
    return reject_sensor(loaded.names[*odd], result);
  }
  const std::string& name =
      loaded.names[static_cast<std::size_t>(worst - found.sensor_left.begin())];
  // Of 18 records of another program that left more than a tenth, three of less than a fifth were
  // right; 14 of a quarter to .6 were of contacts elsewhere, or of a table that lacked a mode.
  // White noise of .4 of every sensor leaves .22.
  if (*worst < 0.25) {
    return result.warn(
        fmt::format("the sensors contradict each other, {:.0f} % of {} is left: the band holds "
                    "that as far as it is noise; a clock or a gap may be off by more",
                    100.0 * *worst, name));
  }
  reject(fmt::format("rejected: no force explains the responses together, {:.0f} % of {} is left: "
                     "where that is not their noise, compare order, sign and unit of the channels "
                     "and the place of the contact with those of the table",
                     100.0 * *worst, name),
         result);
}

// What was not tried, and what table and record do not tell.
void tell_unknowns(const StructureForce& found, const LoadedStructureRecord& loaded,
                   const StructureTable& modes, StudyResult& result) {
  if (found.told < 1.0) {
    reject(
        "rejected: the responses tell no force: they are no larger than the noise of the table's "
        "record; either none acted, or one below the table's band (low), or units and gains of the "
        "channels are not those of the table",
        result);
  }
  if (found.untried > 0.0 && stands_in_peaks(found)) {
    const double part = found.window * kMostInstants / found.untried;
    reject(
        fmt::format(
            "rejected: the force stands in peaks, as one of blows, whose height a smooth force "
            "does not tell: its window of {:.3g} s holds {:g} instants of a pulse, {:g} are "
            "possible; take the blows in parts: window: {:.2g} s, and for the next ones the same "
            "with record.start at a quiet instant behind it",
            found.window, found.untried, kMostInstants, 0.9 * part),
        result);
  } else if (found.untried > 0.0 && found.untried <= kMostInstants) {
    result.warn(fmt::format(
        "impacts were not tried: the window of {:g} s holds {:g} instants of a pulse, and the "
        "force does not stand in peaks; where it is one of impacts, state shape: impacts",
        found.window, found.untried));
  } else if (found.untried > 0.0) {
    result.warn(fmt::format(
        "impacts were not tried: the window of {:g} s holds {:g} instants of a pulse, {:g} are "
        "possible; where the force is one of impacts, state a shorter window",
        found.window, found.untried, kMostInstants));
  }
  if (found.shape == ForceShape::kImpacts && modes.pulse.empty()) {
    result.warn(fmt::format(
        "the table knows no pulse: the force is told up to {:g} Hz; a shorter pulse is higher and "
        "narrower than that. Modes that fit_modes makes of a strike know it",
        modes.high));
  }
  if (loaded.kinds.size() == 1) {
    result.warn(
        "one response explains any model: nothing tells whether the table is that of this "
        "structure; record a second sensor");
  }
}

// A force that goes on behind the window is no part of the answer, nor of its score. It shows in
// responses that are larger there, and in a force that was measured.
void doubt_window(const StructureForce& found, const LoadedStructureRecord& loaded,
                  StudyResult& result) {
  for (std::size_t k = 0; k < loaded.kinds.size(); ++k) {
    const std::span<const double> response = loaded.record.responses[k];
    const std::size_t end = std::min(found.force.size(), response.size());
    const double within = largest_magnitude(response.first(end));
    const double after = largest_magnitude(response.subspan(end));
    if (after <= kLate * within) continue;
    result.warn(fmt::format(
        "{} is {:.2g} times as large behind the window of {:.3g} s as in it: a force acts there, "
        "and what it leaves in the window is taken for an earlier one; state a longer window",
        loaded.names[k], after / within, found.window));
    break;
  }
  const std::vector<double>& measured = loaded.record.force;
  if (measured.size() <= found.force.size()) return;
  const auto by_size = [](double force) { return std::abs(force); };
  const auto end = measured.begin() + static_cast<std::ptrdiff_t>(found.force.size());
  const auto behind = std::ranges::max_element(end, measured.end(), {}, by_size);
  const double peak = by_size(*std::ranges::max_element(measured, {}, by_size));
  if (by_size(*behind) <= kLoud * peak) return;
  result.warn(fmt::format(
      "the measured force is {:.4g} N at {:.4g} s, {:.0f} % of its peak and behind the window of "
      "{:.3g} s: neither the answer nor its error holds that; state a window that does",
      *behind, static_cast<double>(behind - measured.begin()) / loaded.record.sample_rate,
      100.0 * by_size(*behind) / peak, found.window));
}

}  // namespace force_doubts

void doubt_force(const StructureForce& found, const LoadedStructureRecord& loaded,
                 const StructureTable& modes, ForceShape stated, StudyResult& result) {
  using namespace force_doubts;
  doubt_slow_part(found, loaded, modes.low, stated, result);
  doubt_pulses(found, stated, result);
  doubt_window(found, loaded, result);
  tell_unknowns(found, loaded, modes, result);
  if (loaded.kinds.size() > 1) doubt_sensors(found, loaded, result);
  // Names the cause where sensors contradict each other by it: its answer stands.
  doubt_begin(found, loaded, modes, result);
}

}  // namespace modcal
