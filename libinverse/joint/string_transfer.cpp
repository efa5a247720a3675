#include "libinverse/joint/string_transfer.hpp"

#include <cmath>
#include <utility>

namespace modcal {
namespace {

void read_by_sensor(const FrequencyGrid& grid, double gain, double delay,
                    std::vector<Complex>& transfer) {
  if (gain == 1.0 && delay == 0.0) return;
  const double magnitude = gain * std::exp(-grid.sigma * delay);
  for (std::size_t k = 0; k < transfer.size(); ++k) {
    transfer[k] *= std::polar(1.0, -grid.omega(k) * delay) * magnitude;
  }
}

}  // namespace

void TransferOptions::visit(OptionVisitor& visitor) {
  visitor.text({.key = "static_remainder",
                .meaning = "static response of the modes above the highest stated one; auto: for "
                           "recorded data",
                .choices = {"auto", "on", "off"}},
               static_remainder);
  visitor.flag({.key = "bending",
                .meaning = "the supports of a stiff string feel its bending too: reactions times "
                           "1 + B n^2 in mode n"},
               bending);
}

void SensorOptions::visit(OptionVisitor& visitor) {
  visitor.number(
      {.key = "gain1", .meaning = "gain of the sensor at x = 0", .range = Range::positive()},
      gain[0]);
  visitor.number(
      {.key = "gain2", .meaning = "gain of the sensor at x = L", .range = Range::positive()},
      gain[1]);
  visitor.number({.key = "delay1", .meaning = "delay of the channel of x = 0", .unit = "s"},
                 delay[0]);
  visitor.number({.key = "delay2", .meaning = "delay of the channel of x = L", .unit = "s"},
                 delay[1]);
}

StringTransfer string_transfer(const ModalBasis& basis, double contact, const FrequencyGrid& grid,
                               const StringSupport& support, const SensorOptions& sensors) {
  std::vector<std::vector<Complex>> all = string_model(basis, contact, support).transfer(grid);
  StringTransfer transfer{{std::move(all[0]), std::move(all[1])}, std::move(all[2])};
  for (std::size_t r = 0; r < 2; ++r) {
    read_by_sensor(grid, sensors.gain[r], sensors.delay[r], transfer.reaction[r]);
  }
  return transfer;
}

}  // namespace modcal
