#include "libinverse/structure/force/structure_force.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>

#include "libinverse/structure/force/force_search.hpp"
#include "libinverse/structure/tuning.hpp"
#include "libsim/base/error.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

// Half a period of the mean spacing of modes, or of measured lines [s]; these may be far finer.
double half_a_spacing(const StructureTable& table) {
  if (!table.measured.empty()) {
    return std::min(std::numbers::pi / table.measured.grid.spacing,
                    kLongestSpacing / (table.high - table.low));
  }
  return 0.5 * static_cast<double>(table.model.poles.size()) / (table.high - table.low);
}

// Whether something strikes behind a share of a record: a response that only rings on, or is noise,
// is no larger there than in as much before.
bool is_struck_late(const StructureRecord& record, double share) {
  const auto end = static_cast<double>(record.samples());
  const auto seen = static_cast<std::size_t>(share * end);
  const auto before = static_cast<std::size_t>((2.0 * share - 1.0) * end);
  return std::ranges::any_of(record.responses, [&](std::span<const double> response) {
    return largest_magnitude(response.subspan(seen)) >
           kLate * largest_magnitude(response.subspan(before, seen - before));
  });
}

// Without one sensor, if the others agree by far better without it.
StructureForce found_in(const StructureTable& table, const StructureRecord& record,
                        const StructureForceOptions& options, bool may_leave_out) {
  ActingPart part = acting_part(table, record, options);
  const StructureRecord own = part.of(record);
  auto search = std::make_unique<ForceSearch>(table, own, options, part.duration);
  const std::optional<std::size_t> odd =
      may_leave_out ? search->odd_sensor() : std::optional<std::size_t>();
  if (odd) {
    StructureRecord others = record;
    others.responses.erase(others.responses.begin() + static_cast<std::ptrdiff_t>(*odd));
    StructureForce found = found_in(table.without_sensor(*odd), others, options, false);
    found.left_out = odd;
    return found;
  }
  // By modes that were refined the force may be seen to end earlier, and that part tells it better.
  if (search->refine(own) && std::isnan(options.window)) {
    const ActingPart shorter = acting_part(search->table(), record, options);
    if (shorter.duration < 0.9 * part.duration) {
      const StructureRecord earlier = shorter.of(record);
      auto again = std::make_unique<ForceSearch>(table, earlier, options, shorter.duration);
      if (again->refine(earlier)) part = shorter, search = std::move(again);
    }
  }
  StructureForce found = search->run();
  found.window += static_cast<double>(part.first) / record.sample_rate;
  found.weak_until = part.weak_until;
  found.force.insert(found.force.begin(), part.first, 0.0);
  for (std::vector<double>* of : {&found.deviation, &found.by_model}) {
    of->insert(of->begin(), part.first, of->front());
  }
  return found;
}

}  // namespace

StructureRecord ActingPart::of(const StructureRecord& record) const {
  StructureRecord part = record;
  const auto begin = static_cast<std::ptrdiff_t>(first);
  for (std::vector<double>& response : part.responses) {
    response.erase(response.begin(), response.begin() + begin);
  }
  if (!part.force.empty()) part.force.erase(part.force.begin(), part.force.begin() + begin);
  return part;
}

ActingPart acting_part(const StructureTable& table, const StructureRecord& record,
                       const StructureForceOptions& options) {
  if (!std::isnan(options.window)) return {.duration = options.window};
  ActingPart part{.first = static_cast<std::size_t>(options.quiet * record.sample_rate)};
  if (record.duration() - options.quiet < 4.0 * half_a_spacing(table)) part.first = 0;
  const StructureRecord own = part.of(record);
  part.duration = own.duration();
  // Behind this little is left of a record that is weighted as measured functions were.
  if (!table.measured.empty() && table.measured.grid.sigma > 0.0) {
    part.duration = std::min(part.duration, kSeenWeighted / table.measured.grid.sigma);
  }
  // Functions do not tell what the end cuts off.
  const double share = table.measured.empty() ? kSeen : kSeenByFunctions;
  if (is_struck_late(own, share)) return part;
  const double seen = share * part.duration;
  StructureForceOptions smooth = options;
  smooth.sigma = std::numeric_limits<double>::quiet_NaN();
  for (double next = 0.0;; part.duration = next) {
    const double loud = ForceSearch(table, own, smooth, part.duration).loud_until(seen);
    next = 1.25 * loud + half_a_spacing(table);
    if (next > 0.9 * part.duration) return part;
    part.weak_until = seen + static_cast<double>(part.first) / record.sample_rate;
  }
}

StructureForce structure_force(const StructureTable& table, const StructureRecord& record,
                               const StructureForceOptions& options) {
  MODCAL_REQUIRE(table.model.pairs() == record.responses.size(),
                 "the model has {} sensors, the record {}: name the channels of all of them",
                 table.model.pairs(), record.responses.size());
  return found_in(table, record, options, true);
}

}  // namespace modcal
