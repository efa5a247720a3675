#include "experiments/cli/plugin_kinds.hpp"

#include <array>

#include "experiments/config/reader.hpp"
#include "experiments/experiment.hpp"
#include "libcalib/objective.hpp"
#include "libcalib/optimizer.hpp"
#include "libinverse/estimator.hpp"
#include "libinverse/joint/force_prior.hpp"
#include "libinverse/spectral/choices/parameter_choice.hpp"
#include "libinverse/spectral/regularizers/regularizer.hpp"
#include "libsim/base/error.hpp"
#include "libsim/dynamics/friction/friction_law.hpp"
#include "libsim/dynamics/gestures/gesture.hpp"
#include "libsim/dynamics/scene/initial_motion.hpp"
#include "libsim/dynamics/scene/simulator.hpp"
#include "libsim/model/damping.hpp"

namespace modcal {
namespace {

template <typename Product>
std::unique_ptr<PluginSlot> slot_of() {
  return std::make_unique<Choice<Product>>();
}

template <typename Product>
constexpr PluginKind kind_of(std::string_view summary) {
  return {Product::kKind, summary, &slot_of<Product>};
}

}  // namespace

std::span<const PluginKind> plugin_kinds() {
  static constexpr std::array kKinds = {
      kind_of<DampingLaw>("modal damping of the string"),
      kind_of<Estimator>("what is estimated from which reactions"),
      kind_of<Experiment>("what a YAML file describes: its kind"),
      kind_of<ForcePrior>("what a joint estimate supposes about the force's spectrum"),
      kind_of<FrictionLaw>("friction between bow and string"),
      kind_of<Gesture>("how the bow's velocity or force changes with time"),
      kind_of<InitialMotion>("how the string moves at first"),
      kind_of<Objective>("what a calibration minimizes"),
      kind_of<Optimizer>("how a calibration minimizes it"),
      kind_of<ParameterChoice>("how much regularization suits the data"),
      kind_of<Regularizer>("what keeps noise from being amplified"),
      kind_of<Simulator>("how a scene is simulated"),
  };
  return kKinds;
}

const PluginKind& find_plugin_kind(std::string_view name) {
  std::vector<std::string> names;
  for (const PluginKind& kind : plugin_kinds()) {
    if (kind.name == name) return kind;
    names.emplace_back(kind.name);
  }
  throw_invalid_input("unknown kind of plug-in \"{}\"{}", name, suggestion(name, names));
}

}  // namespace modcal
