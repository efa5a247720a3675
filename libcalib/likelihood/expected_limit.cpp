#include "libcalib/likelihood/expected_limit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "libcalib/likelihood/bin_weights.hpp"
#include "libcalib/likelihood/mode_verdict.hpp"
#include "libcalib/likelihood/newton_fit.hpp"
#include "libcalib/stiff_string_fit.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

Eigen::MatrixXd covariance(const Eigen::MatrixXd& information, const Eigen::MatrixXd& prior) {
  NewtonOptions options;
  options.prior = prior;
  LikelihoodPoint point{.information = information};
  point.twice_weighted = information;
  return fit_covariance(point, options);
}

Eigen::VectorXd deviations(const Eigen::MatrixXd& matrix) {
  return matrix.diagonal().cwiseMax(0.0).cwiseSqrt();
}

constexpr std::size_t kNoiseRepeats = 4;

// Under the weights that a calibration would give the bins if it knew what each can tell.
Eigen::VectorXd attainable(const ProjectedLikelihood& clean, const ModelPoint& truth,
                           const LikelihoodColumns& columns) {
  ProjectedLikelihood weighted = clean;
  weighted.set_weights(best_weights(clean, truth, columns));
  LikelihoodPoint point = weighted.evaluate(truth, columns, {.twice_weighted = true});
  for (std::size_t r = 0; r < kNoiseRepeats; ++r) {
    const ProjectedLikelihood noise(weighted.record().noise(r));
    point.twice_weighted +=
        noise.evaluate(truth, columns, {.twice_weighted = true}).twice_weighted / kNoiseRepeats;
  }
  return deviations(fit_covariance(point, {}));
}

}  // namespace

ExpectedLimit expected_limit(const ModelPoint& truth, const NoisyRecords& records,
                             double highest_frequency, double law_width) {
  MODCAL_REQUIRE(law_width > 0.0, "law width {:g} must be > 0", law_width);
  const double highest = likelihood_band(truth, highest_frequency, records.sample_rate);
  const ProjectedLikelihood whole(WhitenedRecord::of(records, 0.0, highest));
  std::vector<double> frequencies;
  for (std::size_t n = 0; n < truth.basis.size(); ++n) {
    frequencies.push_back(truth.basis.frequency(n));
  }
  const StiffStringFit fit = fit_stiff_string(frequencies);
  ExpectedLimit limit;

  const StringUnknowns law = StringUnknowns::law(truth, fit.fundamental, fit.inharmonicity);
  const Eigen::MatrixXd law_covariance =
      covariance(whole.evaluate(truth, law.columns(law.start())).information, {});
  const Eigen::VectorXd law_deviation = deviations(law_covariance);
  for (Eigen::Index i = 0; i < 4; ++i) {
    limit.law[static_cast<std::size_t>(i)] = law_deviation[i];
    for (Eigen::Index j = 0; j < 4; ++j) {
      limit.law_correlation[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] =
          law_covariance(i, j) / (law_deviation[i] * law_deviation[j]);
    }
  }
  const Eigen::VectorXd weighted = attainable(whole, truth, law.columns(law.start()));
  for (Eigen::Index i = 0; i < 4; ++i) {
    limit.law_attainable[static_cast<std::size_t>(i)] = weighted[i];
  }
  limit.law[0] *= fit.fundamental;
  limit.law_attainable[0] *= fit.fundamental;

  const StringUnknowns free = StringUnknowns::frequencies(truth);
  const Eigen::MatrixXd information = whole.evaluate(truth, free.columns(free.start())).information;
  const auto n = static_cast<Eigen::Index>(free.modes());
  const Eigen::MatrixXd frequency_information = 2.0 * information.topLeftCorner(n, n);
  const Eigen::VectorXd eigenvalues =
      frequency_information.selfadjointView<Eigen::Lower>().eigenvalues();
  for (Eigen::Index i = n - 1; i >= 0; --i) {
    limit.singular_values.push_back(std::sqrt(std::max(eigenvalues[i], 0.0)));
  }
  const Eigen::MatrixXd wide = covariance(
      information, law_prior(Eigen::VectorXd::Constant(n, kWidePrior), fit.inharmonicity));
  const Eigen::VectorXd seen = deviations(wide).head(n);
  const Eigen::VectorXd widths = prior_widths(seen, law_width, kTied);
  const Eigen::VectorXd found =
      deviations(covariance(information, law_prior(widths, fit.inharmonicity)));
  limit.contact = found[free.contact()];
  limit.damping = found[free.damping()];
  limit.modes = free_verdicts(truth, found.head(n), seen, law_width);
  limit.blind_modes = static_cast<std::size_t>(std::count_if(
      limit.modes.begin(), limit.modes.end(),
      [](const ModeVerdict& mode) { return mode.source != ModeSource::kIdentified; }));
  return limit;
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
