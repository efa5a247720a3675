#include "libcalib/optimizers/staged/free_stage.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "libcalib/identifiability/joint_report.hpp"
#include "libcalib/identifiability/mode_verdict.hpp"
#include "libcalib/identifiability/neighbor_test.hpp"
#include "libcalib/likelihood/parameter_forms.hpp"
#include "libcalib/optimizers/staged/score_tests.hpp"
#include "libcalib/optimizers/staged/tuning.hpp"

namespace modcal {
namespace {

// Where the stage starts.
struct FreeStart {
  const StringUnknowns& law;
  const Eigen::VectorXd& theta;  // of the law's unknowns
  bool from_law = true;          // else the modes come through damped records
};

class FreeStage {
 public:
  FreeStage(const AttemptInput& input, const FreeStart& start, StrokeFit& stroke,
            ContinuationResult& result)
      : priors_(input.priors),
        options_(input.options),
        misfit_for_noise_(input.misfit_for_noise),
        highest_(input.highest),
        start_(start),
        stroke_(stroke),
        unknowns_(StringUnknowns::frequencies(start.law.model(start.theta), input.options.unknowns,
                                              input.priors)),
        inharmonicity_(start.theta[1]),
        theta_(unknowns_.start()),
        result_(result) {}

  void run() {
    see_modes();
    follow_law();
    if (has_moved()) {
      // What was seen of the law was so from where the modes were no more.
      search_from_here();
      see();
      follow_law();
    }
    const LikelihoodPoint last = stroke_.weighted_point(unknowns_, theta_);
    Eigen::MatrixXd covariance = fit_covariance(last, newton_);
    unknowns_.clear_held(covariance);
    result_.chi2 = stroke_.reduced_chi2(unknowns_, theta_, last, newton_);
    stroke_.end_stage("free, prior as wide as the law's followers", objective_, result_.chi2);
    result_.priors = unknowns_.prior_misfit(theta_, {widths_, inharmonicity_});
    if (options_.unknowns.tests) test(covariance.diagonal().cwiseSqrt());
    AllRecords one(unknowns_);
    one.add(nullptr, theta_, {});
    Eigen::MatrixXd of_causes = covariance_of_causes({&result_, 1}, one);
    unknowns_.clear_held(of_causes);
    report(covariance + of_causes, of_causes);
  }

 private:
  Eigen::Index modes() const { return static_cast<Eigen::Index>(unknowns_.modes()); }
  void search(std::string name, const ProjectedLikelihood& likelihood) {
    theta_ = stroke_.fit_stage(std::move(name), likelihood, unknowns_, theta_, newton_).theta;
  }
  void search_weighted() {
    const NewtonFit found = stroke_.fit(stroke_.weighted(), unknowns_, theta_, newton_);
    theta_ = found.theta;
    objective_ = found.objective;
  }
  QuadraticPrior prior() const { return {newton_.prior, newton_.prior_mean}; }

  // What the data tell under a prior that only keeps a mode from wandering.
  void see_modes() {
    set_prior(unknowns_.prior(theta_, {wide(), inharmonicity_}), newton_);
    if (!start_.from_law) descend();
    search("free, whole record", stroke_.whole());
    left_ = leave_neighbors(stroke_.whole());
    // Where the law holds, its weights serve: a bin tells of every unknown by what force is in it.
    newton_.noise = start_.from_law ? stroke_.noise_at(unknowns_, theta_)
                                    : stroke_.prepare_weights(unknowns_, theta_);
    newton_.steps = 5;
    search_weighted();
    stroke_.end_stage("free, weighted bins", objective_, std::numeric_limits<double>::quiet_NaN());
    see();
  }

  // Whether a mode that is well seen is not where it was seen.
  bool has_moved() const {
    for (Eigen::Index i = 0; i < modes(); ++i) {
      const bool well = sight_.seen[i] < kWellSeen;
      if (well && std::abs(theta_[i] - seen_at_[i]) > 3.0 * sight_.seen[i]) return true;
    }
    return false;
  }

  void search_from_here() {
    set_prior(unknowns_.prior(theta_, {wide(), inharmonicity_}), newton_);
    newton_.noise = stroke_.prepare_weights(unknowns_, theta_);
    search_weighted();
    stroke_.end_stage("free, weighted bins again", objective_,
                      std::numeric_limits<double>::quiet_NaN());
  }

  Eigen::VectorXd wide() const { return Eigen::VectorXd::Constant(modes(), kWidePrior); }

  // What the data tell of the modes here.
  void see() {
    at_ = stroke_.weighted_point(unknowns_, theta_);
    seen_at_ = theta_;
    // A prior of a mode's frequency is no sight of it.
    NewtonOptions unstated = newton_;
    set_prior(
        unknowns_.under(priors_.without_frequencies()).prior(theta_, {wide(), inharmonicity_}),
        unstated);
    const Eigen::VectorXd deviation = fit_covariance(at_, unstated).diagonal();
    const ModelPoint point = unknowns_.model(theta_);
    sight_ = sight_of(theta_.head(modes()), deviation.head(modes()).cwiseSqrt(), at_.information,
                      newton_.noise, nodes(point.basis, {point.contact}));
    leave_out_of_band(point, highest_, sight_);
    doubt_rivals(left_, sight_);
  }

  // Free frequencies on damped records, where the law does not hold: wide basins first.
  void descend() {
    for (const double sigma : {40.0, 20.0}) {
      search(stroke_.damped_name("free", sigma), stroke_.damped(sigma));
    }
    const ProjectedLikelihood last = stroke_.damped(10.0);
    search(stroke_.damped_name("free", 10.0), last);
    leave_neighbors(last);
  }

  // Until no mode has a better neighboring minimum, or moving it did not serve. Returns what is
  // left.
  std::vector<Neighbor> leave_neighbors(const ProjectedLikelihood& likelihood) {
    stroke_.poll();
    std::vector<Neighbor> found = neighbors(likelihood, unknowns_, prior(), theta_);
    for (std::size_t round = 0; round < kNeighborRounds; ++round) {
      Eigen::VectorXd start = theta_;
      const std::size_t moved = leave_false_minima(found, start);
      if (moved == 0) break;
      const double here = stroke_.cost(likelihood, unknowns_.model(theta_)) + prior().value(theta_);
      const NewtonFit there = stroke_.fit(likelihood, unknowns_, start, newton_);
      if (!(there.objective < here)) break;
      theta_ = there.theta;
      stroke_.end_stage(fmt::format("free, {} modes moved", moved), likelihood, unknowns_, there);
      result_.moved_modes += moved;
      found = neighbors(likelihood, unknowns_, prior(), theta_);
    }
    return found;
  }

  // The prior about the law, as wide as the modes say.
  void follow_law() {
    followers_ = find_followers(sight_, inharmonicity_, options_.law_width);
    deny_surprises(followers_, sight_);
    if (misfit_for_noise_) followers_.follow_all();
    result_.law_width = followers_.prior_width;
    widths_ = prior_widths(sight_.seen, followers_.prior_width, followers_.width);
    widen_stated(priors_, followers_.prior_width, widths_);
    release(followers_, sight_, widths_);
    newton_.at_start = &at_;
    if (start_.from_law && followers_.leaving() > 0) {
      newton_.noise = stroke_.prepare_weights(unknowns_, theta_);
      newton_.at_start = nullptr;
    }
    set_prior(unknowns_.prior(theta_, {widths_, inharmonicity_}), newton_);
    newton_.tolerance = 1e-4;
    newton_.steps = 20;
    search_weighted();
    newton_.at_start = nullptr;
  }

  void test(const Eigen::VectorXd& deviation) {
    stroke_.poll();
    result_.local = local_misfit(stroke_.whole(), unknowns_.model(theta_));
    result_.tests =
        score_tests(stroke_.weighted(), unknowns_, theta_, newton_, deviation, result_.chi2);
  }

  void report(const Eigen::MatrixXd& covariance, const Eigen::MatrixXd& of_causes) {
    result_.frequencies_free = true;
    result_.model = unknowns_.model(theta_);
    const Eigen::VectorXd deviation = covariance.diagonal().cwiseSqrt();
    // The law's damping made the reference of the free frequencies.
    const StringUnknowns& law = start_.law;
    const double damping = unknowns_.damping_factor(theta_) * law.damping_factor(start_.theta);
    report_record({unknowns_, theta_, result_.model, damping, covariance}, 0, true, result_);
    result_.damping_power = unknowns_.damping_power(theta_) + law.damping_power(start_.theta);
    result_.modes = free_verdicts(result_.model, deviation.head(modes()), sight_.seen, followers_);
    trust_stated_frequencies(priors_, deviation, result_.modes);
    result_.found_law = FoundLaw::of(found_law(of_causes), priors_);
    result_.covariance = named_covariance(unknowns_, theta_, result_.damping, covariance);
    raise_to_verdicts(result_.modes, result_.covariance);
  }

  LawPosterior found_law(const Eigen::MatrixXd& of_causes) const {
    const Eigen::VectorXd scatters = followers_.scatters();
    const auto stated = [&](const Eigen::VectorXd& widths) {
      return unknowns_.stated(seen_at_, {widths, inharmonicity_});
    };
    return law_of_step({stated(scatters), stated(scatters.cwiseMax(kWidePrior))}, at_, seen_at_,
                       newton_, of_causes);
  }

  const StatedPriors& priors_;
  const ContinuationOptions& options_;
  bool misfit_for_noise_;
  double highest_;
  const FreeStart& start_;
  StrokeFit& stroke_;
  StringUnknowns unknowns_;
  double inharmonicity_;
  NewtonOptions newton_{.steps = 10, .tolerance = 1e-2, .frequency_cap = kStepCap};
  Eigen::VectorXd theta_, widths_;
  Eigen::VectorXd seen_at_;
  LikelihoodPoint at_;      // where the modes were seen, with the weights of then
  double objective_ = 0.0;  // of the last fit with weights
  ModeSight sight_;
  std::vector<Neighbor> left_;  // better minima that moving did not reach
  LawFollowers followers_;
  ContinuationResult& result_;
};

}  // namespace

void free_frequencies(const AttemptInput& input, const FreeStarts& starts, StrokeFit& stroke,
                      ContinuationResult& result) {
  const ContinuationResult of_law = result;
  const auto from = [&](const Eigen::VectorXd& theta, bool from_law) {
    ContinuationResult found = of_law;
    FreeStage(input, {starts.law, theta, from_law}, stroke, found).run();
    return found;
  };
  const bool nearly = of_law.law.accepted || of_law.law.chi2 < kNearlyLaw;
  if (nearly) {
    result = from(starts.of_record, true);
    const bool fits = result.chi2 < 1.0 + 3.0 * result.chi2_deviation;
    if (of_law.law.accepted || (fits && !result.contradicts_itself())) return;
  }
  ContinuationResult of_ladder = from(starts.of_ladder, false);
  // Damped records have led modes away from where the law has them.
  if (!nearly && of_ladder.chi2 > of_law.law.chi2) result = from(starts.of_record, true);
  const bool is_first = !result.frequencies_free;
  if (is_first || of_ladder.chi2 < result.chi2) result = std::move(of_ladder);
}

}  // namespace modcal
