#include "experiments/kinds/limit/limit.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

constexpr double kWellSeen = 5e-4;
constexpr const char* kLawNames[] = {"f0", "B", "x_c", "damping"};

class LevelReader {
 public:
  LevelReader(const LimitLevel& level, const LimitTruth& truth, const ExpectedLimit& bound)
      : truth_(truth), bound_(bound) {
    summary_.level = level.noise_level;
    for (const LimitOutcome& outcome : level.outcomes) {
      if (!outcome.failure.empty()) {
        ++summary_.broken;
      } else {
        outcomes_.push_back(outcome);
        if (!outcome.fits) ++summary_.contradicted;
        if (!outcome.priors_hold) ++summary_.priors_contradicted;
      }
    }
    summary_.runs = outcomes_.size();
    beyond_.assign(outcomes_.size(), false);
  }

  LimitSummary read() {
    add_law();
    add_frequencies();
    add_sensors();
    add_means();
    count_wrong();
    return std::move(summary_);
  }

 private:
  // score(outcome): its error, and the standard deviation that the calibration reports.
  template <typename Score>
  LimitRow row(std::string name, double bound, Score score) {
    LimitRow row{.noise_percent = 100.0 * summary_.level,
                 .parameter = std::move(name),
                 .bound = bound,
                 .count = outcomes_.size()};
    if (outcomes_.empty()) return row;
    double square = 0.0, sum = 0.0, variance = 0.0;
    for (std::size_t i = 0; i < outcomes_.size(); ++i) {
      const auto [error, deviation] = score(outcomes_[i]);
      square += error * error;
      sum += error;
      variance += std::pow(deviation, 2);
      if (std::abs(error) <= kFailure * bound) continue;
      ++row.failures;
      beyond_[i] = true;
    }
    const auto n = static_cast<double>(outcomes_.size());
    row.rmse = std::sqrt(square / n);
    row.bias = sum / n;
    row.reported = std::sqrt(variance / n);
    return row;
  }

  void add_law() {
    const StiffStringFit fit = fit_stiff_string(frequencies_of(truth_.point.basis));
    const double values[] = {fit.fundamental, fit.inharmonicity, truth_.point.contact, 1.0};
    for (std::size_t i = 0; i < 4; ++i) {
      if (!bound_.find(kLawNames[i])) continue;  // a fixed damping factor
      LimitRow law = row(kLawNames[i], bound_.law[i], [&](const LimitOutcome& o) {
        return std::pair(o.law[i] - values[i], o.law_deviation[i]);
      });
      law.law = true;
      law.attainable = bound_.law_attainable[i];
      summary_.rows.push_back(std::move(law));
    }
  }

  void add_frequencies() {
    double square = 0.0, count = 0.0;
    std::vector<double> bounds;
    for (std::size_t n = 0; n < truth_.point.basis.size(); ++n) {
      const ModeVerdict& mode = bound_.modes[n];
      if (!(mode.deviation < kWellSeen) || mode.source != ModeSource::kIdentified) continue;
      LimitRow free = row(fmt::format("f_{}", n + 1), mode.deviation, [&](const LimitOutcome& o) {
        return std::pair(o.frequencies[n] / truth_.point.basis.frequency(n) - 1.0, o.deviations[n]);
      });
      bounds.push_back(mode.deviation);
      square += free.ratio() * free.ratio();
      count += 1.0;
      summary_.free_worst = std::fmax(summary_.free_worst, free.ratio());
      summary_.rows.push_back(std::move(free));
    }
    summary_.free_rms = std::sqrt(square / count);
    summary_.median_bound = quantile(bounds, 0.5);
    if (!bound_.find("x_c")) return;  // fixed
    summary_.rows.push_back(
        row("x_c, frequencies free", bound_.contact, [this](const LimitOutcome& o) {
          return std::pair(o.contact - truth_.point.contact, o.contact_deviation);
        }));
  }

  // The scene's sensors are alike.
  void add_sensors() {
    for (std::size_t i = 0; i < Sensor::kCount; ++i) {
      const std::string name(sensor_type(i).name);
      const double truth = sensor_value(i, {});
      const ParameterLimit* bound = bound_.find(name);
      if (!bound) continue;
      summary_.rows.push_back(row(name, bound->free, [&](const LimitOutcome& o) {
        return std::pair(o.sensors[i] - truth, o.sensor_deviation[i]);
      }));
    }
  }

  void add_means() {
    if (outcomes_.empty()) return;
    const auto finite = [this](double LimitOutcome::*value) {
      std::vector<double> values;
      for (const LimitOutcome& outcome : outcomes_) {
        if (std::isfinite(outcome.*value)) values.push_back(outcome.*value);
      }
      return values;
    };
    summary_.mean_chi2 = mean(finite(&LimitOutcome::chi2));
    summary_.chi2_scatter = standard_deviation(finite(&LimitOutcome::chi2));
    summary_.chi2_deviation = mean(finite(&LimitOutcome::chi2_deviation));
    summary_.mean_law_chi2 = mean(finite(&LimitOutcome::law_chi2));
    summary_.paper_error = quantile(finite(&LimitOutcome::paper_error), 0.5);
    const std::vector<double> force = finite(&LimitOutcome::force_correlation);
    if (!force.empty()) summary_.force_correlation = mean(force);
    std::vector<double> medians;
    const std::vector<double> shape = truth_.point.basis.shape_at(truth_.point.contact);
    for (const LimitOutcome& outcome : outcomes_) {
      std::vector<double> errors;
      for (std::size_t n = 0; n < shape.size(); ++n) {
        if (std::abs(shape[n]) < 0.1) continue;
        errors.push_back(std::abs(outcome.frequencies[n] / truth_.point.basis.frequency(n) - 1.0));
      }
      medians.push_back(quantile(std::move(errors), 0.5));
    }
    summary_.median_error = quantile(medians, 0.5);
  }

  void count_wrong() {
    summary_.wrong = summary_.broken;
    for (std::size_t i = 0; i < outcomes_.size(); ++i) {
      if (!beyond_[i]) continue;
      ++summary_.wrong;
      if (outcomes_[i].right()) ++summary_.silent;
    }
  }

  const LimitTruth& truth_;
  const ExpectedLimit& bound_;
  std::vector<LimitOutcome> outcomes_;
  std::vector<bool> beyond_;  // an error of this run is no noise
  LimitSummary summary_;
};

}  // namespace

const LimitRow* LimitSummary::find(const std::string& parameter) const {
  const auto found = std::find_if(rows.begin(), rows.end(),
                                  [&](const LimitRow& row) { return row.parameter == parameter; });
  return found == rows.end() ? nullptr : &*found;
}

std::vector<PooledRow> pooled_rows(const std::vector<LimitSummary>& levels) {
  std::vector<PooledRow> pooled;
  for (const char* name : kLawNames) {
    PooledRow sum{.parameter = name};
    double square = 0.0, variance = 0.0;
    for (const LimitSummary& level : levels) {
      const LimitRow* row = level.find(name);
      if (!row || !(level.level > 0.0) || row->count == 0) continue;
      const auto n = static_cast<double>(row->count);
      square += n * row->ratio() * row->ratio();
      variance += n * std::pow(row->reported / row->bound, 2);
      sum.bias += n * row->bias / row->bound;
      sum.count += row->count;
    }
    if (sum.count == 0) continue;
    sum.ratio = std::sqrt(square / static_cast<double>(sum.count));
    sum.sd_ratio = std::sqrt(variance / square);
    sum.bias /= static_cast<double>(sum.count);
    pooled.push_back(sum);
  }
  return pooled;
}

LimitSummary summarize_level(const LimitLevel& level, const LimitTruth& truth,
                             const ExpectedLimit& bound) {
  return LevelReader(level, truth, bound).read();
}

}  // namespace modcal
