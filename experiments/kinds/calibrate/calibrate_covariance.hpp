// Covariance of what a continuation found: text, table, JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "experiments/report/table.hpp"
#include "libcalib/optimizers/staged/continuation.hpp"

namespace modcal {

struct CalibrationOutcome;
struct StudyResult;

/// {"names", "units", "sd", "correlations" (P rows of P), "singular_values", "condition"}, see
/// NamedCovariance; null for what is not finite.
nlohmann::ordered_json covariance_json(const NamedCovariance& covariance);

/// The law's parameters with correlations and condition number, as `modcal limit` has them; where
/// every frequency is free the strongest correlations of what the data identify, too.
std::string covariance_text(const ContinuationResult& found);

/// The strongest correlations of the law and of all that is free.
report::Table correlation_table(const ContinuationResult& found, const std::string& command);

/// Both into a study of a continuation; nothing of a search by objective and optimizer.
void add_covariance(const CalibrationOutcome& outcome, const std::string& command,
                    StudyResult& result);

}  // namespace modcal
