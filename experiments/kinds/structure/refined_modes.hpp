// What responses alone tell of the modes of a table, the force unknown.
#pragma once

#include "experiments/study/study.hpp"
#include "libinverse/structure/blind_fit.hpp"
#include "libsim/base/result_visitor.hpp"

namespace modcal {

struct RefinedModes {
  const StructureTable& table;  ///< before
  const BlindFit& fit;

  /// With the modes, their deviations and the modal constants that were found.
  StructureTable after() const;
  void visit(ResultVisitor& visitor) const;
  std::string sentence() const;
  /// f_n and ζ_n, for programs.
  void add_parameters(std::vector<FoundParameter>& parameters) const;
  /// What the responses say against the change that was stated, and which modes they do not tell.
  std::vector<std::string> doubts() const;
  /// Frequencies and damping ratios over those of the table, with 95 %.
  report::Figure figure() const;

 private:
  std::size_t modes() const { return table.model.poles.size(); }
};

}  // namespace modcal
