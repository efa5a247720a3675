#include "libcalib/identifiability/joint_report.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "libcalib/identifiability/mode_verdict.hpp"
#include "libcalib/likelihood/parameter_forms.hpp"
#include "libcalib/parameters/damping_choice.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

class JointReport {
 public:
  JointReport(const JointEstimate& estimate, ContinuationResult& fit) : at_(estimate), fit_(fit) {}

  void report(const Eigen::MatrixXd& covariance) {
    const Eigen::VectorXd deviation = covariance.diagonal().cwiseSqrt();
    fit_.model = at_.all.model(at_.theta, 0);
    if (unknowns().is_law()) {
      fit_.modes = law_verdicts(fit_.model, at_.theta[1], covariance.topLeftCorner(2, 2));
      trust_stated_frequencies(at_.priors, {}, fit_.modes);
    } else {
      const auto frequencies = deviation.head(modes());
      fit_.frequency_deviations.assign(frequencies.begin(), frequencies.end());
      fit_.modes = free_verdicts(fit_.model, frequencies, at_.seen, at_.followers);
      trust_stated_frequencies(at_.priors, deviation, fit_.modes);
    }
    for (std::size_t r = 0; r < at_.all.records(); ++r) {
      const ModelPoint model = at_.all.model(at_.theta, r);
      const Eigen::VectorXd theta = at_.all.own(at_.theta, r);
      const Eigen::MatrixXd of_theta = own(covariance, r);
      const RecordFit record{unknowns(), theta, model, damping_line(model).first, of_theta};
      report_record(record, r, r < fit_.single.size(), fit_);
      if (r == 0 && unknowns().is_law()) fit_.law = law_estimate(record);
    }
    fit_.damping_power = damping_line(fit_.model).second;
    report_covariance(covariance);
    if (unknowns().is_law()) fit_.law.covariance = fit_.covariance;
  }

 private:
  const StringUnknowns& unknowns() const { return at_.all.unknowns(); }
  Index modes() const { return static_cast<Index>(unknowns().modes()); }
  // Factor and exponent p of ζ_n = factor nᵖ ζ_n(initial), those aside that are held.
  std::pair<double, double> damping_line(const ModelPoint& point) const {
    std::vector<std::pair<double, double>> changes;  // (ln n, ln ζ_n/ζ_n(initial))
    for (std::size_t n = 0; n < unknowns().modes(); ++n) {
      if (at_.priors.fixes_ratio(n)) continue;
      changes.emplace_back(std::log(static_cast<double>(n + 1)),
                           std::log(point.basis.zeta[n] / at_.initial.basis.zeta[n]));
    }
    const DampingChoice free = damping_choice(at_.options.unknowns.damping);
    if (free != DampingChoice::kPower || changes.size() < 2) {
      return {std::exp(unknowns().mean_damping_change(at_.initial, point)), 0.0};
    }
    // All lie on one line.
    const auto& [a, low] = changes.front();
    const auto& [b, high] = changes.back();
    const double power = (high - low) / (b - a);
    return {std::exp(low - power * a), power};
  }

  void report_covariance(const Eigen::MatrixXd& covariance) {
    FormPoint at{.models = {}, .damping = {}, .strokes = fit_.single.size()};
    if (unknowns().is_law()) at.fundamental = unknowns().fundamental(at_.theta);
    for (std::size_t r = 0; r < at_.all.records(); ++r) {
      at.models.push_back(at_.all.model(at_.theta, r));
      at.damping.push_back(fit_.values[r].damping);
    }
    fit_.covariance = named_covariance(at_.all, at, covariance);
    raise_to_verdicts(fit_.modes, fit_.covariance);
  }

  // Of the unknowns of one record.
  Eigen::MatrixXd own(const Eigen::MatrixXd& covariance, std::size_t record) const {
    std::vector<Index> places;
    for (Index i = 0; i < unknowns().size(); ++i) places.push_back(at_.all.place(i, record));
    return covariance(places, places);
  }

  const JointEstimate& at_;
  ContinuationResult& fit_;
};

}  // namespace

void report_joint_fit(const JointEstimate& estimate, const Eigen::MatrixXd& covariance,
                      ContinuationResult& fit) {
  JointReport(estimate, fit).report(covariance);
}

void report_record(const RecordFit& record, std::size_t r, bool stroke, ContinuationResult& fit) {
  const auto& [unknowns, theta, model, damping, covariance] = record;
  if (stroke) {
    const Index contact = unknowns.contact();
    fit.contacts.resize(r + 1);
    fit.contacts[r] = model.contact;
    fit.contact_deviations.resize(r + 1);
    fit.contact_deviations[r] = std::sqrt(covariance(contact, contact));
  }
  fit.values.resize(r + 1);
  fit.values[r] = {.sensors = model.sensors,
                   .sensor_deviation = unknowns.sensor_deviation(model, covariance),
                   .damping = damping,
                   .damping_deviation = unknowns.damping_deviation(covariance) * damping};
  if (r > 0) return;
  fit.posterior = {unknowns, theta, covariance};
  fit.contact_deviation = fit.contact_deviations.front();
  fit.sensor_deviation = fit.values.front().sensor_deviation;
  fit.damping = damping;
  fit.damping_deviation = fit.values.front().damping_deviation;
  fit.damping_power_deviation = unknowns.damping_power_deviation(covariance);
  fit.ratio_deviations = unknowns.ratio_deviations(covariance);
  fit.response_deviations = unknowns.response_deviations(covariance);
}

LawEstimate law_estimate(const RecordFit& record) {
  const auto& [unknowns, theta, model, damping, covariance] = record;
  LawEstimate law{.fundamental = unknowns.fundamental(theta),
                  .inharmonicity = theta[1],
                  .contact = model.contact,
                  .damping = damping};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto j = static_cast<Index>(i);
    law.deviation[i] = std::sqrt(covariance(j, j));
  }
  law.deviation[0] *= law.fundamental;
  law.deviation[3] = unknowns.damping_deviation(covariance) * damping;
  return law;
}

Eigen::MatrixXd covariance_of_causes(std::span<const ContinuationResult> single,
                                     const AllRecords& all) {
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(all.size(), all.size());
  const Eigen::Index unknowns = all.unknowns().size();
  // A cause is one in all records.
  std::map<std::string, Eigen::VectorXd> changes;
  for (std::size_t r = 0; r < single.size(); ++r) {
    std::vector<Eigen::Index> places;
    Eigen::VectorXd part = Eigen::VectorXd::Ones(unknowns);
    for (Eigen::Index i = 0; i < unknowns; ++i) {
      const bool shared = single.size() > 1 && all.place(i, 0) == all.place(i, 1);
      if (shared) part[i] /= static_cast<double>(single.size());
      places.push_back(all.place(i, r));
    }
    for (const ScoreTest& test : single[r].tests) {
      if (test.moved.size() != unknowns) continue;
      Eigen::VectorXd& change =
          changes.try_emplace(test.cause, Eigen::VectorXd::Zero(all.size())).first->second;
      change(places) += part.cwiseProduct(test.suspected());
      if (test.untold.size() == 0) continue;
      covariance(places, places) += part.asDiagonal() * test.untold * part.asDiagonal();
    }
  }
  for (const auto& [cause, change] : changes) covariance += change * change.transpose();
  return covariance;
}

namespace {

TuningDifference difference(const ContinuationResult& first, const ContinuationResult& other) {
  double sum = 0.0, weights = 0.0;
  for (std::size_t n = 0; n < std::min(first.modes.size(), other.modes.size()); ++n) {
    const ModeVerdict &mine = first.modes[n], &its = other.modes[n];
    if (mine.source != ModeSource::kIdentified || its.source != ModeSource::kIdentified) continue;
    const double deviation = std::hypot(mine.data_deviation, its.data_deviation);
    if (!(deviation > 0.0)) continue;
    const double weight = 1.0 / (deviation * deviation);
    sum += weight * std::log(its.frequency / mine.frequency);
    weights += weight;
  }
  return {.relative = weights > 0.0 ? sum / weights : 0.0,
          .deviation = weights > 0.0 ? 1.0 / std::sqrt(weights) : 1.0};
}

}  // namespace

std::optional<TuningDifference> tuned_apart(const std::vector<ContinuationResult>& single) {
  std::optional<TuningDifference> farthest;
  double most = 3.0;
  for (std::size_t r = 1; r < single.size(); ++r) {
    TuningDifference found = difference(single.front(), single[r]);
    found.stroke = r;
    const double deviations = std::abs(found.relative) / found.deviation;
    if (!(deviations > most)) continue;
    most = deviations;
    farthest = found;
  }
  return farthest;
}

}  // namespace modcal
