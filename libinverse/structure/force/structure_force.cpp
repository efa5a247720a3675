#include "libinverse/structure/force/structure_force.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

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

// acting_part(), by what tells until when a force is loud in so much of a record, looked for until
// an instant.
using LoudUntil = std::function<double(const StructureRecord&, double duration, double seen)>;

ActingPart part_by(std::span<const StructureTable> tables, const StructureRecord& record,
                   const StructureForceOptions& options, const LoudUntil& loud_until) {
  if (!std::isnan(options.window)) return {.duration = options.window};
  double spacing = 0.0, sigma = 0.0, share = kSeen;
  for (const StructureTable& table : tables) {
    spacing = std::max(spacing, half_a_spacing(table));
    sigma = std::max(sigma, table.measured.grid.sigma);
    // Functions do not tell what the end cuts off.
    if (!table.measured.empty()) share = kSeenByFunctions;
  }
  ActingPart part{.first = static_cast<std::size_t>(options.quiet * record.sample_rate)};
  if (record.duration() - options.quiet < 4.0 * spacing) part.first = 0;
  const StructureRecord own = part.of(record);
  part.duration = own.duration();
  // Behind this little is left of a record that is weighted as measured functions were.
  if (sigma > 0.0) part.duration = std::min(part.duration, kSeenWeighted / sigma);
  if (is_struck_late(own, share)) return part;
  const double seen = share * part.duration;
  for (double next = 0.0;; part.duration = next) {
    next = 1.25 * loud_until(own, part.duration, seen) + spacing;
    if (next > 0.9 * part.duration) return part;
    part.weak_until = seen + static_cast<double>(part.first) / record.sample_rate;
  }
}

// Of a part, as of the whole record.
StructureForce from_the_start(StructureForce found, const ActingPart& part, double rate) {
  found.window += static_cast<double>(part.first) / rate;
  found.weak_until = part.weak_until;
  found.force.insert(found.force.begin(), part.first, 0.0);
  for (std::vector<double>* of : {&found.deviation, &found.by_model}) {
    of->insert(of->begin(), part.first, of->front());
  }
  return found;
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
  return from_the_start(search->run(), part, record.sample_rate);
}

// Forces at several contacts in a part of a record, their powers found from each other.
class ContactForces {
 public:
  ContactForces(const std::vector<StructureTable>& tables, const StructureRecord& own,
                const StructureForceOptions& options, double duration)
      : tables_(tables), own_(own), options_(options), duration_(duration) {
    // Powers are of one contour.
    if (std::isnan(options_.sigma)) {
      options_.sigma = 2.0 / duration;
      for (const StructureTable& table : tables) {
        options_.sigma = std::max(options_.sigma, table.measured.grid.sigma);
      }
    }
    // Alone each explains what all have done: more than it has, and the others take it back in
    // turn.
    std::vector<OtherContact> alone;
    for (std::size_t p = 0; p < tables.size(); ++p) alone.push_back({tables[p], at(p).power()});
    contacts_ = std::move(alone);
    for (int round = 0; round < kContactRounds; ++round) {
      for (std::size_t p = 0; p < tables.size(); ++p) contacts_[p].power = at(p).power();
    }
  }

  double loud_until(double seen) const {
    double last = 0.0;
    for (std::size_t p = 0; p < tables_.size(); ++p) last = std::max(last, at(p).loud_until(seen));
    return last;
  }

  std::vector<StructureForce> forces() const {
    std::vector<StructureForce> found;
    for (std::size_t p = 0; p < tables_.size(); ++p) found.push_back(at(p).run());
    return found;
  }

 private:
  ForceSearch at(std::size_t p) const {
    std::vector<OtherContact> others = contacts_;
    if (p < others.size()) others.erase(others.begin() + static_cast<std::ptrdiff_t>(p));
    return {tables_[p], own_, options_, duration_, others};
  }

  const std::vector<StructureTable>& tables_;
  const StructureRecord& own_;
  StructureForceOptions options_;
  double duration_;
  std::vector<OtherContact> contacts_;  // empty: each is taken to act alone
};

void require_sensors_of(const StructureTable& table, const StructureRecord& record) {
  MODCAL_REQUIRE(table.model.pairs() == record.responses.size(),
                 "the model has {} sensors, the record {}: name the channels of all of them",
                 table.model.pairs(), record.responses.size());
}

}  // namespace

void share_band(std::vector<StructureTable>& tables) {
  double low = 0.0, high = std::numeric_limits<double>::infinity();
  for (const StructureTable& table : tables) {
    low = std::max(low, table.low), high = std::min(high, table.high);
  }
  MODCAL_REQUIRE(low < high, "the tables of the contacts have no band in common");
  for (StructureTable& table : tables) table.low = low, table.high = high;
}

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
  StructureForceOptions smooth = options;
  smooth.sigma = std::numeric_limits<double>::quiet_NaN();
  return part_by({&table, 1}, record, options,
                 [&](const StructureRecord& own, double duration, double seen) {
                   return ForceSearch(table, own, smooth, duration).loud_until(seen);
                 });
}

StructureForce structure_force(const StructureTable& table, const StructureRecord& record,
                               const StructureForceOptions& options) {
  require_sensors_of(table, record);
  return found_in(table, record, options, true);
}

std::vector<StructureForce> structure_forces(std::vector<StructureTable> tables,
                                             const StructureRecord& record,
                                             const StructureForceOptions& options) {
  if (tables.size() == 1) return {structure_force(tables.front(), record, options)};
  for (const StructureTable& table : tables) require_sensors_of(table, record);
  MODCAL_REQUIRE(record.responses.size() > tables.size(),
                 "{} sensors read what forces at {} contacts explain whatever they read: name the "
                 "channels of one sensor more than contacts, or of several",
                 record.responses.size(), tables.size());
  share_band(tables);
  const ActingPart part = part_by(
      tables, record, options, [&](const StructureRecord& own, double duration, double seen) {
        StructureForceOptions smooth = options;
        smooth.sigma = std::numeric_limits<double>::quiet_NaN();
        return ContactForces(tables, own, smooth, duration).loud_until(seen);
      });
  const StructureRecord own = part.of(record);
  std::vector<StructureForce> found = ContactForces(tables, own, options, part.duration).forces();
  for (StructureForce& force : found) {
    force = from_the_start(std::move(force), part, record.sample_rate);
  }
  return found;
}

}  // namespace modcal
