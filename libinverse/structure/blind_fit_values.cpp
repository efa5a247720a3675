// What a fit without the force tells, number by number.
#include <limits>

#include "libinverse/structure/blind_fit.hpp"
#include "libsim/base/error.hpp"

namespace modcal {

using Index = Eigen::Index;

double BlindFit::surprise(Index i) const {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  return told[i] > 0.5 ? change[i] / expected[i] : kNan;
}

std::vector<double> BlindFit::gains() const {
  const std::size_t sensors = model.sensors.size(), modes = model.poles.size();
  std::vector<double> gains(sensors, 0.0);
  if (change.size() == static_cast<Index>(2 * modes)) return gains;
  double mean = 0.0;
  for (std::size_t k = 0; k < sensors; ++k) {
    double weights = 0.0;
    for (std::size_t n = 0; n < modes; ++n) {
      const auto i = static_cast<Index>(2 * (modes + k * modes + n));
      const double weight = told[i] / (prior[i] * prior[i]);  // little near a node
      gains[k] += weight * change[i];
      weights += weight;
    }
    if (weights > 0.0) gains[k] /= weights;
    mean += gains[k] / static_cast<double>(sensors);
  }
  for (double& gain : gains) gain -= mean;
  return gains;
}

ModalModel BlindFit::drawn(std::span<const double> normal) const {
  MODCAL_REQUIRE(std::ssize(normal) == change.size(), "{} normal numbers for {} unknowns",
                 normal.size(), change.size());
  const Eigen::Map<const Eigen::VectorXd> standard(normal.data(), change.size());
  const Eigen::VectorXd step = root * standard;
  return moved_by(model, step);
}

}  // namespace modcal
