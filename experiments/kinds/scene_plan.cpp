#include "experiments/kinds/scene_plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "libsim/dynamics/contact_modes.hpp"
#include "libsim/dynamics/simulator.hpp"

namespace modcal {

std::vector<std::string> plan_scene(const Scene& scene, double sample_rate,
                                    std::size_t simulations) {
  const ModalBasis basis = make_modal_basis(scene.string);
  const ContactModes moving = contact_modes(basis, scene.bow.position, {});
  const std::vector<double> shape = basis.shape_at(scene.bow.position);
  std::vector<std::size_t> blind;
  for (std::size_t n = 0; n < shape.size(); ++n) {
    if (is_node(shape[n])) blind.push_back(n + 1);
  }
  std::vector<std::string> lines;
  lines.push_back(fmt::format("simulations: {} of {:g} s, {} samples at {:g} Hz each", simulations,
                              scene.duration, sample_count(scene.duration, sample_rate),
                              sample_rate));
  lines.push_back(fmt::format("modes: {} of {} move", moving.size(), basis.size()));
  if (!blind.empty()) {
    lines.push_back(
        fmt::format("skipped: modes {}, which have a node at the contact: {:.0f} % of the "
                    "modal work",
                    fmt::join(blind, ", "),
                    100.0 * static_cast<double>(blind.size()) / static_cast<double>(basis.size())));
  }
  return lines;
}

}  // namespace modcal
