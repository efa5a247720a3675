#include "libcalib/identifiability/joint_report.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "libcalib/identifiability/mode_verdict.hpp"
#include "libcalib/likelihood/parameter_forms.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

class JointReport {
 public:
  JointReport(const JointEstimate& estimate, ContinuationResult& fit) : at_(estimate), fit_(fit) {}

  void report(const Eigen::MatrixXd& covariance) {
    const Eigen::VectorXd deviation = covariance.diagonal().cwiseSqrt();
    fit_.model = at_.all.model(at_.theta, 0);
    for (std::size_t r = 0; r < fit_.single.size(); ++r) {
      fit_.contacts.push_back(at_.all.model(at_.theta, r).contact);
      fit_.contact_deviations.push_back(deviation[at_.all.place(unknowns().contact(), r)]);
    }
    if (unknowns().is_law()) {
      fit_.modes = law_verdicts(fit_.model, at_.theta[1], covariance.topLeftCorner(2, 2));
      trust_stated_frequencies(at_.priors, {}, fit_.modes);
    } else {
      const auto frequencies = deviation.head(modes());
      fit_.frequency_deviations.assign(frequencies.begin(), frequencies.end());
      fit_.modes = free_verdicts(fit_.model, frequencies, at_.seen, at_.followers);
      trust_stated_frequencies(at_.priors, deviation, fit_.modes);
    }
    for (std::size_t r = 0; r < at_.all.records(); ++r) report_values(covariance, r);
    // Shared by all: the first record's unknowns stand first.
    fit_.damping_power = damping_line(fit_.model).second;
    fit_.damping_power_deviation = unknowns().damping_power_deviation(covariance);
    fit_.ratio_deviations = unknowns().ratio_deviations(covariance);
    report_covariance(covariance);
    if (unknowns().is_law()) report_law(deviation);
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
    if (at_.options.unknowns.damping != "power" || changes.size() < 2) {
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

  void report_law(const Eigen::VectorXd& deviation) {
    const RecordValues& first = fit_.values.front();
    fit_.law = {.fundamental = unknowns().fundamental(at_.theta),
                .inharmonicity = at_.theta[1],
                .contact = fit_.model.contact,
                .damping = first.damping};
    fit_.law.deviation = {fit_.law.fundamental * deviation[0], deviation[1],
                          fit_.contact_deviations.front(), first.damping_deviation};
    fit_.law.covariance = fit_.covariance;
  }

  void report_values(const Eigen::MatrixXd& covariance, std::size_t record) {
    Eigen::MatrixXd own(unknowns().size(), unknowns().size());
    for (Index i = 0; i < own.rows(); ++i) {
      for (Index j = 0; j < own.cols(); ++j) {
        own(i, j) = covariance(at_.all.place(i, record), at_.all.place(j, record));
      }
    }
    const ModelPoint model = at_.all.model(at_.theta, record);
    RecordValues values{.sensors = model.sensors, .damping = damping_line(model).first};
    values.damping_deviation = values.damping * unknowns().damping_deviation(own);
    values.sensor_deviation = unknowns().sensor_deviation(model, own);
    if (record == 0) fit_.response_deviations = unknowns().response_deviations(own);
    fit_.values.push_back(values);
  }

  const JointEstimate& at_;
  ContinuationResult& fit_;
};

}  // namespace

void report_joint_fit(const JointEstimate& estimate, const Eigen::MatrixXd& covariance,
                      ContinuationResult& fit) {
  JointReport(estimate, fit).report(covariance);
}

Eigen::MatrixXd covariance_of_causes(const std::vector<ContinuationResult>& single,
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

}  // namespace modcal
