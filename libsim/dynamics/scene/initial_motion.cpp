#include "libsim/dynamics/scene/initial_motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

double sinc(double u) {
  const double angle = std::numbers::pi * u;
  return u == 0.0 ? 1.0 : std::sin(angle) / angle;
}

}  // namespace

void Pluck::Options::visit(OptionVisitor& visitor) {
  visitor.number({.key = "position",
                  .meaning = "plucking point, from the end x = 0",
                  .unit = "m",
                  .range = Range::positive(),
                  .required = true},
                 position);
  visitor.number(
      {.key = "displacement", .meaning = "height of the triangle", .unit = "m", .required = true},
      displacement);
  visitor.number({.key = "width",
                  .meaning = "width over which its corner is rounded",
                  .unit = "m",
                  .range = Range::non_negative()},
                 width);
}

ModalState Pluck::state(const ModalBasis& basis) const {
  const double length = basis.length, x = options_.position;
  MODCAL_REQUIRE(x > 0.0 && x < length,
                 "plucking point {:g} m is not inside the string: it must lie in (0, {:g}) m", x,
                 length);
  MODCAL_REQUIRE(std::isfinite(options_.displacement), "the pluck's displacement must be finite");
  const double room = 2.0 * std::min(x, length - x);
  MODCAL_REQUIRE(options_.width >= 0.0 && options_.width <= room,
                 "a pluck {:g} m wide at {:g} m reaches past the end of the string: at most {:g} m",
                 options_.width, x, room);
  const double scale = 2.0 * options_.displacement * length * length /
                       (std::numbers::pi * std::numbers::pi * x * (length - x));
  const std::vector<double> shape = basis.shape_at(x);
  ModalState state;
  state.velocity.assign(basis.size(), 0.0);
  for (std::size_t i = 0; i < basis.size(); ++i) {
    const double n = static_cast<double>(i + 1);
    state.displacement.push_back(scale * shape[i] * sinc(0.5 * n * options_.width / length) /
                                 (n * n));
  }
  return state;
}

Registry<InitialMotion> InitialMotion::registry() {
  static constexpr std::array kTable = {
      entry_of<InitialMotion, Pluck>("pluck", "released from a triangle"),
      entry_of<InitialMotion, Rest>("rest", "straight and at rest"),
  };
  return kTable;
}

}  // namespace modcal
