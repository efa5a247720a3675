// Kind "identify": a plucked string, its modes with error bars.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "experiments/study/study.hpp"
#include "libcalib/parameters/stiff_string_fit.hpp"
#include "libinverse/modes/pluck_identification.hpp"
#include "libsim/signal/measurement.hpp"

namespace modcal {

struct IdentifyOptions {
  TruthOptions truth;
  Measurement measurement;
  PluckOptions identification;
  std::int64_t seed = 1;
  void visit(OptionVisitor& visitor);
};

struct IdentifyOutcome {
  PluckIdentification found;
  std::shared_ptr<const Truth> truth;
  /// Law through the frequencies, weighted by their deviations where they have some; empty with
  /// fewer than two modes.
  std::optional<StiffStringFit> law;
};

/// Simulates, measures and identifies.
IdentifyOutcome identify_outcome(const IdentifyOptions& options, const StudyContext& context);

/// Modes, law and noise as a JSON document.
std::string identification_json(const IdentifyOutcome& outcome);
report::Table identified_modes_table(const IdentifyOutcome& outcome, const std::string& command);
/// Poles over the order of the realization, stable ones apart.
report::Figure stabilization_figure(const IdentifyOutcome& outcome, const std::string& command);
/// Relative errors of the frequencies with their deviations, against the mode number.
report::Figure identified_errors_figure(const IdentifyOutcome& outcome, const std::string& command);

StudyResult identify_study(const IdentifyOptions& options, const StudyContext& context);

}  // namespace modcal
