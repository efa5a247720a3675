#include "libcalib/likelihood/records_fit.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "libcalib/likelihood/bin_weights.hpp"
#include "libcalib/likelihood/mode_verdict.hpp"
#include "libcalib/likelihood/newton_fit.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;
constexpr std::size_t kNoiseRepeats = 3;

// All records as one likelihood. Unknowns of the first record, then x_c of the others.
class AllRecords {
 public:
  AllRecords(const StringUnknowns& first, std::span<const double> contacts)
      : unknowns_(first), contacts_(contacts.begin(), contacts.end()) {}

  void add(ProjectedLikelihood whole, ProjectedLikelihood weighted) {
    whole_.push_back(std::move(whole));
    weighted_.push_back(std::move(weighted));
  }
  Index size() const { return unknowns_.size() + static_cast<Index>(contacts_.size()) - 1; }
  Index contact(std::size_t r) const {
    return r == 0 ? unknowns_.contact() : unknowns_.size() + static_cast<Index>(r) - 1;
  }
  const StringUnknowns& unknowns() const { return unknowns_; }
  Eigen::VectorXd start() const {
    Eigen::VectorXd theta = Eigen::VectorXd::Zero(size());
    theta.head(unknowns_.size()) = unknowns_.start();
    for (std::size_t r = 0; r < contacts_.size(); ++r) {
      theta[contact(r)] = contacts_[r] - contacts_[0];
    }
    return theta;
  }
  // θ of one record.
  Eigen::VectorXd own(const Eigen::VectorXd& theta, std::size_t r) const {
    Eigen::VectorXd part = theta.head(unknowns_.size());
    part[unknowns_.contact()] = theta[contact(r)];
    return part;
  }
  ModelPoint model(const Eigen::VectorXd& theta, std::size_t r) const {
    return unknowns_.model(own(theta, r));
  }
  bool admits(const Eigen::VectorXd& theta) const {
    for (std::size_t r = 0; r < contacts_.size(); ++r) {
      if (!unknowns_.admits(own(theta, r))) return false;
    }
    return true;
  }

  std::optional<LinearForm> coordinate(const UnknownName& name,
                                       const Eigen::VectorXd& theta) const {
    const std::optional<LinearForm> own = unknowns_.coordinate(name, this->own(theta, name.record));
    if (!own) return own;
    LinearForm form{.slope = Eigen::VectorXd::Zero(size() + 2), .offset = own->offset};
    for (Index i = 0; i < unknowns_.size(); ++i) form.slope[place(i, name.record)] = own->slope[i];
    form.slope.tail(2) = own->slope.tail(2);
    return form;
  }

  LikelihoodPoint evaluate(const Eigen::VectorXd& theta, bool twice_weighted) const {
    LikelihoodPoint sum{.slope = Eigen::VectorXd::Zero(size()),
                        .information = Eigen::MatrixXd::Zero(size(), size())};
    if (twice_weighted) sum.twice_weighted = sum.information;
    for (std::size_t r = 0; r < weighted_.size(); ++r) {
      const LikelihoodPoint point = weighted_[r].evaluate(
          model(theta, r), unknowns_.columns(own(theta, r)), {.twice_weighted = twice_weighted});
      sum.cost += point.cost;
      for (Index i = 0; i < unknowns_.size(); ++i) sum.slope[place(i, r)] += point.slope[i];
      add_to(sum.information, point.information, r);
      if (twice_weighted) add_to(sum.twice_weighted, point.twice_weighted, r);
    }
    return sum;
  }
  Eigen::MatrixXd noise(const Eigen::VectorXd& theta) const {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(size(), size());
    for (std::size_t r = 0; r < weighted_.size(); ++r) {
      add_to(sum,
             weighted_[r].noise_information(model(theta, r), unknowns_.columns(own(theta, r)),
                                            kNoiseRepeats),
             r);
    }
    return sum;
  }
  // Reduced χ² of all records and its standard deviation.
  std::pair<double, double> chi2(const Eigen::VectorXd& theta) const {
    double cost = 0.0;
    double freedom = -static_cast<double>(size());
    for (std::size_t r = 0; r < whole_.size(); ++r) {
      cost += whole_[r].cost(model(theta, r));
      freedom += whole_[r].degrees_of_freedom(0, unknowns_.modes());
    }
    return {2.0 * cost / freedom, std::sqrt(2.0 / freedom)};
  }

 private:
  Index place(Index i, std::size_t r) const { return i == unknowns_.contact() ? contact(r) : i; }
  void add_to(Eigen::MatrixXd& sum, const Eigen::MatrixXd& part, std::size_t r) const {
    for (Index i = 0; i < part.rows(); ++i) {
      for (Index j = 0; j < part.cols(); ++j) sum(place(i, r), place(j, r)) += part(i, j);
    }
  }

  StringUnknowns unknowns_;
  std::vector<double> contacts_;
  std::vector<ProjectedLikelihood> whole_, weighted_;
};

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

// The law's prior is as wide as the record that departs furthest from it says.
NewtonOptions newton_options(const AllRecords& all, const StatedPriors& priors,
                             const Eigen::VectorXd& start, const RecordsFit& fit) {
  const StringUnknowns& unknowns = all.unknowns();
  PriorEquations equations(all.size());
  priors.state([&](const UnknownName& name) { return all.coordinate(name, start); }, equations);
  unknowns.state_damping_ratios(equations);
  if (!unknowns.is_law()) {
    double width = 0.0;
    for (const ContinuationResult& single : fit.single) width = std::max(width, single.law_width);
    equations.add_scatter({Eigen::VectorXd::Constant(static_cast<Index>(unknowns.modes()), width),
                           fit.single.front().law.inharmonicity},
                          unknowns.log_frequencies());
  }
  QuadraticPrior prior = equations.solve();
  return {.steps = 10,
          .tolerance = 1e-4,
          .frequency_cap = 1e-3,
          .prior = std::move(prior.precision),
          .prior_mean = std::move(prior.mean)};
}

void report(const AllRecords& all, const Eigen::VectorXd& theta, const Eigen::MatrixXd& covariance,
            const ModelPoint& initial, RecordsFit& fit) {
  const StringUnknowns& unknowns = all.unknowns();
  const Eigen::VectorXd deviation = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  fit.model = all.model(theta, 0);
  for (std::size_t r = 0; r < fit.single.size(); ++r) {
    fit.contacts.push_back(all.model(theta, r).contact);
    fit.contact_deviations.push_back(deviation[all.contact(r)]);
  }
  if (unknowns.is_law()) {
    fit.fundamental = unknowns.fundamental(theta);
    fit.inharmonicity = theta[1];
    fit.fundamental_deviation = fit.fundamental * deviation[0];
    fit.inharmonicity_deviation = deviation[1];
  } else {
    const auto frequencies = deviation.head(static_cast<Index>(unknowns.modes()));
    fit.frequency_deviations.assign(frequencies.begin(), frequencies.end());
  }
  double change = 0.0;
  for (std::size_t n = 0; n < unknowns.modes(); ++n) {
    change += std::log(fit.model.basis.zeta[n] / initial.basis.zeta[n]);
  }
  fit.damping = std::exp(change / static_cast<double>(unknowns.modes()));
  fit.damping_deviation = fit.damping * unknowns.damping_deviation(covariance);
  const double unit[] = {fit.model.sensors.gain, 1.0, 0.5 / std::numbers::pi};
  for (std::size_t i = 0; i < 3; ++i) {
    const Index at = unknowns.sensor(i);
    fit.sensor_deviation[i] = at < 0 ? 0.0 : unit[i] * deviation[at];
  }
}

}  // namespace

RecordsFit calibrate_records(const ModelPoint& initial, std::span<const CalibrationData> records,
                             const ContinuationOptions& options) {
  MODCAL_REQUIRE(!records.empty(), "a fit of several records needs at least {}", 1);
  ModelPoint stated = initial;
  stated.sensors = options.unknowns.sensors();
  const StatedPriors priors(options.unknowns, stated, records.size());
  RecordsFit fit;
  std::vector<double> contacts;
  for (std::size_t r = 0; r < records.size(); ++r) {
    fit.single.push_back(
        calibrate_by_continuation(initial, records[r], options, priors.of_record(r)));
    contacts.push_back(fit.single.back().model.contact);
  }
  const StringUnknowns unknowns = shared_unknowns(fit, options, priors);
  AllRecords all(unknowns, contacts);
  const Eigen::VectorXd start = all.start();
  for (std::size_t r = 0; r < records.size(); ++r) {
    const NoisyRecords noisy =
        NoisyRecords::of_data(records[r], {options.left_noise, options.right_noise});
    const double highest =
        likelihood_band(initial, options.highest_frequency, records[r].sample_rate);
    const ProjectedLikelihood whole(WhitenedRecord::of(noisy, 0.0, highest));
    ProjectedLikelihood weighted = whole;
    const ModelPoint point = all.model(start, r);
    const double sigma = 3.0 * point.basis.frequency(0) / 196.0;
    weighted.set_weights(signal_weights(noisy, sigma, highest, whole, point));
    all.add(whole, std::move(weighted));
  }
  NewtonOptions newton = newton_options(all, priors, start, fit);
  newton.noise = all.noise(start);
  const NewtonFit found = newton_fit(
      {.evaluate = [&](const Eigen::VectorXd& theta) { return all.evaluate(theta, false); },
       .admits = [&](const Eigen::VectorXd& theta) { return all.admits(theta); },
       .capped = unknowns.is_law() ? 0 : static_cast<Index>(unknowns.modes())},
      start, newton);
  report(all, found.theta, fit_covariance(all.evaluate(found.theta, true), newton), initial, fit);
  std::tie(fit.chi2, fit.chi2_deviation) = all.chi2(found.theta);
  fit.right = fit.chi2 < 1.0 + 3.0 * fit.chi2_deviation;
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
  if (!result.frequencies_free) {
    result.law.fundamental = fit.fundamental;
    result.law.inharmonicity = fit.inharmonicity;
    result.law.contact = fit.model.contact;
    result.law.damping = fit.damping;
    result.law.deviation = {fit.fundamental_deviation, fit.inharmonicity_deviation,
                            result.contact_deviation, fit.damping_deviation};
  }
  for (std::size_t n = 0; n < result.modes.size(); ++n) {
    for (const ContinuationResult& single : fit.single) {
      if (single.modes[n].deviation < result.modes[n].deviation) result.modes[n] = single.modes[n];
    }
    result.modes[n].frequency = fit.model.basis.frequency(n);
    if (!fit.frequency_deviations.empty()) {
      result.modes[n].deviation = fit.frequency_deviations[n];
    }
  }
  result.evaluations = 0;
  for (const ContinuationResult& single : fit.single) result.evaluations += single.evaluations;
  return result;
}

}  // namespace modcal
