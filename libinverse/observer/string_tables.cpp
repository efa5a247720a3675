#include "libinverse/observer/string_tables.hpp"

#include "libsim/base/error.hpp"
#include "libsim/dynamics/fixed_step/fixed_step.hpp"
#include "libsim/dynamics/scene/contact_modes.hpp"

namespace modcal::observer {
namespace {

StepTable make_step_table(const ContactModes& modes, double step) {
  StepTable table;
  table.step = step;
  table.propagate = table.undo = PlanarVector(modes.size());
  std::vector<std::complex<double>> older, newer, deferred;
  for (std::size_t n = 0; n < modes.size(); ++n) {
    const ModeWeights weights = first_order_hold_weights(modes.pole[n], step);
    table.propagate.set(n, weights.propagate);
    table.undo.set(n, 1.0 / weights.propagate);
    older.push_back(modes.drive[n] * weights.older);
    newer.push_back(modes.drive[n] * weights.newer);
    deferred.push_back(weights.propagate * newer[n] + older[n]);
  }
  table.older = PlanarVector(older);
  table.newer = PlanarVector(newer);
  table.deferred = PlanarVector(deferred);
  table.older_response = motion_of(modes, older);
  table.newer_response = motion_of(modes, newer);
  table.deferred_response = motion_of(modes, deferred);
  return table;
}

}  // namespace

StringTables make_string_tables(const ModalBasis& basis, double contact, double sample_rate,
                                Substeps substeps) {
  MODCAL_REQUIRE(substeps.coarse >= 1 && substeps.fine >= 1,
                 "{} steps per sample, {} per step with a switch: at least one of each is needed",
                 substeps.coarse, substeps.fine);
  const ContactModes modes = contact_modes(basis, contact, {});
  StringTables tables;
  tables.substeps = substeps;
  const double step = 1.0 / (sample_rate * static_cast<double>(substeps.coarse));
  tables.coarse = make_step_table(modes, step);
  tables.fine = make_step_table(modes, step / static_cast<double>(substeps.fine));
  const std::vector<double> shape = basis.shape_at(contact);
  for (std::size_t n = 0; n < shape.size(); ++n) {
    if (is_node(shape[n])) continue;
    tables.mode.push_back(n);
    tables.shape.push_back(shape[n]);
  }
  tables.quadrature = padded(modes.quadrature);
  tables.compliance = padded(modes.compliance);
  // Of a string, whose reactions follow the displacement.
  const auto gains = [](const std::vector<std::complex<double>>& all) {
    return padded(all.size(), 0.0, [&all](std::size_t n) { return all[n].imag(); });
  };
  tables.gain[0] = gains(modes.left_gain);
  tables.gain[1] = gains(modes.right_gain);
  tables.effective_mass = modes.effective_mass();
  return tables;
}

}  // namespace modcal::observer
