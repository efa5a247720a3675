#include "libsim/dynamics/event/modes/bow_path.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "libsim/dynamics/event/modes/tuning.hpp"

namespace modcal::event {
namespace {

GridPoint grid_point(double time, double grid_step) {
  const double steps = time / grid_step;
  const double nearest = std::round(steps);
  if (std::abs(steps - nearest) <= kOnGrid) return {static_cast<std::uint64_t>(nearest), 0.0};
  const double whole = std::floor(steps);
  return {static_cast<std::uint64_t>(whole), steps - whole};
}

bool is_same(GridPoint a, GridPoint b) { return a.step == b.step && a.x == b.x; }

BowDrive drive_between(const BowKnot& from, const BowKnot& to) {
  const double span = to.time - from.time;
  return {from.velocity, (to.velocity - from.velocity) / span, from.load,
          (to.load - from.load) / span};
}

}  // namespace

std::vector<BowStretch> stretches_of(const std::vector<BowKnot>& knots, double grid_step) {
  assert(!knots.empty());
  std::vector<BowStretch> stretches;
  const auto add = [&](double time, const BowDrive& drive) {
    const GridPoint start = grid_point(std::max(time, 0.0), grid_step);
    // Two knots on one grid point: the later one holds from there on.
    if (!stretches.empty() && is_same(stretches.back().start, start)) stretches.pop_back();
    stretches.push_back({start, drive});
  };
  add(0.0, {knots.front().velocity, 0.0, knots.front().load, 0.0});
  for (std::size_t i = 0; i < knots.size(); ++i) {
    const bool last = i + 1 == knots.size();
    if (!last && knots[i + 1].time <= 0.0) continue;
    const BowDrive drive = last ? BowDrive{knots[i].velocity, 0.0, knots[i].load, 0.0}
                                : drive_between(knots[i], knots[i + 1]);
    add(knots[i].time, knots[i].time < 0.0 ? drive.from(-knots[i].time) : drive);
  }
  return stretches;
}

}  // namespace modcal::event
