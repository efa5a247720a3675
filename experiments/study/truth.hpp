// Simulated truth, computed once per distinct scene and shared by a whole sweep.
#pragma once

#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "libsim/dynamics/scene/simulator.hpp"
#include "libsim/model/modal_basis.hpp"

namespace modcal {

/// A simulated record with the model that made it.
struct Truth {
  ModalBasis basis;
  double contact = 0.0;  ///< x_c [m]
  Simulation simulation;
};

/// Scene and simulator as an experiment states them.
struct TruthOptions {
  Scene scene;
  Choice<Simulator> simulator{"newmark_explicit"};
};

/// Equal for equal truths: scene, simulator, rate and outputs, bit for bit.
std::string truth_key(TruthOptions options, double sample_rate, const OutputRequest& outputs);

/// Simulates, or waits for the thread that is simulating the same truth.
class TruthCache {
 public:
  TruthCache() = default;
  explicit TruthCache(const StopToken& stop) : stop_(stop) {}
  /// Throws InvalidInput where the scene cannot be simulated or the simulation diverges,
  /// Interrupted where the stop was requested.
  std::shared_ptr<const Truth> get(const TruthOptions& options, double sample_rate,
                                   const OutputRequest& outputs);
  /// Simulations done so far.
  std::size_t simulated() const;

 private:
  using Shared = std::shared_future<std::shared_ptr<const Truth>>;
  StopToken stop_;
  mutable std::mutex mutex_;
  std::map<std::string, Shared> truths_;
};

}  // namespace modcal
