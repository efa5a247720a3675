#include "libcalib/optimizers/staged/score_tests.hpp"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_sf_gamma.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

namespace modcal {
namespace {

using Index = Eigen::Index;

// ln of the chance that χ² of `degrees` exceeds x; far out the first term of its series.
double log_tail(double x, std::size_t degrees) {
  const double half = 0.5 * static_cast<double>(degrees);
  const double tail = gsl_cdf_chisq_Q(x, 2.0 * half);
  if (tail > 1e-200) return std::log(tail);
  return -0.5 * x + (half - 1.0) * std::log(0.5 * x) - gsl_sf_lngamma(half);
}

// The likelihood by the unknowns, then by the amplitudes of the causes.
LikelihoodPoint extended_point(const ProjectedLikelihood& likelihood,
                               const StringUnknowns& unknowns, const Eigen::VectorXd& theta,
                               std::span<const SignalColumn> signals) {
  const LikelihoodColumns own = unknowns.columns(theta);
  const LikelihoodPoint mixed = likelihood.evaluate(unknowns.model(theta), own.with(signals));
  const auto named = static_cast<Index>(own.common());
  std::vector<Index> order(static_cast<std::size_t>(mixed.slope.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::rotate(order.begin() + named, order.begin() + named + std::ssize(signals), order.end());
  return {.cost = mixed.cost,
          .slope = mixed.slope(order),
          .information = mixed.information(order, order)};
}

std::string name_of_unknown(const StringUnknowns& unknowns, const ModelPoint& point, Index i) {
  if (i < unknowns.named()) return text_of(unknowns.parameters()[static_cast<std::size_t>(i)]);
  const double spacing = point.sensors.smooth.spacing / (2.0 * std::numbers::pi);
  const auto knot = static_cast<double>((i - unknowns.named()) / 2);
  return fmt::format("response at {:.0f} Hz", knot * spacing);
}

// Scores of all amplitudes with the unknowns projected out.
class Scores {
 public:
  Scores(const LikelihoodPoint& at, const Eigen::VectorXd& deviation, const Eigen::VectorXd& theta,
         const NewtonOptions& options)
      : deviation_(deviation) {
    const Index n = theta.size(), m = at.slope.size() - n;
    const LikelihoodPoint own{.information = at.information.topLeftCorner(n, n)};
    const auto mixed = at.information.topRightCorner(n, m);
    taken_ = fit_response(own, options, 2.0 * mixed);
    const Eigen::VectorXd gradient =
        2.0 * at.slope.head(n) + options.prior * (theta - options.prior_mean);
    score_ = 2.0 * at.slope.tail(m) - taken_.transpose() * gradient;
    information_ = 2.0 * (at.information.bottomRightCorner(m, m) - mixed.transpose() * taken_);
  }

  // What `count` amplitudes from `first` on do to other unknowns does not count.
  void count_alone(Index unknown, Index first, Index count) {
    const Eigen::RowVectorXd kept = taken_.row(unknown).segment(first, count);
    taken_.middleCols(first, count).setZero();
    taken_.row(unknown).segment(first, count) = kept;
  }

  // Of `count` amplitudes from `first` on; the number of the unknown that they move most.
  std::pair<ScoreTest, Index> test(Index first, Index count, double misfit) const {
    const Eigen::MatrixXd information = information_.block(first, first, count, count);
    const Eigen::VectorXd score = score_.segment(first, count);
    const auto solver = information.ldlt();
    const Eigen::VectorXd amplitude = -solver.solve(score);
    const auto taken = taken_.middleCols(first, count);
    ScoreTest test{.statistic = -score.dot(amplitude) / std::max(1.0, misfit),
                   .degrees = static_cast<std::size_t>(count),
                   .amplitude = count == 1 ? amplitude[0] : amplitude.norm(),
                   .moved = -taken * amplitude};
    test.log_p = log_tail(test.statistic, test.degrees);
    Index most = 0;
    for (Index i = 0; i < taken.rows(); ++i) {
      if (!(deviation_[i] > 0.0)) continue;
      const double shift = std::abs(test.moved[i]) / deviation_[i];
      if (shift > test.shift) test.shift = shift, most = i;
      // Of all amplitudes with √S = 1 those that move it most.
      const Eigen::VectorXd row = taken.row(i);
      test.shift_per_root =
          std::max(test.shift_per_root, std::sqrt(row.dot(solver.solve(row))) / deviation_[i]);
    }
    return {test, most};
  }

 private:
  const Eigen::VectorXd& deviation_;
  Eigen::VectorXd score_;
  Eigen::MatrixXd taken_;        // K: what of an amplitude's column the unknowns take
  Eigen::MatrixXd information_;  // left of the amplitudes'
};

}  // namespace

std::vector<ScoreTest> score_tests(const ProjectedLikelihood& likelihood,
                                   const StringUnknowns& unknowns, const Eigen::VectorXd& theta,
                                   const NewtonOptions& options, const Eigen::VectorXd& deviation,
                                   double misfit) {
  const ModelPoint point = unknowns.model(theta);
  std::vector<MisfitCause> causes = misfit_causes(likelihood, point);
  std::vector<SignalColumn> signals;
  for (const MisfitCause& cause : causes) {
    signals.insert(signals.end(), cause.columns.begin(), cause.columns.end());
  }
  Scores scores(extended_point(likelihood, unknowns, theta, signals), deviation, theta, options);
  std::vector<ScoreTest> tests;
  std::vector<double> tried;
  Index first = 0;
  for (MisfitCause& cause : causes) {
    const Index count = std::ssize(cause.columns);
    if (cause.moves_contact_alone) scores.count_alone(unknowns.contact(), first, count);
    auto [test, most] = scores.test(first, count, misfit);
    first += count;
    test.cause = cause.name;
    test.detail = cause.detail;
    test.unknown = name_of_unknown(unknowns, point, most);
    test.columns = std::move(cause.columns);
    const auto same = std::find_if(tests.begin(), tests.end(), [&](const ScoreTest& other) {
      return other.cause == test.cause;
    });
    if (same == tests.end()) {
      tests.push_back(std::move(test));
      tried.push_back(1.0);
      continue;
    }
    tried[static_cast<std::size_t>(same - tests.begin())] += 1.0;
    const double worst = std::max(same->shift_per_root, test.shift_per_root);
    if (test.statistic > same->statistic) *same = std::move(test);
    same->shift_per_root = worst;
  }
  for (std::size_t i = 0; i < tests.size(); ++i) {
    tests[i].log_p = std::min(0.0, tests[i].log_p + std::log(tried[i]));
    if (!tests[i].named() || !tests[i].frees()) tests[i].columns.clear();
  }
  return tests;
}

Eigen::MatrixXd covariance_of_causes(const std::vector<ScoreTest>& tests, Index unknowns) {
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(unknowns, unknowns);
  for (const ScoreTest& test : tests) {
    const Eigen::VectorXd suspected = test.suspected();
    covariance += suspected * suspected.transpose();
  }
  return covariance;
}

}  // namespace modcal
