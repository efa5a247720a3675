// Draws of a sweep summed up row by row.
#include <cmath>
#include <utility>

#include "experiments/kinds/sweep/sweep_study.hpp"
#include "libsim/records/csv_reader.hpp"

namespace modcal {
namespace {

bool is_stand_in(ChoiceStatus status) {
  return status != ChoiceStatus::kChosen && status != ChoiceStatus::kGiven &&
         status != ChoiceStatus::kNoParameter;
}

bool is_numbered(const std::string& side) { return side == "1" || side == "2"; }

// Sides that a failed task would have had.
std::vector<std::string> sides_of(const std::string& estimator) {
  if (estimator == "one_sided") return {"1", "2"};
  if (estimator == "model_based") return {"model"};
  return {estimator};
}

void add_draw(const TaskScores& draw, SweepRow& row) {
  row.parameter.add(draw.parameter);
  if (is_stand_in(draw.status)) ++row.stand_ins;
  for (const WindowScore& score : draw.scores) {
    row.correlation.add(score.correlation);
    row.rms_error.add(score.relative_rms_error);
    row.anti_aliased.add(score.anti_aliased);
  }
  row.misfit.add(draw.misfit);
  if (!draw.warnings.empty()) ++row.warned;
  row.whole.add(draw.whole.correlation);
  row.whole_rms_error.add(draw.whole.relative_rms_error);
  row.whole_anti_aliased.add(draw.whole.anti_aliased);
}

void add_published(const PublishedTable& published, SweepRow& row) {
  for (const auto& [percent, values] : published) {
    if (std::abs(percent - row.noise_percent) > 1e-6 || !is_numbered(row.side)) continue;
    const auto side = static_cast<std::size_t>(row.side[0] - '1');
    row.published_correlation = values.correlation[side];
    row.published_parameter = values.parameter[side];
  }
}

}  // namespace

PublishedTable read_published(const std::filesystem::path& path) {
  const Recording file = read_csv(
      path, {.columns = {"noise_percent", "R1", "epsilon1", "R2", "epsilon2"}, .sample_rate = 1.0});
  PublishedTable rows;
  for (std::size_t i = 0; i < file.frames(); ++i) {
    const auto value = [&](std::size_t column) { return file.channels[column].samples[i]; };
    rows[value(0)] = {{value(1), value(3)}, {value(2), value(4)}};
  }
  return rows;
}

std::vector<SweepRow> sweep_rows(const std::vector<SweepTask>& tasks,
                                 const PublishedTable& published) {
  std::map<std::pair<std::string, double>, SweepRow> rows;
  for (const SweepTask& task : tasks) {
    // Percent values are rounded to 1e-9 so that 0.03 and 3 % are one row.
    const double percent = std::round(task.noise_level * 1e11) / 1e9;
    const auto row_of = [&](const std::string& side) -> SweepRow& {
      SweepRow& row = rows[{side, percent}];
      row.noise_percent = percent;
      row.side = side;
      return row;
    };
    if (!task.outcome.failure.empty()) {
      for (const std::string& side : sides_of(task.estimator)) ++row_of(side).failures;
    }
    for (const TaskScores& draw : task.outcome.sides) add_draw(draw, row_of(draw.side));
  }
  std::vector<SweepRow> result;
  for (auto& [key, row] : rows) {
    add_published(published, row);
    result.push_back(std::move(row));
  }
  return result;
}

}  // namespace modcal
