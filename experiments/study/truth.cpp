#include "experiments/study/truth.hpp"

#include "experiments/study/fingerprint.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

std::shared_ptr<const Truth> simulate_truth(const TruthOptions& options, double sample_rate,
                                            const OutputRequest& outputs, const StopToken& stop) {
  auto truth = std::make_shared<Truth>();
  truth->basis = make_modal_basis(options.scene.string);
  truth->contact = options.scene.bow.position;
  truth->simulation = options.simulator.make()->simulate(options.scene, sample_rate, outputs, stop);
  MODCAL_REQUIRE(!truth->simulation.diverged_at,
                 "the simulation by {} diverges at {:g} s: use a smaller time step or modal_exact",
                 options.simulator.selected(), *truth->simulation.diverged_at);
  return truth;
}

}  // namespace

std::string truth_key(TruthOptions options, double sample_rate, const OutputRequest& outputs) {
  return fingerprint([&](OptionVisitor& visitor) {
    options.scene.visit(visitor);
    visitor.plugin({.key = "simulator", .meaning = ""}, options.simulator);
    visitor.number({.key = "sample_rate", .meaning = ""}, sample_rate);
    bool flags[] = {outputs.displacement, outputs.velocity, outputs.force, outputs.left_reaction,
                    outputs.right_reaction};
    for (bool& flag : flags) visitor.flag({.key = "output", .meaning = ""}, flag);
    double switches_from = outputs.switches_from;
    visitor.number({.key = "switches_from", .meaning = ""}, switches_from);
  });
}

std::shared_ptr<const Truth> TruthCache::get(const TruthOptions& options, double sample_rate,
                                             const OutputRequest& outputs) {
  const std::string key = truth_key(options, sample_rate, outputs);
  std::promise<std::shared_ptr<const Truth>> promise;
  Shared truth;
  bool is_mine = false;
  {
    const std::lock_guard lock(mutex_);
    const auto known = truths_.find(key);
    is_mine = known == truths_.end();
    truth = is_mine ? promise.get_future().share() : known->second;
    if (is_mine) truths_.emplace(key, truth);
  }
  if (is_mine) {
    try {
      promise.set_value(simulate_truth(options, sample_rate, outputs, stop_));
    } catch (...) {
      promise.set_exception(std::current_exception());
    }
  }
  return truth.get();
}

std::size_t TruthCache::simulated() const {
  const std::lock_guard lock(mutex_);
  return truths_.size();
}

}  // namespace modcal
