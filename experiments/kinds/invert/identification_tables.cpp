// What an identification has found, in rows and lines.
#include <algorithm>

#include "experiments/kinds/invert/invert.hpp"
#include "experiments/report/result.hpp"

namespace modcal {

report::Cell side_cell(const std::string& side) {
  if (side == "1" || side == "2") return side[0] - '0';
  return side;
}

report::Table identification_table(const std::vector<SideIdentification>& sides) {
  report::Table table{.id = "identification", .title = "Identification"};
  const bool limited = std::ranges::any_of(sides, [](const SideIdentification& side) {
    return std::isfinite(side.estimate.band_limit);
  });
  const auto add = [&table, limited](const SideIdentification& side, const WindowScore& score) {
    const ChosenParameter& choice = side.estimate.result.choice;
    const bool free = choice.status == ChoiceStatus::kNoParameter;
    const auto parameter = free ? std::nullopt : std::optional(choice.parameter());
    report::add_row(table, [&](report::RowWriter& row) {
      row.cell({.key = "side"}, side_cell(side.estimate.side));
      row({}, score);
      row({.key = "parameter", .unit = "N/N"}, parameter);
      row({.key = "relative_parameter", .name = "parameter / max|H|"},
          free ? parameter : *parameter / side.estimate.largest_transfer);
      row({.key = "kept_share", .name = "share of bins kept"}, choice.kept_share);
      row({.key = "choice", .name = "parameter choice"}, name_of(choice.status));
      row({.key = "force_deviation",
           .name = "standard deviation of the force, posterior",
           .unit = "N"},
          known(side.estimate.force_deviation));
      if (!limited) return;
      row({.key = "velocity_deviation",
           .name = "standard deviation of the velocity, posterior",
           .unit = "m/s"},
          known(side.estimate.velocity_deviation));
      row({.key = "band_limit", .name = "identified up to", .unit = "Hz"},
          known(side.estimate.band_limit));
    });
  };
  for (const SideIdentification& side : sides) {
    if (side.scores.empty()) add(side, {.start = std::nan("")});
    for (const WindowScore& score : side.scores) add(side, score);
  }
  return table;
}

void add_identification_tables(const std::vector<SideIdentification>& sides, StudyResult& result) {
  result.add({identification_table(sides)});
  report::Table table{.id = "motion", .title = "Measured motion at the contact"};
  for (const SideIdentification& side : sides) {
    for (const MotionScore& motion : side.motion) {
      report::add_row(table, [&](report::RowWriter& row) {
        row.cell({.key = "side"}, side_cell(side.estimate.side));
        row({.key = "signal"}, motion.quantity);
        row({}, motion.score);
      });
    }
  }
  if (!table.rows.empty()) result.add({std::move(table)});
}

void add_scores(const std::vector<SideIdentification>& sides, StudyResult& result) {
  for (const SideIdentification& side : sides) {
    for (const WindowScore& window : side.scores) {
      result.summary += fmt::format("side {}  parameter {:.4g} N/N  {}\n", side.estimate.side,
                                    side.estimate.result.choice.parameter(), window.text());
      result.scores.push_back({side.estimate.side, window});
    }
    for (const auto& [quantity, window] : side.motion) {
      result.summary += fmt::format("side {}  {} at the contact  {}\n", side.estimate.side,
                                    quantity, window.text());
    }
  }
}

}  // namespace modcal
