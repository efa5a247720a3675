#include "libcalib/optimizers/staged/continuation_attempt.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "libcalib/identifiability/joint_report.hpp"
#include "libcalib/identifiability/mode_verdict.hpp"
#include "libcalib/likelihood/parameter_forms.hpp"
#include "libcalib/noise/noise_fit.hpp"
#include "libcalib/optimizers/staged/free_stage.hpp"
#include "libcalib/optimizers/staged/tuning.hpp"
#include "libcalib/parameters/stiff_string_fit.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

// To a hundredth of a deviation: far less than from one minimum to the next.
bool same(const LawEstimate& one, const LawEstimate& other) {
  return std::abs(one.fundamental - other.fundamental) < 0.01 * other.deviation[0] &&
         std::abs(one.inharmonicity - other.inharmonicity) < 0.01 * other.deviation[1] &&
         std::abs(one.contact - other.contact) < 0.01 * other.deviation[2];
}

// One attempt: everything between a start of f_0 and a verdict by χ².
class Attempt {
 public:
  Attempt(const AttemptInput& input, std::size_t evaluations)
      : input_(input), priors_(input.priors), stroke_(input, evaluations) {
    reference_ = with_fixed(input.initial, options().unknowns);
    start_ = fit_stiff_string(frequencies_of(reference_.basis));
    const auto take_fixed = [this](const ParameterName& name, double& value) {
      value = priors_.fixed(name).value_or(value);
    };
    take_fixed({ParameterKind::kContact}, reference_.contact);
    take_fixed({ParameterKind::kFundamental}, start_.fundamental);
    take_fixed({ParameterKind::kInharmonicity}, start_.inharmonicity);
    reference_.sensors = options().unknowns.sensors();
    stroke_.scale_damping(start_.fundamental);
  }

  ContinuationResult run(double shift) {
    if (!priors_.fixed({ParameterKind::kFundamental})) start_.fundamental *= std::exp(shift);
    ContinuationResult result;
    follow_law();
    fit_whole_of_ladder();
    Eigen::MatrixXd covariance = finish_law("law", result);
    // Where a fit with weights ends: one without fits the noise of bins that tell nothing, too.
    if (input_.take_noise(stroke_.whole(), law_.model(law_theta_), 0.02)) {
      stroke_.renew();
      covariance = finish_law("law, other noise", result);
    }
    result.noise = input_.records.deviation;
    result.noise_spectrum = input_.records.noise;
    result.noise_error = input_.records.power_error;
    report_law(covariance, result);
    if (!input_.first_law) input_.first_law = result.law;
    result.repeats = shift != 0.0 && same(result.law, *input_.first_law);
    if (options().frequencies && !result.repeats) {
      free_frequencies(input_, {law_, law_theta_, ladder_theta_}, stroke_, result);
      leave_out(result);
      report_departures(result.tests, result);
    } else {
      result.found_law = FoundLaw::of(result.law);
    }
    result.fits = result.chi2 < 1.0 + 3.0 * result.chi2_deviation;
    const ScoreTest* cause = first_cause(result.tests);
    result.right = result.fits && !result.priors.contradicted() && !result.contradicts_itself() &&
                   !(cause && cause->refuses());
    result.evaluations = stroke_.evaluations();
    result.stages = stroke_.stages();
    return result;
  }

 private:
  const ContinuationOptions& options() const { return input_.options; }

  // About θ, where the fit starts.
  static NewtonOptions with_priors(const StringUnknowns& unknowns, const Eigen::VectorXd& theta,
                                   std::size_t steps, double tolerance) {
    NewtonOptions options{.steps = steps, .tolerance = tolerance};
    set_prior(unknowns.prior(theta), options);
    return options;
  }

  // Of the x_c up to `reach` steps away those whose cost is below that of both neighbors: a start
  // between them leads to one of theirs. Priors join in the fits that start there.
  std::vector<Eigen::VectorXd> contact_starts(const ProjectedLikelihood& likelihood,
                                              const StringUnknowns& unknowns, double step,
                                              int reach) {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    std::vector<Eigen::VectorXd> starts;
    std::vector<double> costs = {kNever};
    for (int i = -reach; i <= reach; ++i) {
      starts.push_back(unknowns.start());
      starts.back()[unknowns.contact()] = i * step;
      const bool admitted = stroke_.admits(unknowns, starts.back());
      costs.push_back(admitted ? stroke_.cost(likelihood, unknowns.model(starts.back())) : kNever);
    }
    costs.push_back(kNever);
    std::vector<Eigen::VectorXd> lowest;
    for (std::size_t i = 0; i < starts.size(); ++i) {
      const double cost = costs[i + 1];
      if (cost < kNever && cost <= costs[i] && cost <= costs[i + 2]) lowest.push_back(starts[i]);
    }
    return lowest;
  }

  StringUnknowns law(const StatedPriors& priors) const {
    return StringUnknowns::law(reference_, start_.fundamental, start_.inharmonicity,
                               options().unknowns, priors);
  }

  // f_0, B and x_c through the ladder, from the x_c that serves best.
  void follow_law() {
    const double step = reference_.basis.length / 660.0;
    const ProjectedLikelihood widest = stroke_.damped(200.0);
    const StringUnknowns unknowns = law(priors_).without_damping_and_sensors();
    NewtonFit best;
    const int reach = priors_.fixed_contact(0) ? 0 : 4;
    for (const Eigen::VectorXd& theta : contact_starts(widest, unknowns, step, reach)) {
      NewtonFit found =
          stroke_.fit(widest, unknowns, theta, with_priors(unknowns, theta, 25, 1e-2));
      if (found.objective < best.objective) best = std::move(found);
    }
    MODCAL_REQUIRE(best.theta.size() > 0, "the initial frequencies follow no law of a string");
    stroke_.end_stage(stroke_.damped_name("law", 200.0), widest, unknowns, best);
    for (const double sigma : {100.0, 50.0}) {
      best = stroke_.fit_stage(stroke_.damped_name("law", sigma), stroke_.damped(sigma), unknowns,
                               best.theta, with_priors(unknowns, best.theta, 20, 1e-2));
    }
    law_ = law(priors_);
    const ProjectedLikelihood last = stroke_.damped(20.0);
    const auto fitted = [&](const Eigen::VectorXd& theta) {
      Eigen::VectorXd start = Eigen::VectorXd::Zero(law_.size());
      start.head(3) = theta;
      return stroke_.fit(last, law_, start, with_priors(law_, start, 20, 1e-3));
    };
    const std::string name = stroke_.damped_name("law", 20.0);
    NewtonFit found = fitted(best.theta);
    stroke_.end_stage(name, last, law_, found);
    // A start that was near before the widest rung, of a few samples and much noise, led elsewhere.
    // One that leaves twice as much was not.
    if (stroke_.cost(last, law_.model(law_.start())) < kSecondStart * found.objective) {
      NewtonFit direct = fitted(law_.start().head(3));
      if (direct.objective < found.objective) {
        std::swap(direct, found);
        stroke_.end_stage(name + ", from the start itself", last, law_, found);
      }
      // Fits of one minimum differ by less than their tolerance, 1e-3.
      if (direct.objective > found.objective + 1e-2) second_theta_ = direct.theta;
    }
    law_theta_ = ladder_theta_ = found.theta;
    ladder_misfit_ = misfit(last, found.objective);
  }

  // Over the degrees of freedom, weights and priors aside.
  double misfit(const ProjectedLikelihood& likelihood, double objective) const {
    const std::size_t free_count = law_.size() - law_.held_count();
    return objective / likelihood.degrees_of_freedom(free_count, reference_);
  }

  // σ = 0, end state projected out.
  NewtonFit whole_from(const Eigen::VectorXd& theta) {
    return stroke_.fit(stroke_.whole(), law_, theta, with_priors(law_, theta, kLawSteps, 1e-2));
  }

  // Of the minima that the ladder and the start itself lead to all of the record tells the lower:
  // by odds of more than e^10, as unknowns that hardly matter leave two fits of one minimum apart.
  void fit_whole_of_ladder() {
    end_whole("law", whole_from(law_theta_));
    if (misfit(stroke_.whole(), whole_objective_) > kLost * std::max(1.0, ladder_misfit_)) {
      find_law_again();
    }
    if (second_theta_.size() == 0) return;
    const NewtonFit second = whole_from(second_theta_);
    if (!(second.objective < whole_objective_ - kMinimaOdds)) return;
    ladder_theta_ = second_theta_;
    end_whole("law from its second minimum", second);
  }

  // Sensors and damping that wander where the law is still off lose it: first they stay near what
  // was stated, as if noise were as large as what is left.
  void find_law_again() {
    NewtonOptions stiff = with_priors(law_, ladder_theta_, kLawSteps, 1e-2);
    stiff.prior *= misfit(stroke_.whole(), whole_objective_);
    const NewtonFit near = stroke_.fit(stroke_.whole(), law_, ladder_theta_, stiff);
    const NewtonFit found = whole_from(near.theta);
    if (found.objective < whole_objective_) end_whole("law, sensors and damping last", found);
  }

  void fit_whole(const std::string& name) { end_whole(name, whole_from(law_theta_)); }

  void end_whole(const std::string& name, const NewtonFit& found) {
    law_theta_ = found.theta;
    whole_objective_ = found.objective;
    stroke_.end_stage(name + ", whole record", stroke_.whole(), law_, found);
  }

  // Once more with weights and without the noise in JᵀJ. Returns the covariance.
  Eigen::MatrixXd finish_law(const std::string& name, ContinuationResult& result) {
    const auto free_count = static_cast<double>(law_.size() - law_.held_count());
    result.chi2_deviation =
        std::hypot(std::sqrt(2.0 / stroke_.whole().degrees_of_freedom(free_count, reference_)),
                   input_.records.power_error);
    NewtonOptions options = with_priors(law_, law_theta_, 4, 1e-4);
    options.noise = stroke_.prepare_weights(law_, law_theta_);
    const NewtonFit last = stroke_.fit(stroke_.weighted(), law_, law_theta_, options);
    law_theta_ = last.theta;
    const LikelihoodPoint at = stroke_.weighted_point(law_, law_theta_);
    Eigen::MatrixXd covariance = fit_covariance(at, options);
    law_.clear_held(covariance);
    const ModelPoint model = law_.model(law_theta_);
    LawEstimate& law = result.law;
    law = law_estimate({law_, law_theta_, model, law_.damping_factor(law_theta_), covariance});
    law.covariance = named_covariance(law_, law_theta_, law.damping, covariance);
    law.chi2 = stroke_.reduced_chi2(law_, law_theta_, at, options);
    stroke_.end_stage(name + ", weighted bins", last.objective, law.chi2);
    law.accepted = law.chi2 < 1.0 + 3.0 * result.chi2_deviation;
    law.priors = law_.prior_misfit(law_theta_);
    return covariance;
  }

  // The law's model as the result.
  void report_law(const Eigen::MatrixXd& covariance, ContinuationResult& result) const {
    const LawEstimate& law = result.law;
    result.model = law_.model(law_theta_);
    result.covariance = law.covariance;
    result.chi2 = law.chi2;
    result.priors = law.priors;
    report_record({law_, law_theta_, result.model, law.damping, covariance}, 0, true, result);
    result.damping_power = law_.damping_power(law_theta_);
    result.modes = law_verdicts(result.model, law.inharmonicity, covariance.topLeftCorner(2, 2));
    trust_stated_frequencies(priors_, {}, result.modes);
  }

  // The law once more without the modes that do not follow it: they stay where they were found.
  void leave_out(ContinuationResult& result) {
    const std::vector<std::size_t> others = not_following(result.modes);
    if (others.empty()) return;
    for (const std::size_t n : others) {
      reference_.basis.omega[n] = result.model.basis.omega[n];
    }
    law_ = law(priors_.fixing(others));
    const std::string name = "law without the modes that do not follow it";
    fit_whole(name);
    finish_law(name, result);
  }

  const AttemptInput& input_;
  const StatedPriors& priors_;
  StrokeFit stroke_;
  ModelPoint reference_;  // the initial model with what is fixed and the sensors stated
  StiffStringFit start_;
  StringUnknowns law_;
  Eigen::VectorXd law_theta_, ladder_theta_;
  double ladder_misfit_ = 0.0;  // at the last rung
  double whole_objective_ = 0.0;
  Eigen::VectorXd second_theta_;  // of another minimum at the last rung; empty: there is none
};

}  // namespace

bool AttemptInput::take_noise(const ProjectedLikelihood& likelihood, const ModelPoint& point,
                              double share) const {
  const bool stated = !std::isnan(options.left_noise) || !std::isnan(options.right_noise);
  if (stated || misfit_for_noise) return false;
  NoiseFit found = fit_noise(likelihood, point);
  // What a wrong model leaves is noise only where it is less than was taken for noise before.
  if (found.misfit && !(found.level < 1.0 - share)) return false;
  if (!found.misfit && !found.spectrum.differs_from(records.noise, share)) return false;
  records.power_error = std::max(records.power_error, found.error);
  std::array<double, 2> power{found.level, found.level};
  if (!found.misfit) {
    const NoiseCovariance first = found.spectrum.knots.front().noise;
    const bool white = found.spectrum.knots.size() == 1 && first.mixed == 0.0;
    if (white) power = {first.left, first.right};
    records.noise = white ? NoiseSpectrum{} : std::move(found.spectrum);
  }
  for (std::size_t r = 0; r < 2; ++r) records.deviation[r] *= std::sqrt(power[r]);
  return true;
}

ContinuationResult attempt_continuation(const AttemptInput& input, double shift,
                                        std::size_t evaluations) {
  return Attempt(input, evaluations).run(shift);
}

}  // namespace modcal
