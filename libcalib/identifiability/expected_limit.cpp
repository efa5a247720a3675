#include "libcalib/identifiability/expected_limit.hpp"

#include <algorithm>
#include <cmath>

#include "libcalib/identifiability/limit_information.hpp"
#include "libcalib/identifiability/mode_verdict.hpp"
#include "libcalib/parameters/stiff_string_fit.hpp"
#include "libsim/base/dense_solvers.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

Eigen::VectorXd deviations(const Eigen::MatrixXd& matrix) { return matrix.diagonal().cwiseSqrt(); }

ParameterLimit& entry(const std::string& name, ExpectedLimit& limit) {
  for (ParameterLimit& known : limit.parameters) {
    if (known.parameter == name) return known;
  }
  limit.parameters.push_back({.parameter = name});
  return limit.parameters.back();
}

void add_law(const LimitInformation& records, const StringUnknowns& unknowns,
             ExpectedLimit& limit) {
  const Eigen::MatrixXd prior = records.prior(unknowns, records.priors(), nullptr);
  const Eigen::MatrixXd covariance =
      records.covariance(unknowns, records.information(unknowns), prior);
  const Eigen::MatrixXd attainable = records.attainable(unknowns, prior);
  const std::vector<ParameterForm> forms = records.forms(unknowns);
  for (std::size_t i = 0; i < forms.size(); ++i) {
    const Eigen::VectorXd& slope = forms[i].slope;
    ParameterLimit& row = entry(forms[i].parameter, limit);
    row.law = forms[i].deviation(covariance);
    row.attainable = forms[i].deviation(attainable);
    for (std::size_t j = 0; j < i; ++j) {
      row.correlations.push_back(slope.dot(covariance * forms[j].slope) /
                                 (row.law * forms[j].deviation(covariance)));
    }
  }
  constexpr const char* kNames[] = {"f0", "B", "x_c", "damping"};
  for (std::size_t i = 0; i < 4; ++i) {
    limit.law_correlation[i][i] = 1.0;
    const ParameterLimit* row = limit.find(kNames[i]);
    if (!row) continue;
    limit.law[i] = row->law;
    limit.law_attainable[i] = row->attainable;
    for (std::size_t j = 0; j < row->correlations.size(); ++j) {
      for (std::size_t k = 0; k < i; ++k) {
        if (limit.parameters[j].parameter != kNames[k]) continue;
        limit.law_correlation[i][k] = limit.law_correlation[k][i] = row->correlations[j];
      }
    }
  }
}

void add_frequencies(const LimitInformation& records, const StringUnknowns& unknowns,
                     double inharmonicity, ExpectedLimit& limit) {
  const LimitCase& question = records.question();
  const Eigen::MatrixXd information = records.information(unknowns);
  const auto n = static_cast<Eigen::Index>(unknowns.modes());
  const Eigen::MatrixXd of_frequencies = 2.0 * information.topLeftCorner(n, n);
  const Eigen::VectorXd eigenvalues = symmetric_eigenvalues(of_frequencies);
  for (Eigen::Index i = n - 1; i >= 0; --i) {
    limit.singular_values.push_back(std::sqrt(std::max(eigenvalues[i], 0.0)));
  }
  const auto covariance_under = [&](const StatedPriors& priors, const Eigen::VectorXd& widths) {
    const LawScatter scatter{widths, inharmonicity};
    return records.covariance(unknowns, information, records.prior(unknowns, priors, &scatter));
  };
  // What the data tell of a frequency, with what is stated of anything but single ones.
  const Eigen::VectorXd wide = Eigen::VectorXd::Constant(n, kWidePrior);
  const Eigen::VectorXd seen =
      deviations(covariance_under(records.priors().without_frequencies(), wide)).head(n);
  Eigen::VectorXd widths = prior_widths(seen, question.law_width, kTied);
  widen_stated(records.priors(), question.law_width, widths);
  const Eigen::MatrixXd covariance = covariance_under(records.priors(), widths);
  for (const ParameterForm& form : records.forms(unknowns)) {
    entry(form.parameter, limit).free = form.deviation(covariance);
  }
  if (const ParameterLimit* contact = limit.find("x_c")) limit.contact = contact->free;
  if (const ParameterLimit* damping = limit.find("damping")) limit.damping = damping->free;
  const Eigen::VectorXd found = deviations(covariance).head(n);
  limit.modes =
      free_verdicts(question.truth, found, seen, LawFollowers::all(n, question.law_width));
  trust_stated_frequencies(records.priors(), found, limit.modes);
  limit.blind_modes = static_cast<std::size_t>(
      std::count_if(limit.modes.begin(), limit.modes.end(), [](const ModeVerdict& mode) {
        return mode.source != ModeSource::kIdentified && mode.source != ModeSource::kFixed;
      }));
}

}  // namespace

const ParameterLimit* ExpectedLimit::find(const std::string& parameter) const {
  const auto found =
      std::find_if(parameters.begin(), parameters.end(),
                   [&](const ParameterLimit& entry) { return entry.parameter == parameter; });
  return found == parameters.end() ? nullptr : &*found;
}

ExpectedLimit expected_limit(const LimitCase& question) {
  MODCAL_REQUIRE(question.law_width > 0.0, "law width {:g} must be > 0", question.law_width);
  const LimitInformation records(question);
  const ModelPoint& truth = question.truth;
  const StiffStringFit fit = fit_stiff_string(frequencies_of(truth.basis));
  ExpectedLimit limit;
  add_law(records,
          StringUnknowns::law(truth, fit.fundamental, fit.inharmonicity, question.unknowns,
                              records.priors()),
          limit);
  add_frequencies(records, StringUnknowns::frequencies(truth, question.unknowns, records.priors()),
                  fit.inharmonicity, limit);
  return limit;
}

ExpectedLimit expected_limit(const ModelPoint& truth, const NoisyRecords& records,
                             double highest_frequency, double law_width) {
  return expected_limit({.truth = truth,
                         .strokes = {records},
                         .contacts = {truth.contact},
                         .plucks = {},
                         .highest_frequency = highest_frequency,
                         .law_width = law_width,
                         .unknowns = {}});
}

std::vector<double> contacts_without_blind_modes(const ModelPoint& point, double reach,
                                                 double least_shape, std::size_t count) {
  MODCAL_REQUIRE(reach > 0.0 && least_shape > 0.0, "reach {:g} m and least shape {:g} must be > 0",
                 reach, least_shape);
  struct Candidate {
    double contact, shape;
  };
  std::vector<Candidate> candidates;
  const double length = point.basis.length;
  const double step = length / 6600.0;
  const auto steps = static_cast<int>(reach / step);
  for (int i = -steps; i <= steps; ++i) {
    const double x = point.contact + i * step;
    if (x < 0.02 * length || x > 0.5 * length) continue;
    double least = 1.0;
    for (const double shape : point.basis.shape_at(x)) least = std::min(least, std::abs(shape));
    candidates.push_back({x, std::min(least, least_shape)});
  }
  std::stable_sort(
      candidates.begin(), candidates.end(), [&](const Candidate& a, const Candidate& b) {
        if (a.shape != b.shape) return a.shape > b.shape;
        return std::abs(a.contact - point.contact) < std::abs(b.contact - point.contact);
      });
  std::vector<double> contacts;
  for (const Candidate& candidate : candidates) {
    if (contacts.size() == count) break;
    // Neighbors on the grid are the same proposal.
    const bool known = std::any_of(contacts.begin(), contacts.end(), [&](double x) {
      return std::abs(x - candidate.contact) < length / 330.0;
    });
    if (!known) contacts.push_back(candidate.contact);
  }
  return contacts;
}

}  // namespace modcal
