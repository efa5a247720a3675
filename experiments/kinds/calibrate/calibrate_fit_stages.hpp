// Stages of a continuation: table and JSON.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "experiments/report/table.hpp"
#include "libcalib/optimizers/staged/fit_stage.hpp"

namespace modcal {

struct CalibrationOutcome;
struct StudyResult;

/// [{"name", "evaluations", "objective", "chi2"}], see FitStage; null for what is not known.
nlohmann::ordered_json stages_json(const std::vector<FitStage>& stages);

report::Table stage_table(const std::vector<FitStage>& stages, const std::string& command);

/// The table into a study of a continuation; nothing of a search by objective and optimizer.
void add_stages(const CalibrationOutcome& outcome, const std::string& command, StudyResult& result);

}  // namespace modcal
