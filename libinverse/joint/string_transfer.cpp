#include "libinverse/joint/string_transfer.hpp"

#include <cmath>
#include <utility>

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

}  // namespace

StringTransfer string_transfer(const ModalBasis& basis, double contact, const FrequencyGrid& grid,
                               const StringSupport& support, const SensorPair& sensors) {
  std::vector<std::vector<Complex>> all = string_model(basis, contact, support).transfer(grid);
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
