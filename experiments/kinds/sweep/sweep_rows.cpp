#include "experiments/kinds/sweep/sweep_rows.hpp"

#include <cmath>
#include <utility>

#include "libsim/records/csv_reader.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

bool is_stand_in(ChoiceStatus status) {
  return status != ChoiceStatus::kChosen && status != ChoiceStatus::kGiven &&
         status != ChoiceStatus::kNoParameter;
}

bool is_numbered(const std::string& side) { return side == "1" || side == "2"; }

// Sides that a failed task would have had.
std::vector<std::string> sides_of(const SweepCell& cell) {
  const std::string estimator(cell.options.inversion.estimator.selected());
  if (estimator == "one_sided") return {"1", "2"};
  if (estimator == "model_based") return {"model"};
  return {estimator};
}

void add_draw(const TaskScores& draw, SweepRow& row) {
  row.parameter.push_back(draw.parameter);
  if (is_stand_in(draw.status)) ++row.stand_ins;
  for (const WindowScore& score : draw.scores) {
    row.correlation.push_back(score.correlation);
    row.rms_error.push_back(score.relative_rms_error);
    row.anti_aliased.push_back(score.anti_aliased);
  }
  row.misfit.push_back(draw.misfit);
  if (!draw.warnings.empty()) ++row.warned;
  row.whole.push_back(draw.whole.correlation);
  row.whole_rms_error.push_back(draw.whole.relative_rms_error);
  row.whole_anti_aliased.push_back(draw.whole.anti_aliased);
}

void sum_up(const PublishedTable& published, SweepRow& row) {
  row.median = quantile(row.correlation, 0.5);
  row.q10 = quantile(row.correlation, 0.1);
  row.q90 = quantile(row.correlation, 0.9);
  row.rms_median = quantile(row.rms_error, 0.5);
  row.parameter_median = quantile(row.parameter, 0.5);
  for (const auto& [percent, values] : published) {
    if (std::abs(percent - row.noise_percent) > 1e-6 || !is_numbered(row.side)) continue;
    const auto side = static_cast<std::size_t>(row.side[0] - '1');
    row.published_correlation = values.correlation[side];
    row.published_parameter = values.parameter[side];
  }
}

}  // namespace

double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const double value : values) {
    if (std::isnan(value)) continue;
    sum += value;
    ++count;
  }
  return count > 0 ? sum / static_cast<double>(count) : std::numeric_limits<double>::quiet_NaN();
}

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

std::vector<SweepRow> sweep_rows(const std::vector<SweepCell>& cells,
                                 const std::vector<std::optional<TaskOutcome>>& outcomes,
                                 const PublishedTable& published) {
  std::map<std::pair<std::string, double>, SweepRow> rows;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (!outcomes[i]) continue;
    // Percent values are rounded to 1e-9 so that 0.03 and 3 % are one row.
    const double percent = std::round(cells[i].row_value * 1e11) / 1e9;
    const auto row_of = [&](const std::string& side) -> SweepRow& {
      SweepRow& row = rows[{side, percent}];
      row.noise_percent = percent;
      row.side = side;
      return row;
    };
    if (!outcomes[i]->failure.empty()) {
      for (const std::string& side : sides_of(cells[i])) ++row_of(side).failures;
    }
    for (const TaskScores& draw : outcomes[i]->sides) add_draw(draw, row_of(draw.side));
  }
  std::vector<SweepRow> result;
  for (auto& [key, row] : rows) {
    sum_up(published, row);
    result.push_back(std::move(row));
  }
  return result;
}

Judgement judge(const std::vector<SweepRow>& rows, const ComparisonOptions& options) {
  Judgement judgement;
  for (const SweepRow& row : rows) {
    if (!row.published_correlation || row.noise_percent < 100.0 * options.lowest_row) continue;
    ++judgement.cells;
    judgement.sum_difference += std::abs(row.median - *row.published_correlation);
    if (row.q10 <= *row.published_correlation && *row.published_correlation <= row.q90) {
      ++judgement.inside_band;
    }
    const double ratio = row.parameter_median / *row.published_parameter;
    if (ratio <= options.parameter_factor && ratio * options.parameter_factor >= 1.0) {
      ++judgement.parameter_cells;
    }
  }
  return judgement;
}

}  // namespace modcal
