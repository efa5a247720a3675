#include "libcalib/likelihood/continuation_attempt.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "libcalib/likelihood/bin_weights.hpp"
#include "libcalib/likelihood/mode_verdict.hpp"
#include "libcalib/likelihood/neighbor_test.hpp"
#include "libcalib/likelihood/newton_fit.hpp"
#include "libcalib/likelihood/stated_verdict.hpp"
#include "libcalib/stiff_string_fit.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

constexpr std::size_t kNoiseRepeats = 3;
constexpr double kStepCap = 1e-3;

// One attempt: everything between a start of f_0 and a verdict by χ².
class Attempt {
 public:
  Attempt(const AttemptInput& input, std::size_t evaluations)
      : initial_(input.initial),
        records_(input.records),
        options_(input.options),
        priors_(input.priors),
        highest_(input.highest),
        noise_error_(input.noise_error),
        evaluations_(evaluations) {
    std::vector<double> frequencies;
    reference_ = with_fixed(initial_, options_.unknowns);
    for (std::size_t n = 0; n < modes(); ++n) frequencies.push_back(reference_.basis.frequency(n));
    start_ = fit_stiff_string(frequencies);
    const HeldParameters& held = priors_.held();
    if (held.contact(0)) reference_.contact = *held.contacts[0];
    if (held.fundamental) start_.fundamental = *held.fundamental;
    if (held.inharmonicity) start_.inharmonicity = *held.inharmonicity;
    reference_.sensors = options_.unknowns.sensors();
    unit_ = start_.fundamental / 196.0;
  }

  ContinuationResult run(double shift) {
    ContinuationResult result;
    result.noise = records_.deviation;
    follow_law(shift);
    finish_law(result);
    if (options_.frequencies) free_frequencies(result);
    result.fits = result.chi2 < 1.0 + 3.0 * result.chi2_deviation;
    result.right = result.fits && !result.priors.contradicted();
    result.evaluations = evaluations_;
    return result;
  }

 private:
  std::size_t modes() const { return initial_.basis.size(); }
  ProjectedLikelihood damped(double sigma) const {
    return ProjectedLikelihood(WhitenedRecord::of(records_, sigma * unit_, highest_));
  }
  NewtonFit fit(const ProjectedLikelihood& likelihood, const StringUnknowns& unknowns,
                const Eigen::VectorXd& theta, const NewtonOptions& options) {
    NewtonFit result = newton_fit(likelihood, unknowns, theta, options);
    evaluations_ += result.evaluations;
    return result;
  }

  // About θ, where the fit starts.
  static NewtonOptions with_priors(const StringUnknowns& unknowns, const Eigen::VectorXd& theta,
                                   std::size_t steps, double tolerance) {
    NewtonOptions options{.steps = steps, .tolerance = tolerance};
    set_prior(unknowns.prior(theta), options);
    return options;
  }

  static void set_prior(QuadraticPrior prior, NewtonOptions& options) {
    options.prior = std::move(prior.precision);
    options.prior_mean = std::move(prior.mean);
  }

  // Of the x_c up to `reach` steps away those whose cost is below that of both neighbors: a start
  // between them leads to one of theirs.
  std::vector<Eigen::VectorXd> contact_starts(const ProjectedLikelihood& likelihood,
                                              const StringUnknowns& unknowns, double step,
                                              int reach) {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    std::vector<Eigen::VectorXd> starts;
    std::vector<double> costs = {kNever};
    for (int i = -reach; i <= reach; ++i) {
      starts.push_back(unknowns.start());
      starts.back()[unknowns.contact()] = i * step;
      const bool admitted = unknowns.admits(starts.back());
      costs.push_back(admitted ? likelihood.cost(unknowns.model(starts.back())) : kNever);
      evaluations_ += admitted ? 1 : 0;
    }
    costs.push_back(kNever);
    std::vector<Eigen::VectorXd> lowest;
    for (std::size_t i = 0; i < starts.size(); ++i) {
      const double cost = costs[i + 1];
      if (cost < kNever && cost <= costs[i] && cost <= costs[i + 2]) lowest.push_back(starts[i]);
    }
    return lowest;
  }

  // f_0, B and x_c through the ladder, from the x_c that serves best.
  void follow_law(double shift) {
    const HeldParameters& held = priors_.held();
    if (held.fundamental) shift = 0.0;
    const double step = initial_.basis.length / 660.0;
    const ProjectedLikelihood widest = damped(200.0);
    const StringUnknowns unknowns =
        StringUnknowns::law(reference_, start_.fundamental * std::exp(shift), start_.inharmonicity,
                            {}, priors_)
            .without_damping_and_sensors();
    NewtonFit best;
    const int reach = held.contact(0) ? 0 : 4;
    for (const Eigen::VectorXd& theta : contact_starts(widest, unknowns, step, reach)) {
      NewtonFit found = fit(widest, unknowns, theta, with_priors(unknowns, theta, 25, 1e-2));
      if (found.objective < best.objective) best = std::move(found);
    }
    MODCAL_REQUIRE(best.theta.size() > 0, "the initial frequencies follow no law of a string");
    for (const double sigma : {100.0, 50.0}) {
      best = fit(damped(sigma), unknowns, best.theta, with_priors(unknowns, best.theta, 20, 1e-2));
    }
    law_ = StringUnknowns::law(reference_, start_.fundamental * std::exp(shift),
                               start_.inharmonicity, options_.unknowns, priors_);
    law_theta_ = Eigen::VectorXd::Zero(law_.size());
    law_theta_.head(3) = best.theta;
    law_theta_ = fit(damped(20.0), law_, law_theta_, with_priors(law_, law_theta_, 20, 1e-3)).theta;
    ladder_theta_ = law_theta_;
  }

  static double free_count(const StringUnknowns& unknowns) {
    return static_cast<double>(unknowns.size() - unknowns.held_count());
  }
  double reduced_chi2(const ModelPoint& point, double taken) {
    ++evaluations_;
    return 2.0 * whole_->cost(point) / (whole_->degrees_of_freedom(0, point) - taken);
  }

  // σ = 0, end state projected out, then once more with weights and without the noise in JᵀJ.
  void finish_law(ContinuationResult& result) {
    whole_.emplace(WhitenedRecord::of(records_, 0.0, highest_));
    result.chi2_deviation = std::hypot(
        std::sqrt(2.0 / whole_->degrees_of_freedom(free_count(law_), reference_)), noise_error_);
    law_theta_ = fit(*whole_, law_, law_theta_, with_priors(law_, law_theta_, 12, 1e-2)).theta;
    NewtonOptions options = with_priors(law_, law_theta_, 4, 1e-4);
    options.noise = prepare_weights(law_, law_theta_);
    const NewtonFit last = fit(*weighted_, law_, law_theta_, options);
    law_theta_ = last.theta;
    const Eigen::MatrixXd covariance = covariance_at(law_, law_theta_, options);
    LawEstimate& law = result.law;
    result.model = law_.model(law_theta_);
    law.fundamental = law_.fundamental(law_theta_);
    law.inharmonicity = law_theta_[1];
    law.contact = result.model.contact;
    law.damping = law_.damping_factor(law_theta_);
    for (std::size_t i = 0; i < 3; ++i) {
      const auto j = static_cast<Eigen::Index>(i);
      law.deviation[i] = std::sqrt(std::max(covariance(j, j), 0.0));
    }
    law.deviation[0] *= law.fundamental;
    law.deviation[3] = law_.damping_deviation(covariance) * law.damping;
    law.chi2 = result.chi2 = reduced_chi2(result.model, free_count(law_));
    law.accepted = law.chi2 < 1.0 + 3.0 * result.chi2_deviation;
    law.priors = result.priors = law_.prior_misfit(law_theta_);
    result.contact_deviation = law.deviation[2];
    result.damping = law.damping;
    result.damping_deviation = law.deviation[3];
    result.damping_power = law_.damping_power(law_theta_);
    result.damping_power_deviation = law_.damping_power_deviation(covariance);
    result.sensor_deviation = law_.sensor_deviation(result.model, covariance);
    result.modes = law_verdicts(result.model, law.inharmonicity, covariance.topLeftCorner(2, 2));
    trust_stated_frequencies(priors_, {}, result.modes);
  }

  // Weights of the bins and N̄ under them, at θ.
  Eigen::MatrixXd prepare_weights(const StringUnknowns& unknowns, const Eigen::VectorXd& theta) {
    const ModelPoint point = unknowns.model(theta);
    weighted_ = whole_;
    weighted_->set_weights(information_weights(*whole_, point, unknowns.columns(theta)));
    return noise_at(unknowns, theta);
  }
  Eigen::MatrixXd noise_at(const StringUnknowns& unknowns, const Eigen::VectorXd& theta) const {
    return weighted_->noise_information(unknowns.model(theta), unknowns.columns(theta),
                                        kNoiseRepeats);
  }

  LikelihoodPoint whole_point(const StringUnknowns& unknowns, const Eigen::VectorXd& theta) {
    ++evaluations_;
    return weighted_->evaluate(unknowns.model(theta), unknowns.columns(theta),
                               {.twice_weighted = true});
  }
  Eigen::MatrixXd covariance_at(const StringUnknowns& unknowns, const Eigen::VectorXd& theta,
                                const NewtonOptions& options) {
    Eigen::MatrixXd covariance = fit_covariance(whole_point(unknowns, theta), options);
    unknowns.clear_held(covariance);
    return covariance;
  }

  void free_frequencies(ContinuationResult& result) {
    const bool from_law = result.law.accepted;
    const StringUnknowns unknowns = StringUnknowns::frequencies(
        law_.model(from_law ? law_theta_ : ladder_theta_), options_.unknowns, priors_);
    const double inharmonicity = from_law ? law_theta_[1] : ladder_theta_[1];
    const auto wide = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(modes()), kWidePrior);
    NewtonOptions options{.steps = 10, .tolerance = 1e-2, .frequency_cap = kStepCap};
    Eigen::VectorXd theta = unknowns.start();
    set_prior(unknowns.prior(theta, {wide, inharmonicity}), options);
    if (!from_law) theta = descend(unknowns, theta, options, result);
    theta = fit(*whole_, unknowns, theta, options).theta;
    // Where the law holds, its weights serve: a bin tells of every unknown by what force is in it.
    options.noise = from_law ? noise_at(unknowns, theta) : prepare_weights(unknowns, theta);
    options.steps = 5;
    theta = fit(*weighted_, unknowns, theta, options).theta;
    const LikelihoodPoint at = whole_point(unknowns, theta);
    // A prior of a mode's frequency is no sight of it.
    NewtonOptions unstated = options;
    set_prior(unknowns.under(priors_.without_frequencies()).prior(theta, {wide, inharmonicity}),
              unstated);
    Eigen::VectorXd seen = fit_covariance(at, unstated).diagonal().cwiseMax(0.0).cwiseSqrt();
    const ModelPoint seen_from = unknowns.model(theta);
    deny_noise(at.information, options.noise, nodes(seen_from.basis, {seen_from.contact}), seen);

    const auto n = static_cast<Eigen::Index>(modes());
    const double estimated = estimate_law_width(theta.head(n), seen.head(n), inharmonicity);
    result.law_width = std::isnan(options_.law_width) ? estimated : options_.law_width;
    Eigen::VectorXd widths = prior_widths(seen.head(n), result.law_width, estimated);
    widen_stated(priors_, result.law_width, widths);
    set_prior(unknowns.prior(theta, {widths, inharmonicity}), options);
    options.tolerance = 1e-4;
    theta = fit(*weighted_, unknowns, theta, options).theta;
    const LikelihoodPoint last = whole_point(unknowns, theta);
    Eigen::MatrixXd covariance = fit_covariance(last, options);
    unknowns.clear_held(covariance);
    report(unknowns, theta, covariance, seen, estimated, from_law ? law_theta_ : ladder_theta_,
           result);
    result.chi2 = reduced_chi2(result.model, taken_by_fit(last, options));
    result.priors = unknowns.prior_misfit(theta, {widths, inharmonicity});
  }

  // Free frequencies on damped records, where the law does not hold: wide basins first.
  Eigen::VectorXd descend(const StringUnknowns& unknowns, Eigen::VectorXd theta,
                          const NewtonOptions& options, ContinuationResult& result) {
    for (const double sigma : {40.0, 20.0, 10.0}) {
      const ProjectedLikelihood likelihood = damped(sigma);
      theta = fit(likelihood, unknowns, theta, options).theta;
      if (sigma > 10.0) continue;
      const std::size_t moved =
          leave_false_minima(likelihood, unknowns, {options.prior, options.prior_mean}, theta);
      result.moved_modes += moved;
      if (moved > 0) theta = fit(likelihood, unknowns, theta, options).theta;
    }
    return theta;
  }

  void report(const StringUnknowns& unknowns, const Eigen::VectorXd& theta,
              const Eigen::MatrixXd& covariance, const Eigen::VectorXd& seen, double estimated,
              const Eigen::VectorXd& law_theta, ContinuationResult& result) {
    result.frequencies_free = true;
    result.model = unknowns.model(theta);
    const Eigen::VectorXd deviation = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    result.contact_deviation = deviation[unknowns.contact()];
    // The law's damping made the reference of the free frequencies.
    result.damping = unknowns.damping_factor(theta) * law_.damping_factor(law_theta);
    result.damping_power = unknowns.damping_power(theta) + law_.damping_power(law_theta);
    result.damping_power_deviation = unknowns.damping_power_deviation(covariance);
    result.ratio_deviations = unknowns.ratio_deviations(covariance);
    result.damping_deviation = unknowns.damping_deviation(covariance) * result.damping;
    result.sensor_deviation = unknowns.sensor_deviation(result.model, covariance);
    const auto n = static_cast<Eigen::Index>(modes());
    result.modes = free_verdicts(result.model, deviation.head(n), seen.head(n), estimated);
    trust_stated_frequencies(priors_, deviation, result.modes);
  }

  const ModelPoint& initial_;
  const NoisyRecords& records_;
  const ContinuationOptions& options_;
  const StatedPriors& priors_;
  double highest_ = 0.0;      // [rad/s]
  double noise_error_ = 0.0;  // relative error of the noise power
  ModelPoint reference_;      // the initial model with the sensors stated
  StiffStringFit start_;
  double unit_ = 1.0;  // σ in proportion to f_0
  StringUnknowns law_;
  Eigen::VectorXd law_theta_, ladder_theta_;
  std::optional<ProjectedLikelihood> whole_, weighted_;
  std::size_t evaluations_;
};

}  // namespace

ContinuationResult attempt_continuation(const AttemptInput& input, double shift,
                                        std::size_t evaluations) {
  return Attempt(input, evaluations).run(shift);
}

}  // namespace modcal
