#include "libcalib/likelihood/records_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcalib/likelihood/all_records.hpp"
#include "libcalib/likelihood/bin_weights.hpp"
#include "libcalib/likelihood/mode_verdict.hpp"
#include "libcalib/likelihood/newton_fit.hpp"
#include "libcalib/likelihood/pluck_likelihood.hpp"
#include "libcalib/likelihood/stated_verdict.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;
constexpr double kProof = 3.0;
constexpr double kNodeProof = 10.0;
constexpr double kNodeShape = 0.05;
constexpr double kReach = 6e-3;

// The record to start from has the smallest χ²; its contact is that of the first.
StringUnknowns shared_unknowns(const RecordsFit& fit, const ContinuationOptions& options,
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

// Relative standard deviation of an estimated noise power, see noise_deviation().
double noise_error(const std::array<double, 2>& stated, std::size_t samples) {
  const bool estimated = std::isnan(stated[0]) || std::isnan(stated[1]);
  return estimated ? 1e-2 * std::sqrt(51200.0 / static_cast<double>(samples)) : 0.0;
}

// The fit of all records, from their gathering to the report.
class JointFit {
 public:
  JointFit(const ModelPoint& initial, const ContinuationOptions& options,
           const StatedPriors& priors, RecordsFit& fit)
      : initial_(initial),
        options_(options),
        priors_(priors),
        fit_(fit),
        all_(shared_unknowns(fit, options, priors)) {}

  void add(const CalibrationData& stroke) {
    const std::array<double, 2> noise{options_.left_noise, options_.right_noise};
    const NoisyRecords noisy = NoisyRecords::of_data(stroke, noise);
    const double highest =
        likelihood_band(initial_, options_.highest_frequency, stroke.sample_rate);
    const ProjectedLikelihood whole(WhitenedRecord::of(noisy, 0.0, highest));
    ProjectedLikelihood weighted = whole;
    Eigen::VectorXd start = unknowns().start();
    start[unknowns().contact()] =
        fit_.single[all_.records()].model.contact - fit_.single.front().model.contact;
    const ModelPoint point = unknowns().model(start);
    const double sigma = 3.0 * point.basis.frequency(0) / 196.0;
    weighted.set_weights(signal_weights(noisy, sigma, highest, whole, point));
    all_.add(std::make_shared<StrokeLikelihood>(whole, std::move(weighted)), start,
             {unknowns().contact()}, held_contact(all_.records()));
    noise_errors_.push_back(noise_error(noise, stroke.samples));
  }

  void add(const PluckRecord& pluck) {
    const NoisyRecords noisy = NoisyRecords::of_data(pluck.data, pluck.noise);
    const double highest =
        likelihood_band(initial_, options_.highest_frequency, pluck.data.sample_rate);
    plucks_.push_back(std::make_shared<PluckLikelihood>(WhitenedRecord::of(noisy, 0.0, highest)));
    all_.add(plucks_.back(), unknowns().start(), {});
    noise_errors_.push_back(noise_error(pluck.noise, pluck.data.samples));
  }

  void run() {
    theta_ = all_.start();
    NewtonOptions newton{.steps = 10, .tolerance = 1e-4, .frequency_cap = 1e-3};
    if (unknowns().is_law()) {
      state(nullptr, newton);
      newton.noise = all_.noise(theta_);
      search(newton);
    } else {
      listen_to_plucks();
      free_frequencies(newton);
    }
    Eigen::MatrixXd covariance = fit_covariance(point(true), newton);
    all_.clear_held(covariance);
    report(covariance);
    const AllRecords::Misfit misfit = all_.misfit(theta_, noise_errors_);
    fit_.chi2 = misfit.chi2;
    fit_.chi2_deviation = misfit.deviation;
    fit_.right = fit_.chi2 < 1.0 + 3.0 * fit_.chi2_deviation;
  }

 private:
  const StringUnknowns& unknowns() const { return all_.unknowns(); }
  Index modes() const { return static_cast<Index>(unknowns().modes()); }
  double inharmonicity() const { return fit_.single.front().law.inharmonicity; }
  std::optional<double> held_contact(std::size_t record) const {
    const HeldParameters& held = priors_.held();
    return held.contact(record) ? held.contacts[record] : std::nullopt;
  }
  LikelihoodPoint point(bool twice_weighted) {
    ++fit_.evaluations;
    return all_.evaluate(theta_, twice_weighted);
  }

  // Priors about θ; widths of the frequencies' scatter about the law, or null.
  void state(const Eigen::VectorXd* widths, NewtonOptions& newton) const {
    PriorEquations equations(all_.size());
    priors_.state([&](const UnknownName& name) { return all_.coordinate(name, theta_); },
                  equations);
    unknowns().state_damping_ratios(equations);
    if (widths) equations.add_scatter({*widths, inharmonicity()}, unknowns().log_frequencies());
    all_.hold(equations);
    QuadraticPrior prior = equations.solve();
    newton.prior = std::move(prior.precision);
    newton.prior_mean = std::move(prior.mean);
  }

  void search(const NewtonOptions& newton) {
    const NewtonFit found = newton_fit(
        {.evaluate = [this](const Eigen::VectorXd& theta) { return all_.evaluate(theta, false); },
         .admits = [this](const Eigen::VectorXd& theta) { return all_.admits(theta); },
         .capped = unknowns().is_law() ? 0 : modes()},
        theta_, newton);
    theta_ = found.theta;
    fit_.evaluations += found.evaluations;
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
      if (!identified && !unknowns().held(i)) theta_[i] += loudest_shift(n);
    }
  }

  double loudest_shift(std::size_t mode) const {
    const ModelPoint here = all_.model(theta_, 0);
    const double zeta = here.basis.zeta[mode];
    const auto power = [&](double shift) {
      const double omega = here.basis.omega[mode] * std::exp(shift);
      double sum = 0.0;
      for (const auto& pluck : plucks_) {
        const Complex rate(-zeta * omega, omega * std::sqrt(1.0 - zeta * zeta));
        sum += pluck->power_about(std::exp(rate / pluck->record().sample_rate), omega);
      }
      return sum;
    };
    // A move must explain more than noise does: its largest of some tens of places.
    double best = power(0.0) + 20.0, found = 0.0;
    const double step = 0.5 * zeta;
    for (double shift = -kReach; shift <= kReach; shift += step) {
      if (const double value = power(shift); value > best) {
        best = value;
        found = shift;
      }
    }
    return found;
  }

  // What the data tell under a prior that only keeps a mode from wandering, then the law's.
  void free_frequencies(NewtonOptions& newton) {
    const Eigen::VectorXd wide = Eigen::VectorXd::Constant(modes(), kWidePrior);
    state(&wide, newton);
    newton.noise = all_.noise(theta_);
    search(newton);
    const LikelihoodPoint at = point(true);
    seen_ = fit_covariance(at, newton).diagonal().head(modes()).cwiseMax(0.0).cwiseSqrt();
    deny_noise(at.information, newton.noise);
    const ModelPoint model = all_.model(theta_, 0);
    Eigen::VectorXd delta(modes());
    for (Index i = 0; i < modes(); ++i) {
      const double n = static_cast<double>(i + 1);
      delta[i] = std::log(model.basis.omega[static_cast<std::size_t>(i)] /
                          (n * std::sqrt(1.0 + inharmonicity() * n * n)));
    }
    estimated_ = estimate_law_width(delta, seen_, inharmonicity());
    fit_.law_width = std::isnan(options_.law_width) ? estimated_ : options_.law_width;
    Eigen::VectorXd widths = prior_widths(seen_, fit_.law_width, estimated_);
    widen_held(priors_.held(), fit_.law_width, widths);
    state(&widths, newton);
    search(newton);
  }

  // As in the fit of one record; a mode at a node of every contact is no surprise to a pluck.
  void deny_noise(const Eigen::MatrixXd& information, const Eigen::MatrixXd& noise) {
    for (Index i = 0; i < modes(); ++i) {
      bool node = plucks_.empty();
      for (std::size_t r = 0; node && r < fit_.single.size(); ++r) {
        const ModelPoint model = all_.model(theta_, r);
        node =
            std::abs(model.basis.shape_at(model.contact)[static_cast<std::size_t>(i)]) < kNodeShape;
      }
      const double proof = node ? kNodeProof : kProof;
      if (information(i, i) < proof * noise(i, i)) seen_[i] = std::max(seen_[i], kWidePrior);
    }
  }

  void report(const Eigen::MatrixXd& covariance) {
    const Eigen::VectorXd deviation = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
    fit_.model = all_.model(theta_, 0);
    for (std::size_t r = 0; r < fit_.single.size(); ++r) {
      fit_.contacts.push_back(all_.model(theta_, r).contact);
      fit_.contact_deviations.push_back(deviation[all_.place(unknowns().contact(), r)]);
    }
    if (unknowns().is_law()) {
      fit_.fundamental = unknowns().fundamental(theta_);
      fit_.inharmonicity = theta_[1];
      fit_.fundamental_deviation = fit_.fundamental * deviation[0];
      fit_.inharmonicity_deviation = deviation[1];
    } else {
      const auto frequencies = deviation.head(modes());
      fit_.frequency_deviations.assign(frequencies.begin(), frequencies.end());
      fit_.modes = free_verdicts(fit_.model, frequencies, seen_, estimated_);
      trust_stated_frequencies(priors_, deviation, fit_.modes);
    }
    report_damping_and_sensors(covariance, deviation);
  }

  void report_damping_and_sensors(const Eigen::MatrixXd& covariance,
                                  const Eigen::VectorXd& deviation) {
    double change = 0.0, count = 0.0;
    for (std::size_t n = 0; n < unknowns().modes(); ++n) {
      if (priors_.held().ratio(n)) continue;
      change += std::log(fit_.model.basis.zeta[n] / initial_.basis.zeta[n]);
      count += 1.0;
    }
    fit_.damping = std::exp(change / std::max(count, 1.0));
    fit_.damping_deviation = fit_.damping * unknowns().damping_deviation(covariance);
    const double unit[] = {fit_.model.sensors.gain, 1.0, 0.5 / std::numbers::pi};
    for (std::size_t i = 0; i < 3; ++i) {
      const Index at = unknowns().sensor(i);
      fit_.sensor_deviation[i] = at < 0 ? 0.0 : unit[i] * deviation[at];
    }
  }

  const ModelPoint& initial_;
  const ContinuationOptions& options_;
  const StatedPriors& priors_;
  RecordsFit& fit_;
  AllRecords all_;
  std::vector<std::shared_ptr<const PluckLikelihood>> plucks_;
  std::vector<double> noise_errors_;
  Eigen::VectorXd theta_;
  Eigen::VectorXd seen_;    // of δ, under the wide prior
  double estimated_ = 0.0;  // τ
};

}  // namespace

RecordsFit calibrate_records(const ModelPoint& initial, std::span<const CalibrationData> strokes,
                             const ContinuationOptions& options,
                             std::span<const PluckRecord> plucks) {
  MODCAL_REQUIRE(!strokes.empty(), "a fit of several records needs at least {} stroke", 1);
  ModelPoint stated = initial;
  stated.sensors = options.unknowns.sensors();
  const StatedPriors priors(options.unknowns, stated, strokes.size());
  RecordsFit fit;
  for (std::size_t r = 0; r < strokes.size(); ++r) {
    fit.single.push_back(
        calibrate_by_continuation(initial, strokes[r], options, priors.of_record(r)));
  }
  JointFit joint(initial, options, priors, fit);
  for (const CalibrationData& stroke : strokes) joint.add(stroke);
  for (const PluckRecord& pluck : plucks) joint.add(pluck);
  joint.run();
  return fit;
}

ContinuationResult as_continuation(const RecordsFit& fit) {
  ContinuationResult result = fit.single.front();
  result.model = fit.model;
  result.contact_deviation = fit.contact_deviations.front();
  result.damping = fit.damping;
  result.damping_deviation = fit.damping_deviation;
  result.sensor_deviation = fit.sensor_deviation;
  result.chi2 = fit.chi2;
  result.chi2_deviation = fit.chi2_deviation;
  result.right = fit.right;
  if (result.frequencies_free) {
    result.modes = fit.modes;
    result.law_width = fit.law_width;
  } else {
    result.law.fundamental = fit.fundamental;
    result.law.inharmonicity = fit.inharmonicity;
    result.law.contact = fit.model.contact;
    result.law.damping = fit.damping;
    result.law.deviation = {fit.fundamental_deviation, fit.inharmonicity_deviation,
                            result.contact_deviation, fit.damping_deviation};
    for (std::size_t n = 0; n < result.modes.size(); ++n) {
      result.modes[n].frequency = fit.model.basis.frequency(n);
    }
  }
  result.evaluations = fit.evaluations;
  for (const ContinuationResult& single : fit.single) result.evaluations += single.evaluations;
  return result;
}

}  // namespace modcal
