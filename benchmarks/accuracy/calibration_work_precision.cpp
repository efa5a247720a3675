// Work–precision of calibrations: for every objective and optimizer the error of the frequencies
// against the processor time spent, from one start, on one record of a stiff string with 1 % noise;
// law and contact are free. Prints the improvements of the objective, thinned to one a quarter of
// the time spent, and the Cramér–Rao bound of the same error.
//
//     calibration_work_precision [OBJECTIVE] > calibration_work_precision.csv
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <ctime>

#include "benchmarks/accuracy/stiff_stroke.hpp"
#include "libcalib/identifiability/expected_limit.hpp"
#include "libcalib/objective.hpp"
#include "libcalib/objectives/force_difference.hpp"
#include "libcalib/objectives/frequency_prior.hpp"
#include "libcalib/objectives/joint_likelihood.hpp"
#include "libcalib/objectives/weighted_sum.hpp"
#include "libsim/base/error.hpp"
#include "tests/libcalib/optimizer_cases.hpp"

namespace modcal {
namespace {

constexpr std::int64_t kModes = 16;
constexpr double kDuration = 0.5;
constexpr double kNoise = 0.01;
constexpr std::int64_t kEvaluations = 250;

double milliseconds() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// Median |f_n − true|/true over all modes.
double frequency_error(const ModelPoint& point, const ModelPoint& truth) {
  std::vector<double> errors;
  for (std::size_t n = 0; n < truth.basis.size(); ++n) {
    errors.push_back(std::abs(point.basis.omega[n] / truth.basis.omega[n] - 1.0));
  }
  return quantile(errors, 0.5);
}

struct Row {
  double milliseconds = 0.0;
  std::int64_t evaluations = 0;
  double frequency_error = 0.0;
  double contact_error = 0.0;
};

/// An objective that notes where its best value lies and when it was found.
class Noted final : public ObjectiveFunction {
 public:
  Noted(const ObjectiveFunction& function, const ParameterSet& parameters, const ModelPoint& truth)
      : function_(function), parameters_(parameters), truth_(truth), begin_(milliseconds()) {}
  std::string_view name() const override { return function_.name(); }
  std::size_t dimension() const override { return function_.dimension(); }
  std::size_t residual_count() const override { return function_.residual_count(); }
  Capabilities capabilities() const override { return function_.capabilities(); }
  const std::vector<Row>& rows() const { return rows_; }

 private:
  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    double value = 0.0;
    ObjectiveOutputs asked = outputs;
    asked.value = outputs.value ? outputs.value : &value;
    function_.evaluate(x, asked);
    ++evaluations_;
    if (!(*asked.value < best_)) return;
    best_ = *asked.value;
    const ModelPoint point = parameters_.model(x);
    rows_.push_back({milliseconds() - begin_, evaluations_, frequency_error(point, truth_),
                     std::abs(point.contact - truth_.contact)});
  }

  const ObjectiveFunction& function_;
  const ParameterSet& parameters_;
  const ModelPoint& truth_;
  double begin_;
  mutable double best_ = std::numeric_limits<double>::infinity();
  mutable std::int64_t evaluations_ = 0;
  mutable std::vector<Row> rows_;
};

/// The first, the last, and what comes at least a quarter of the time later than the one before.
std::vector<Row> thinned(const std::vector<Row>& all) {
  std::vector<Row> kept;
  for (const Row& row : all) {
    if (kept.empty() || &row == &all.back() || row.milliseconds > 1.25 * kept.back().milliseconds) {
      kept.push_back(row);
    }
  }
  return kept;
}

struct Labeled {
  std::string label;
  std::shared_ptr<const Objective> objective;
  std::int64_t evaluations = kEvaluations;
};

/// An evaluation of the innovation misfit is 45 simulations of the record, a third of a second
/// where the others take a millisecond or less.
constexpr std::int64_t kFewEvaluations = 60;

/// The likelihood beside frequencies measured otherwise, which know the law a hundredth as well:
/// the bound drawn, of the record alone, holds for the sum too.
std::shared_ptr<const Objective> with_frequency_prior(const StiffStroke& stroke,
                                                      const JointLikelihood::Options& likelihood) {
  FrequencyPrior::Options prior;
  std::vector<double> draw(stroke.truth.basis.size());
  fill_standard_normal(StreamKey(1).with("frequencies measured otherwise"), draw);
  for (std::size_t n = 0; n < draw.size(); ++n) {
    const double frequency = stroke.truth.basis.frequency(n);
    prior.modes.push_back(static_cast<std::int64_t>(n + 1));
    prior.deviations.push_back(1e-4 * frequency);
    prior.frequencies.push_back(frequency * (1.0 + 1e-4 * draw[n]));
  }
  WeightedSum::Options sum;
  sum.terms.resize(2);
  sum.terms[0].objective.assign(
      Choice<Objective>::of<JointLikelihood>("joint_likelihood", likelihood));
  sum.terms[1].objective.assign(Choice<Objective>::of<FrequencyPrior>("frequency_prior", prior));
  return std::make_shared<WeightedSum>(sum);
}

std::vector<Labeled> objectives(const StiffStroke& stroke) {
  std::vector<Labeled> all;
  for (const char* name :
       {"spectral_peak", "smooth_spectral_peak", "contact_location", "contact_location_squares"}) {
    all.push_back({name, Choice<Objective>(name).make()});
  }
  all.push_back({"force_mismatch",
                 std::make_shared<ForceMismatch>(ForceMismatch::Options{.weights = "transfer"})});
  for (const double damping : {20.0, 0.0}) {
    JointLikelihood::Options options{.damping = damping};
    options.left_noise = stroke.left_noise;
    options.right_noise = stroke.right_noise;
    all.push_back({damping > 0.0 ? "joint_likelihood damped" : "joint_likelihood",
                   std::make_shared<JointLikelihood>(options)});
    if (damping == 0.0) {
      all.push_back({"joint_likelihood + frequency_prior", with_frequency_prior(stroke, options)});
    }
  }
  all.push_back(
      {"innovation_misfit", Choice<Objective>("innovation_misfit").make(), kFewEvaluations});
  return all;
}

std::string_view family_of(const OptimizerCase& entry) {
  switch (entry.way) {
    case Way::kSystematic:
      return "systematic";
    case Way::kGlobal:
      return "global";
    case Way::kSimplex:
      return "values";
    case Way::kGradient:
      return "gradient";
    case Way::kLeastSquares:
      return "residuals";
    case Way::kLine:
      return "line";
  }
  return "";
}

void print_search(const Labeled& objective, const OptimizerCase& entry,
                  const ObjectiveFunction& function, const ParameterSet& parameters,
                  const StiffStroke& stroke) {
  const Noted noted(function, parameters, stroke.truth);
  if (!entry.optimizer->explain_unsatisfied(noted).empty()) return;
  try {
    const OptimizationResult found = entry.optimizer->minimize(
        noted, parameters.variables(), {.evaluations = objective.evaluations});
    const std::vector<Row> rows = thinned(noted.rows());
    for (const Row& row : rows) {
      fmt::print("{},{},{},{:.4g},{},{:.4g},{:.4g},{}\n", objective.label, entry.label,
                 family_of(entry), row.milliseconds, row.evaluations, row.frequency_error,
                 row.contact_error, name_of(found.stop));
    }
  } catch (const InvalidInput&) {
    // One variable, a grid larger than the budget: this search does not apply.
  }
}

/// Median over the modes of what |f_n − true|/true is half the time, 0.6745 standard deviations.
double bound(const StiffStroke& stroke) {
  NoisyRecords records{
      .reactions = {stroke.run.left_reaction.samples, stroke.run.right_reaction.samples},
      .deviation = {stroke.left_noise, stroke.right_noise},
      .sample_rate = kStrokeRate};
  for (auto& reaction : records.reactions) remove_mean(reaction);
  const double highest = likelihood_band(stroke.truth, NAN, kStrokeRate);
  const ExpectedLimit limit = expected_limit(stroke.truth, records, highest, 2e-3);
  const double f0 = limit.law[0] / 196.0;
  const double correlation = limit.law_correlation[0][1];
  std::vector<double> deviations;
  for (std::size_t n = 1; n <= stroke.truth.basis.size(); ++n) {
    const double square = static_cast<double>(n * n);
    const double by_b = 0.5 * square / (1.0 + 1.4e-4 * square) * limit.law[1];
    deviations.push_back(std::sqrt(f0 * f0 + 2.0 * correlation * f0 * by_b + by_b * by_b));
  }
  return 0.6745 * quantile(deviations, 0.5);
}

// only: one objective; empty: all.
int print_all(std::string_view only) {
  // Processor time of a search is not to hold that of threads which wait for work.
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const StiffStroke stroke = stiff_stroke(kModes, kDuration, kNoise, 1);
  ModelPoint start = stroke.truth;
  for (std::size_t n = 1; n <= start.basis.size(); ++n) {
    start.basis.omega[n - 1] *= 1.0 + 3e-4 + 1e-6 * static_cast<double>(n * n);
  }
  start.contact += 3e-4;
  const std::vector<std::string> names = {"f0", "B", "x_c"};
  const ParameterSet parameters(start, names,
                                {.frequency = 3e-3, .inharmonicity = 3e-5, .contact = 1e-3});
  fmt::print("# bound {:.4g}\n", bound(stroke));
  fmt::print(
      "objective,optimizer,family,milliseconds,evaluations,frequency_error,contact_error,"
      "stop\n");
  for (const Labeled& objective : objectives(stroke)) {
    if (!only.empty() && objective.label != only) continue;
    // The default grid has more points than the budget; one of its size has this many a variable.
    const std::int64_t points = objective.evaluations < kEvaluations ? 3 : 6;
    std::vector<OptimizerCase> optimizers = optimizer_cases();
    optimizers.push_back({fmt::format("grid_{}", points), Way::kSystematic,
                          std::make_shared<Grid>(Grid::Options{points})});
    const auto function = objective.objective->bind(stroke.data, parameters);
    for (const OptimizerCase& entry : optimizers) {
      print_search(objective, entry, *function, parameters, stroke);
    }
  }
  return 0;
}

}  // namespace
}  // namespace modcal

int main(int count, char** arguments) { return modcal::print_all(count > 1 ? arguments[1] : ""); }
