#include "libinverse/observer/string_tables.hpp"

#include "libsim/base/error.hpp"
#include "libsim/dynamics/fixed_step/fixed_step.hpp"
#include "libsim/dynamics/scene/contact_modes.hpp"

namespace modcal::observer {
namespace {

AlignedVector padded(const std::vector<double>& values) {
  AlignedVector result(values.begin(), values.end());
  result.resize(padded_size(values.size()), 0.0);
  return result;
}

StepTable::Response response_of(const ContactModes& modes, const PlanarVector& state) {
  StepTable::Response sum;
  for (std::size_t n = 0; n < modes.size(); ++n) {
    sum.velocity += state.re[n] - modes.quadrature[n] * state.im[n];
    sum.displacement += modes.compliance[n] * state.im[n];
  }
  return sum;
}

StepTable make_step_table(const ContactModes& modes, double step) {
  StepTable table;
  table.step = step;
  for (PlanarVector* row :
       {&table.propagate, &table.undo, &table.older, &table.newer, &table.deferred}) {
    *row = PlanarVector(modes.size());
  }
  for (std::size_t n = 0; n < modes.size(); ++n) {
    const ModeWeights weights = first_order_hold_weights(modes.pole[n], step);
    const std::complex<double> older = modes.drive[n] * weights.older;
    const std::complex<double> newer = modes.drive[n] * weights.newer;
    table.propagate.set(n, weights.propagate);
    table.undo.set(n, 1.0 / weights.propagate);
    table.older.set(n, older);
    table.newer.set(n, newer);
    table.deferred.set(n, weights.propagate * newer + older);
  }
  table.older_response = response_of(modes, table.older);
  table.newer_response = response_of(modes, table.newer);
  table.deferred_response = response_of(modes, table.deferred);
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
  tables.left_gain = padded(modes.left_gain);
  tables.right_gain = padded(modes.right_gain);
  tables.effective_mass = modes.effective_mass();
  return tables;
}

}  // namespace modcal::observer
