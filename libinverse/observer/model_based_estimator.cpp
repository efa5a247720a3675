#include "libinverse/observer/model_based_estimator.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "libinverse/observer/innovation_fit.hpp"
#include "libinverse/observer/model_check.hpp"
#include "libinverse/observer/tuning.hpp"
#include "libsim/base/error.hpp"
#include "libsim/base/task_loop.hpp"
#include "libsim/signal/fft.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {

using namespace observer;

namespace {

// Force noise of the gains over the static friction force: the first contracts from bad parameters,
// the last trusts good ones.
constexpr std::array kForceNoise = {0.075, 0.025, 0.0125, 0.0075, 0.0025};
constexpr std::size_t kWide = 0, kMiddle = 1, kNarrow = 2, kTrusting = 4;
constexpr std::array<std::size_t, 4> kBeam = {0, 1, 3, 4};
constexpr std::uint64_t kNoiseSeed = 0x6f627376;  // fixed: the result depends on the record alone

// Samples of a signal without content above half the rate from its means m_k over [t_k, t_{k+1}]:
// M = F e^{iωT/2} sin(ωT/2)/(ωT/2).
std::vector<double> from_means(const std::vector<double>& means) {
  const RealFft fft(means.size());
  std::vector<Complex> spectrum = fft.forward(means);
  for (std::size_t k = 1; k < spectrum.size(); ++k) {
    const double half =
        std::numbers::pi * static_cast<double>(k) / static_cast<double>(means.size());
    spectrum[k] *= std::polar(half / std::sin(half), -half);
  }
  return fft.inverse(std::move(spectrum));
}

class Estimation {
 public:
  Estimation(const ModelBasedOptions& options, ObservedRecord record, Estimate joint,
             const StopToken& stop)
      : options_(options), record_(std::move(record)), joint_(std::move(joint)), stop_(stop) {
    for (int r = 0; r < 2; ++r) offset_deviation_[r] = offset_deviation(record_, r);
  }

  ModelBasedResult run() {
    LinearEstimate linear = linear_estimate(record_);
    if (bow_direction(linear) < 0.0) {
      negate(record_);
      for (auto* signal : {&linear.force, &linear.velocity}) negate(*signal);
    }
    const ContactPicture picture = picture_of(linear);
    std::vector<double> force_noise(kForceNoise.begin(), kForceNoise.end());
    for (double& q : force_noise) q *= picture.static_force;
    Substeps substeps;
    substeps.coarse = static_cast<std::size_t>(options_.substeps);
    substeps.fine = 16;
    runs_ = std::make_unique<ObserverRuns>(record_, force_noise, substeps);
    ParameterSpace space = best_start(picture);
    space = fitted(space, {kWide}, 8);
    free_more(options_, runs_->string().mode, space);
    if (options_.frees_more()) space = fitted(space, {kWide}, 8);
    const ModalBasis& basis = record_.basis;
    space = best_law(
        space, {.speed = picture.slip_speed,
                .period = 1.0 / basis.frequency(0),
                .share = std::min(record_.contact, basis.length - record_.contact) / basis.length});
    if (record_.noise[0] < kQuietNoise * standard_deviation(record_.reaction[0])) {
      space = fitted(space, {kNarrow}, 6);
    }
    // What heats, cools and softens trade off against each other: only an observer that leans on
    // its model tells them apart.
    if (space.start().sliding.thermal) space = fitted(space, {kTrusting}, 12);
    GainSchedule schedule;
    for (std::int64_t round = 0; round < options_.rounds; ++round) {
      schedule = search_gains(*runs_, space.start(), kBeam);
      space = fitted(space, schedule, 4);
    }
    schedule = search_gains(*runs_, space.start(), kBeam);
    return finish(space.start(), schedule, linear);
  }

 private:
  ParameterSpace fitted(const ParameterSpace& space, const GainSchedule& schedule,
                        std::size_t iterations) {
    FitLimits limits;
    limits.iterations = iterations;
    limits.stop = stop_;
    const FitOutcome outcome = fit_innovations(*runs_, space, schedule, limits);
    run_count_ += outcome.runs;
    return space.restarted_at(outcome.x);
  }

  // Every law is judged under gains of its own: one gain for all keeps bursts in which the observer
  // has lost the string, and they outweigh what tells the laws apart.
  ParameterSpace best_law(const ParameterSpace& space, const SlipPicture& slip) {
    std::vector<ParameterSpace> fits;
    for (const std::string& law : options_.laws) {
      const std::optional<ParameterSpace> carried = with_friction_law(space, law, slip);
      ParameterSpace fit = carried ? fitted(*carried, {kWide}, 8) : space;
      fit = fitted(fit, {kMiddle}, 8);
      GainSchedule schedule = {kMiddle};
      if (options_.laws.size() > 1) {
        fit = fitted(fit, search_gains(*runs_, fit.start(), kBeam), 4);
        schedule = search_gains(*runs_, fit.start(), kBeam);
      }
      fits.push_back(fit);
      candidates_.push_back(judge_friction_law(*runs_, fits.back(), law, schedule));
    }
    rank_friction_laws(candidates_);
    const auto named = std::find(options_.laws.begin(), options_.laws.end(), candidates_[0].law);
    return fits[static_cast<std::size_t>(named - options_.laws.begin())];
  }

  // Decay and adherence stiffness are not seen in the linear estimate: a grid, each corner fitted
  // for a moment on the first half.
  ParameterSpace best_start(const ContactPicture& picture) {
    const std::vector<FreeParameter> free =
        basic_parameters(picture.static_force, offset_deviation_);
    const double top = record_.basis.omega.back();
    const double stiffness = runs_->string().effective_mass * top * top;
    std::vector<ParameterSpace> starts;
    for (const double decay : {3.0, 8.0}) {
      for (const double stiff : {0.4, 4.0}) {
        ObserverParameters p;
        p.sliding.dynamic_force = picture.dynamic_force;
        p.sliding.force_drop = picture.static_force - picture.dynamic_force;
        p.sliding.decay = decay / picture.slip_speed;
        p.bow_velocity = picture.bow_velocity;
        p.stiffness = stiff * stiffness;
        std::copy_n(record_.offset, 2, p.offset);
        p.contact = record_.contact;
        starts.emplace_back(p, free);
      }
    }
    FitLimits limits;
    limits.iterations = 3;
    limits.samples = record_.samples() / 2;
    limits.stop = stop_;
    std::vector<FitOutcome> outcomes(starts.size());
    std::vector<double> score(starts.size());
    for_each_task(starts.size(), [&](std::size_t i) {
      outcomes[i] = fit_innovations(*runs_, starts[i], {kWide}, limits);
      starts[i] = starts[i].restarted_at(outcomes[i].x);
      score[i] = misfit(runs_->innovations(starts[i].start(), {kWide}, limits.samples));
    });
    for (const FitOutcome& outcome : outcomes) run_count_ += outcome.runs;
    return starts[static_cast<std::size_t>(std::min_element(score.begin(), score.end()) -
                                           score.begin())];
  }

  ModelBasedResult finish(const ObserverParameters& parameters, const GainSchedule& schedule,
                          LinearEstimate& linear) {
    require_finite_stiffness(*runs_, parameters, schedule);
    ModelBasedResult result;
    const Innovations innovations =
        runs_->innovations(parameters, schedule, record_.samples(), &result);
    result.misfit = misfit(innovations);
    result.steady_misfit = steady_misfit(innovations);
    result.deviation = runs_->deviation(parameters, schedule, kNoiseDraws, StreamKey(kNoiseSeed));
    for (auto* signal : {&result.deviation.force, &result.deviation.velocity}) {
      for (double& value : *signal) value *= kParameterShare;
    }
    require_no_ringing(result.force, record_.sample_rate);
    result.unaliased_force = from_means(result.mean_force);
    result.linear = std::move(linear);
    result.laws = candidates_;
    result.parameters = parameters;
    result.negated = record_.negated;
    if (record_.negated) {
      for (auto* signal :
           {&result.force, &result.velocity, &result.displacement, &result.unaliased_force,
            &result.linear.force, &result.linear.velocity}) {
        negate(*signal);
      }
    }
    std::copy_n(record_.raw_noise, 2, result.noise);
    result.force_noise = runs_->force_noise();
    result.gain_share.assign(result.force_noise.size(), 0.0);
    for (const std::size_t gain : schedule) {
      result.gain_share[gain] += 1.0 / static_cast<double>(schedule.size());
    }
    result.runs = run_count_;
    judge_misfit(record_, schedule, runs_->quiet_misfit(), result);
    result.static_part = static_recovery(record_, result);
    add_warnings(options_, record_, offset_deviation_, result);
    add_model_error(std::move(joint_), record_, result);
    return result;
  }

  const ModelBasedOptions& options_;
  ObservedRecord record_;
  Estimate joint_;
  const StopToken& stop_;
  double offset_deviation_[2] = {};
  std::unique_ptr<ObserverRuns> runs_;
  std::size_t run_count_ = 0;
  std::vector<FrictionCandidate> candidates_;
};

}  // namespace

ModelBasedEstimator::ModelBasedEstimator(ModelBasedOptions options) : options_(std::move(options)) {
  MODCAL_REQUIRE(!options_.laws.empty(), "no friction law to fit: state at least one of laws");
  for (const std::string& law : options_.laws) {
    const auto names = friction_law_names();
    MODCAL_REQUIRE(std::find(names.begin(), names.end(), law) != names.end(),
                   "unknown friction law \"{}\": {} can be fitted", law, fmt::join(names, ", "));
  }
}

ModelBasedResult ModelBasedEstimator::estimate(const ModalBasis& basis, double contact,
                                               double sample_rate, std::span<const double> left,
                                               std::span<const double> right, const StopToken& stop,
                                               bool recorded, std::optional<bool> bending) const {
  ObservedRecord record =
      observe_record(basis, contact, sample_rate, left, right, options_.noise_rms);
  Estimate joint = joint_estimate({basis, contact, left.size(), sample_rate, recorded, bending},
                                  {left, right}, options_.noise_rms);
  if (recorded) take_noise(joint, options_.noise_rms, record);
  return Estimation(options_, std::move(record), std::move(joint), stop).run();
}

}  // namespace modcal
