#include "libinverse/joint/string_transfer.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "libinverse/joint/tuning.hpp"

namespace modcal {
namespace {

void read_by_sensor(const FrequencyGrid& grid, const Sensor& sensor,
                    std::vector<Complex>& transfer) {
  if (sensor.gain == 1.0 && sensor.delay == 0.0) return;
  const double magnitude = sensor.gain * std::exp(-grid.sigma * sensor.delay);
  for (std::size_t k = 0; k < transfer.size(); ++k) {
    transfer[k] *= std::polar(1.0, -grid.omega(k) * sensor.delay) * magnitude;
  }
}

// With the modes of the law above the last one up to this one [rad/s], as lossy as that.
ModalBasis with_law_beyond(ModalBasis basis, double highest) {
  if (basis.size() == 0) return basis;
  const double inharmonicity = inharmonicity_of(basis);
  const double density = 2.0 * basis.mass.back() / basis.length;
  const double unit = std::numbers::pi / basis.length * std::sqrt(basis.tension / density);
  for (std::size_t n = basis.size() + 1;; ++n) {
    const double omega = stiff_string_frequency(unit, inharmonicity, n);
    if (!(omega <= highest)) return basis;
    basis.omega.push_back(omega);
    basis.zeta.push_back(basis.zeta.back());
    basis.mass.push_back(basis.mass.back());
  }
}

}  // namespace

StringTransfer string_transfer(const ModalBasis& basis, double contact, const FrequencyGrid& grid,
                               const StringSupport& support, const SensorPair& sensors) {
  const double band = grid.spacing * static_cast<double>(grid.bins - 1);
  const ModalModel model =
      support.remainder ? string_model(with_law_beyond(basis, kModesApart * band), contact, support)
                        : string_model(basis, contact, support);
  std::vector<std::vector<Complex>> all = model.transfer(grid);
  StringTransfer transfer{{std::move(all[0]), std::move(all[1])}, std::move(all[2])};
  for (std::size_t r = 0; r < 2; ++r) {
    read_by_sensor(grid, sensors[r], transfer.reaction[r]);
  }
  return transfer;
}

std::array<double, 2> first_arrivals(const ModalBasis& basis, double contact,
                                     const SensorPair& sensors) {
  const double density = 2.0 * basis.mass.at(0) / basis.length;
  const double speed = std::sqrt(basis.tension / density);
  return {contact / speed + sensors[0].delay, (basis.length - contact) / speed + sensors[1].delay};
}

}  // namespace modcal
