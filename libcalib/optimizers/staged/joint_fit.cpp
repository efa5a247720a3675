#include "libcalib/optimizers/staged/joint_fit.hpp"

#include <algorithm>
#include <cmath>

#include "libcalib/identifiability/joint_report.hpp"
#include "libcalib/identifiability/mode_verdict.hpp"
#include "libcalib/likelihood/all_records.hpp"
#include "libcalib/likelihood/bin_weights.hpp"
#include "libcalib/likelihood/mains_lines.hpp"
#include "libcalib/likelihood/records/noise_level.hpp"
#include "libcalib/likelihood/unknown_bounds.hpp"
#include "libcalib/optimizers/staged/newton_fit.hpp"
#include "libcalib/optimizers/staged/pluck_search.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

// The record to start from has the smallest χ²; its contact is that of the first.
StringUnknowns shared_unknowns(const ContinuationResult& fit, const ContinuationOptions& options,
                               const StatedPriors& priors) {
  const auto best = std::min_element(
      fit.single.begin(), fit.single.end(),
      [](const ContinuationResult& a, const ContinuationResult& b) { return a.chi2 < b.chi2; });
  ModelPoint reference = best->model;
  reference.contact = fit.single.front().model.contact;
  return options.frequencies
             ? StringUnknowns::frequencies(reference, options.unknowns, priors)
             : StringUnknowns::law(reference, best->law.fundamental, best->law.inharmonicity,
                                   options.unknowns, priors);
}

// The fit of all records, from their gathering to the report.
class JointFit {
 public:
  JointFit(const ModelPoint& initial, const ContinuationOptions& options,
           const StatedPriors& priors, Evaluator* within, ContinuationResult& fit)
      : initial_(initial),
        options_(options),
        priors_(priors),
        within_(within),
        fit_(fit),
        all_(shared_unknowns(fit, options, priors)) {}

  void add(const CalibrationData& stroke) {
    const ProjectedLikelihood whole(whitened(stroke, {options_.left_noise, options_.right_noise},
                                             &fit_.single[all_.records()]));
    ProjectedLikelihood weighted = whole;
    const Eigen::VectorXd start = unknowns().own_start(fit_.single[all_.records()].model);
    weighted.set_weights(weights(whole, start));
    all_.add(std::make_shared<StrokeLikelihood>(whole, std::move(weighted)), start,
             unknowns().own_places(true), priors_.fixed_contact(all_.records()));
  }

  void add(const PluckRecord& pluck) {
    plucks_.push_back(
        std::make_shared<PluckLikelihood>(whitened(pluck.data, pluck.noise, nullptr)));
    all_.add(plucks_.back(), unknowns().start(), unknowns().own_places(false));
  }

  void run() {
    theta_ = all_.start();
    NewtonOptions newton{.steps = 10, .tolerance = 1e-4, .frequency_cap = 1e-3};
    if (unknowns().is_law()) {
      state(equations(priors_, nullptr), newton);
      newton.noise = all_.noise(theta_);
      search("law", newton);
      fit_.priors = misfit(PriorEquations(all_.size()));
    } else {
      listen_to_plucks();
      free_frequencies(newton);
    }
    const LikelihoodPoint last = point(true);
    Eigen::MatrixXd covariance = fit_covariance(last, newton);
    covariance += covariance_of_causes(fit_.single, all_);
    all_.clear_held(covariance);
    report_joint_fit({.all = all_,
                      .initial = initial_,
                      .options = options_,
                      .priors = priors_,
                      .theta = theta_,
                      .seen = seen_,
                      .followers = followers_},
                     covariance, fit_);
    const LikelihoodPoint whole = all_.unweighted(theta_);
    const AllRecords::Misfit misfit = all_.misfit(theta_, whole.cost, noise_errors_,
                                                  taken_by_fit(last, newton, whole.information));
    fit_.chi2 = fit_.stages.back().chi2 = misfit.chi2;
    fit_.chi2_deviation = misfit.deviation;
    fit_.fits = fit_.chi2 < 1.0 + 3.0 * fit_.chi2_deviation;
    const bool explained = std::ranges::none_of(fit_.single, [](const auto& single) {
      const ScoreTest* cause = first_cause(single.tests);
      return cause && cause->refuses();
    });
    fit_.right = fit_.fits && !fit_.priors.contradicted() && !fit_.contradicts_itself() &&
                 explained && !tuned_apart(fit_.single);
    if (!unknowns().is_law()) return;
    fit_.law.chi2 = fit_.chi2;
    fit_.law.accepted = fit_.fits;
    fit_.law.priors = fit_.priors;
    fit_.found_law = FoundLaw::of(fit_.law);
  }

 private:
  const StringUnknowns& unknowns() const { return all_.unknowns(); }
  // As for one record: where the law holds, its unknowns say what the bins of the next record tell.
  // A mode in a node of the contact, free, would take the bins that tell the contact for its own.
  std::vector<double> weights(const ProjectedLikelihood& whole,
                              const Eigen::VectorXd& start) const {
    const std::size_t record = all_.records();
    const ContinuationResult& single = fit_.single[record];
    if (unknowns().is_law() || !single.law.accepted) {
      return information_weights(whole, unknowns().model(start), unknowns().columns(start, record));
    }
    const StringUnknowns law = StringUnknowns::law(
        single.model, single.law.fundamental, single.law.inharmonicity, options_.unknowns, priors_);
    return information_weights(whole, law.model(law.start()), law.columns(law.start(), record));
  }
  Index modes() const { return static_cast<Index>(unknowns().modes()); }
  double inharmonicity() const { return fit_.single.front().law.inharmonicity; }
  // stated: levels of the noise, or NaN; single: the fit of a stroke by itself, which has found its
  // noise, the lines of its hum and the causes of misfit that are free in it.
  WhitenedRecord whitened(const CalibrationData& data, const std::array<double, 2>& stated,
                          const ContinuationResult* single) {
    if (within_) within_->poll();
    noise_errors_.push_back(single ? single->noise_error
                                   : noise_power_error(stated, initial_.basis, data));
    const double band = likelihood_band(initial_, options_.highest_frequency, data.sample_rate);
    highest_ = std::max(highest_, band);
    NoisyRecords records =
        NoisyRecords::of_data(data, initial_.basis, single ? single->noise : stated);
    records.lines =
        single ? single->lines : mains_lines(records, initial_, options_.unknowns.mains);
    if (!single) return WhitenedRecord::of(records, 0.0, band);
    records.noise = single->noise_spectrum;
    for (const ScoreTest& cause : single->freed) {
      records.signals.insert(records.signals.end(), cause.columns.begin(), cause.columns.end());
    }
    return WhitenedRecord::of(records, 0.0, band);
  }
  LikelihoodPoint point(bool twice_weighted) {
    if (within_) within_->spend(1);
    ++fit_.evaluations;
    return all_.evaluate(theta_, twice_weighted);
  }

  // Priors about θ; widths of the frequencies' scatter about the law, or null.
  PriorEquations equations(const StatedPriors& priors, const Eigen::VectorXd* widths) const {
    PriorEquations result(all_.size());
    priors.state([&](const ParameterName& name) { return all_.coordinate(name, theta_); }, result);
    // About the damping stated: that of the strokes by themselves is in the data already.
    unknowns().state_widths(initial_.basis.zeta, result);
    if (widths) result.add_scatter({*widths, inharmonicity()}, unknowns().log_frequencies());
    all_.hold(result);
    return result;
  }
  PriorMisfit misfit(const PriorEquations& equations) const {
    return unknowns().worse_of_response(
        theta_,
        priors_.misfit([&](const ParameterName& name) { return all_.coordinate(name, theta_); },
                       equations.completed(theta_)));
  }
  static void state(const PriorEquations& equations, NewtonOptions& newton) {
    QuadraticPrior prior = equations.solve();
    newton.prior = std::move(prior.precision);
    newton.prior_mean = std::move(prior.mean);
  }

  void search(const char* stage, const NewtonOptions& newton) {
    ModelPoint initial = initial_;
    initial.sensors = options_.unknowns.sensors();
    const UnknownBounds bounds = unknown_bounds(all_, initial, options_.ranges);
    const NewtonFit found = newton_fit(
        {.evaluate = [this](const Eigen::VectorXd& theta) { return all_.evaluate(theta, false); },
         .admits = [this](const Eigen::VectorXd& theta) { return all_.admits(theta); },
         .capped = unknowns().is_law() ? 0 : modes(),
         .lower = bounds.lower,
         .upper = bounds.upper},
        theta_, newton, within_);
    theta_ = found.theta;
    fit_.evaluations += found.evaluations;
    fit_.stages.push_back(
        {.name = stage, .evaluations = fit_.evaluations, .objective = found.objective});
  }

  // Frequencies that no stroke identifies go where most of the plucks' power is, within ±0.6 %.
  void listen_to_plucks() {
    if (plucks_.empty()) return;
    for (Index i = 0; i < modes(); ++i) {
      const auto n = static_cast<std::size_t>(i);
      const bool identified =
          std::any_of(fit_.single.begin(), fit_.single.end(), [n](const ContinuationResult& r) {
            return r.modes[n].source == ModeSource::kIdentified;
          });
      if (!identified && !unknowns().held(i))
        theta_[i] += loudest_shift(plucks_, all_.model(theta_, 0), n);
    }
  }

  // What the data tell under a prior that only keeps a mode from wandering, then the law's.
  void free_frequencies(NewtonOptions& newton) {
    const Eigen::VectorXd wide = Eigen::VectorXd::Constant(modes(), kWidePrior);
    state(equations(priors_, &wide), newton);
    newton.noise = all_.noise(theta_);
    search("free, weighted bins", newton);
    const LikelihoodPoint at = point(true);
    // A prior of a mode's frequency is no sight of it.
    NewtonOptions unstated = newton;
    state(equations(priors_.without_frequencies(), &wide), unstated);
    const Eigen::VectorXd deviation =
        fit_covariance(at, unstated).diagonal().head(modes()).cwiseSqrt();
    const ModelPoint model = all_.model(theta_, 0);
    Eigen::VectorXd delta(modes());
    for (Index i = 0; i < modes(); ++i) {
      const double n = static_cast<double>(i + 1);
      delta[i] = std::log(model.basis.omega[static_cast<std::size_t>(i)] /
                          (n * std::sqrt(1.0 + inharmonicity() * n * n)));
    }
    ModeSight sight = sight_of(delta, deviation, at.information, newton.noise, nodes_of_all());
    leave_out_of_band(model, highest_, sight);
    followers_ = find_followers(sight, inharmonicity(), options_.law_width);
    deny_surprises(followers_, sight);
    const Eigen::VectorXd scatters = followers_.scatters(), alone = scatters.cwiseMax(wide);
    const LawPosterior law =
        law_of_step({equations(priors_, &scatters), equations(priors_, &alone)}, at, theta_, newton,
                    covariance_of_causes(fit_.single, all_));
    fit_.found_law = FoundLaw::of(law, priors_);
    fit_.law_width = followers_.prior_width;
    Eigen::VectorXd widths = prior_widths(sight.seen, fit_.law_width, followers_.width);
    widen_stated(priors_, fit_.law_width, widths);
    release(followers_, sight, widths);
    seen_ = sight.seen;
    state(equations(priors_, &widths), newton);
    search("free, prior as wide as the law's followers", newton);
    fit_.priors = misfit(equations(priors_, &widths));
  }

  // A mode at a node of every contact is no surprise to a pluck.
  std::vector<bool> nodes_of_all() const {
    if (!plucks_.empty()) return std::vector<bool>(unknowns().modes(), false);
    std::vector<double> contacts;
    for (std::size_t r = 0; r < fit_.single.size(); ++r) {
      contacts.push_back(all_.model(theta_, r).contact);
    }
    return nodes(all_.model(theta_, 0).basis, contacts);
  }

  const ModelPoint& initial_;
  const ContinuationOptions& options_;
  const StatedPriors& priors_;
  Evaluator* within_;
  ContinuationResult& fit_;
  AllRecords all_;
  std::vector<std::shared_ptr<const PluckLikelihood>> plucks_;
  std::vector<double> noise_errors_;
  double highest_ = 0.0;  // of the widest band [rad/s]
  Eigen::VectorXd theta_;
  Eigen::VectorXd seen_;  // of δ, under the wide prior
  LawFollowers followers_;
};

void run_fit(JointFit joint, std::span<const CalibrationData> strokes,
             std::span<const PluckRecord> plucks) {
  for (const CalibrationData& stroke : strokes) joint.add(stroke);
  for (const PluckRecord& pluck : plucks) joint.add(pluck);
  joint.run();
}

}  // namespace

void fit_jointly(const ModelPoint& initial, const ContinuationOptions& options,
                 const StatedPriors& priors, std::span<const CalibrationData> strokes,
                 std::span<const PluckRecord> plucks, Evaluator* within, ContinuationResult& fit) {
  run_fit({initial, options, priors, within, fit}, strokes, plucks);
  if (!options.frequencies) return;
  // Frequencies that are free say what the law is only as far as they may leave it.
  ContinuationOptions law_alone = options;
  law_alone.frequencies = false;
  ContinuationResult alone{.single = fit.single};
  const std::vector<std::size_t> others = not_following(fit.modes);
  for (ContinuationResult& single : alone.single) {
    for (const std::size_t n : others) {
      single.model.basis.omega[n] = fit.model.basis.omega[n];
    }
  }
  const StatedPriors held = priors.fixing(others);
  run_fit({initial, law_alone, held, within, alone}, strokes, plucks);
  fit.law = alone.law;
  append_stages(alone.stages, "", fit.evaluations, fit.stages);
  fit.evaluations += alone.evaluations;
  std::vector<ScoreTest> tests;
  for (const ContinuationResult& single : fit.single) {
    tests.insert(tests.end(), single.tests.begin(), single.tests.end());
  }
  report_departures(tests, fit);
}

}  // namespace modcal
