// What an identified force has to say of itself.
#pragma once

#include <optional>

#include "experiments/kinds/structure/refined_modes.hpp"
#include "experiments/kinds/structure/structure_files.hpp"
#include "experiments/report/report.hpp"
#include "libinverse/structure/contact_place.hpp"
#include "libinverse/structure/force/structure_force.hpp"
#include "libsim/base/result_visitor.hpp"

namespace modcal {

/// "impacts", and back.
std::string_view name_of(ForceShape shape);
ForceShape force_shape_of(std::string_view name);

/// Against the force that was measured, in the window.
struct ForceScore {
  double correlation = 0.0;
  double relative_error = 0.0;
  double in_band = 0.0;         // the same between the table's limits
  double coverage = 0.0;        // of the 95 % band
  double coverage_above = 0.0;  // the same of what lies above the table's lowest frequency
};

/// In the window of the force, between the limits of the table's band for `in_band`.
ForceScore score_of(const StructureForce& found, const std::vector<double>& measured, double rate,
                    const StructureTable& table);

/// The force at one contact.
struct ContactForce {
  std::string table;  ///< file of its modes
  StructureForce found;
  std::optional<ForceScore> score;
};

/// Of several contacts, what stands once is that of the first.
struct ForceOutcome {
  const LoadedStructureRecord& loaded;
  const std::vector<ContactForce>& forces;
  const std::string& left_out;  ///< name of the sensor that contradicts the others; empty: none
  const std::optional<RefinedModes>& refined;
  void visit(ResultVisitor& visitor) const;
};

/// Where the force acts.
struct PlacesOutcome {
  std::vector<std::string> tables;
  const ContactPlaces& where;
  void visit(ResultVisitor& visitor) const;
  std::string sentence() const;
};

/// A panel for each contact.
report::Figure force_figure(const LoadedStructureRecord& loaded,
                            const std::vector<ContactForce>& forces);

/// Index of the largest force where it is known as well as elsewhere: what a smooth one is at the
/// ends of the record is hardly told.
std::size_t told_peak(const StructureForce& found);

}  // namespace modcal
