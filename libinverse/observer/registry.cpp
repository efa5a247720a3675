// Every estimator: this library is the one that sees the linear ones and the simulator.
#include <array>

#include "libinverse/estimator.hpp"
#include "libinverse/joint/joint_estimators.hpp"
#include "libinverse/observer/auto_estimator.hpp"
#include "libinverse/spectral/one_sided/one_sided_inversion.hpp"

namespace modcal {

Registry<Estimator> Estimator::registry() {
  static constexpr std::array kTable = {
      entry_of<Estimator, AutoEstimator>(
          "auto", "joint and model_based, weighted by what the record says of the second"),
      entry_of<Estimator, JointEstimator>("joint", "one force from both reactions"),
      entry_of<Estimator, LinearLimitEstimator>(
          "linear_limit", "what no linear estimate beats: true spectra known (oracle)"),
      entry_of<Estimator, ModelBasedEstimator>(
          "model_based", "observer of both reactions with a fitted friction law"),
      entry_of<Estimator, OneSidedEstimator>("one_sided", "each reaction gives a force of its own"),
  };
  return kTable;
}

}  // namespace modcal
