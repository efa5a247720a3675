#include "libinverse/structure/force/drawn_models.hpp"

#include <algorithm>
#include <cmath>

#include "libsim/base/random.hpp"

namespace modcal {

Transfers DrawnModels::at(std::size_t draw, const ContourSpectra& spectra) const {
  if (!table.measured.empty()) {
    return table.measured.drawn(spectra, std::sqrt(contradiction), seed, draw);
  }
  return transfers_of(modes(draw), spectra);
}

ModalModel DrawnModels::modes(std::size_t draw) const {
  if (refined) {
    std::vector<double> normal(static_cast<std::size_t>(refined->change.size()));
    fill_standard_normal(StreamKey(seed).with("model").with(draw), normal);
    return refined->drawn(normal);
  }
  ModalModel model = table.model;
  const std::size_t modes = model.poles.size(), pairs = model.pairs();
  std::vector<double> normal(2 * modes + 2 * modes * pairs);
  fill_standard_normal(StreamKey(seed).with("model").with(draw), normal);
  for (std::size_t n = 0; n < modes; ++n) {
    // A mode that nothing tells has deviations of any size: by a factor of e it is elsewhere.
    const auto factor = [n, &normal](const std::vector<double>& deviations, std::size_t first) {
      if (deviations.empty()) return 1.0;
      return std::exp(std::clamp(deviations[n], 0.0, 1.0) * normal[first + n]);
    };
    model.poles[n].omega *= factor(table.frequency_deviations, 0);
    model.poles[n].zeta *= factor(table.damping_deviations, modes);
  }
  model.quadrature.resize(model.constants.size());
  for (std::size_t pair = 0; pair < pairs; ++pair) {
    // Half of a complex number's power each.
    const double scatter =
        std::sqrt(0.5 * contradiction) * table.scatters[pair / model.contacts].modal;
    for (std::size_t i = pair * modes; i < (pair + 1) * modes; ++i) {
      const Complex factor(1.0 + scatter * normal[2 * modes + 2 * i],
                           scatter * normal[2 * modes + 2 * i + 1]);
      const Complex constant = factor * Complex(model.constants[i], model.quadrature[i]);
      model.constants[i] = constant.real();
      model.quadrature[i] = constant.imag();
    }
  }
  return model;
}

}  // namespace modcal
