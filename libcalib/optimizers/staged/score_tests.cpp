#include "libcalib/optimizers/staged/score_tests.hpp"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_sf_gamma.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "libcalib/identifiability/tuning.hpp"
#include "libcalib/optimizers/staged/best_tests.hpp"
#include "libsim/base/dense_solvers.hpp"

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
  const Index knot = (i - unknowns.named()) / 2;
  return fmt::format("response at {:.0f} Hz", static_cast<double>(knot) * spacing);
}

// ln of the likelihood of a cause over that of its amplitudes being 0, by their priors; of those
// without one the likeliest. A bridge has a mass.
double log_evidence(const MisfitCause& cause, const Eigen::MatrixXd& information,
                    const Eigen::VectorXd& amplitudes) {
  std::vector<Index> known;
  for (Index i = 0; i < cause.widths.size(); ++i) {
    if (cause.widths[i] < kUnknown) known.push_back(i);
  }
  const Eigen::MatrixXd inverse =
      SemidefiniteSolver(information)
          .solve(Eigen::MatrixXd::Identity(information.rows(), information.cols()));
  const Eigen::MatrixXd own = inverse(known, known);
  Eigen::MatrixXd wide = own;
  wide.diagonal() += cause.widths(known).cwiseAbs2();
  const Eigen::VectorXd a = amplitudes(known);
  const SemidefiniteSolver narrow_solver(own), wide_solver(wide);
  const auto log_determinant = [](const SemidefiniteSolver& solver) {
    return solver.factor().vectorD().array().max(std::numeric_limits<double>::min()).log().sum();
  };
  double result = 0.5 * (a.dot(narrow_solver.solve(a)) - a.dot(wide_solver.solve(a)) +
                         log_determinant(narrow_solver) - log_determinant(wide_solver));
  if (cause.name == kBridge) {
    // Twice the part of its posterior that lies above 0.
    const double width = cause.widths[0];
    const double z = a[0] * width / std::sqrt(own(0, 0) * wide(0, 0));
    result +=
        std::log(std::max(std::erfc(-z / std::sqrt(2.0)), std::numeric_limits<double>::min()));
  }
  return result;
}

// What the noise adds to the information of the unknowns is taken out there and not of the
// amplitudes, of which it may leave less than nothing: of the variance of their scores, J, a share.
Eigen::MatrixXd at_least_a_share(const Eigen::MatrixXd& information, const Eigen::MatrixXd& j) {
  const GeneralizedEigen eigen = generalized_eigen(information, j);
  if (!eigen.found) return kLeastShare * j;  // nothing is seen of one of them
  if (eigen.values.minCoeff() >= kLeastShare) return information;
  const Eigen::MatrixXd roots =
      j * eigen.vectors * eigen.values.cwiseMax(kLeastShare).cwiseSqrt().asDiagonal();
  return roots * roots.transpose();
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
    const Eigen::MatrixXd told = 2.0 * mixed.transpose() * taken_;
    information_ = 2.0 * at.information.bottomRightCorner(m, m) - told;
    variance_ = information_ - told.transpose() +
                taken_.transpose() * (2.0 * own.information + options.prior) * taken_;
  }

  // The modes that count are those with the cause, of its amplitudes from `first` on: what the
  // unknowns take of it is no error as far as it is what the cause makes of them.
  void count_modes(const StringUnknowns& unknowns, const ModelPoint& point,
                   const MisfitCause& cause, Index first) {
    const Index count = std::ssize(cause.columns);
    for (Index i = 0; i < taken_.rows(); ++i) {
      const bool named = i < unknowns.named();
      const ParameterName name =
          named ? unknowns.parameters()[static_cast<std::size_t>(i)] : ParameterName{};
      const auto n = static_cast<Index>(name.index);
      auto own = taken_.row(i).segment(first, cause.modes.cols());
      if (named && name.kind == ParameterKind::kFrequency) {
        own -= cause.modes.row(n).real();
      } else if (named && name.kind == ParameterKind::kDampingRatio) {
        own -= cause.modes.row(n).imag() / point.basis.zeta[name.index];
      } else if (i != unknowns.contact()) {
        taken_.row(i).segment(first, count).setZero();
      }
    }
  }

  // Of the amplitudes from `first` on; the number of the unknown that they move most.
  std::pair<ScoreTest, Index> test(const MisfitCause& cause, Index first, Index contact,
                                   double misfit) const {
    const Index count = std::ssize(cause.columns);
    const Eigen::MatrixXd variance = variance_.block(first, first, count, count);
    const Eigen::MatrixXd information =
        at_least_a_share(information_.block(first, first, count, count), variance);
    const Eigen::VectorXd score = score_.segment(first, count);
    const SemidefiniteSolver solver(information);
    const Eigen::VectorXd amplitude = -solver.solve(score);
    const auto taken = taken_.middleCols(first, count);
    ScoreTest test{
        .cause = cause.name,
        .detail = cause.detail,
        .place = cause.place,
        .statistic = score.dot(SemidefiniteSolver(variance).solve(score)) / std::max(1.0, misfit),
        .degrees = static_cast<std::size_t>(count),
        .amplitude = count == 1 || cause.name == kBridge ? amplitude[0] : amplitude.norm(),
        .amplitudes = amplitude,
        .moved = -taken * amplitude};
    test.log_p = log_tail(test.statistic, test.degrees);
    Index most = 0;
    for (Index i = 0; i < taken.rows(); ++i) {
      if (!(deviation_[i] > 0.0)) continue;
      const double shift = std::abs(test.moved[i]) / deviation_[i];
      if (shift > test.shift) test.shift = shift, most = i;
      if (cause.modes.size() == 0 || i == contact) {
        test.contradiction = std::max(test.contradiction, shift);
      }
      // Of all amplitudes with √S = 1 those that move it most.
      const Eigen::VectorXd row = taken.row(i);
      test.shift_per_root =
          std::max(test.shift_per_root, std::sqrt(row.dot(solver.solve(row))) / deviation_[i]);
    }
    if (cause.modes.size() > 0) {
      test.coupling = cause.coupling * std::abs(amplitude[0]);
    }
    if (cause.widths.size() > 0) {
      Eigen::MatrixXd told = information / std::max(1.0, misfit);
      told.diagonal() += cause.widths.cwiseAbs2().cwiseInverse();
      test.untold = taken * SemidefiniteSolver(told).solve(taken.transpose());
      test.log_evidence = log_evidence(cause, information / std::max(1.0, misfit), amplitude);
    }
    return {test, most};
  }

 private:
  const Eigen::VectorXd& deviation_;
  Eigen::VectorXd score_;
  Eigen::MatrixXd taken_;        // K: what of an amplitude's column the unknowns take
  Eigen::MatrixXd information_;  // left of the amplitudes'
  Eigen::MatrixXd variance_;     // of their scores
};

}  // namespace

std::vector<ScoreTest> score_tests(const ProjectedLikelihood& likelihood,
                                   const StringUnknowns& unknowns, const Eigen::VectorXd& theta,
                                   const NewtonOptions& options, const Eigen::VectorXd& deviation,
                                   double misfit) {
  const ModelPoint point = unknowns.model(theta);
  BestTests tests;
  const auto test_all = [&](std::vector<MisfitCause> causes, bool known = false) {
    std::vector<SignalColumn> signals;
    for (const MisfitCause& cause : causes) {
      signals.insert(signals.end(), cause.columns.begin(), cause.columns.end());
    }
    Scores scores(extended_point(likelihood, unknowns, theta, signals), deviation, theta, options);
    Index first = 0;
    for (MisfitCause& cause : causes) {
      if (cause.modes.size() > 0) scores.count_modes(unknowns, point, cause, first);
      auto [test, most] = scores.test(cause, first, unknowns.contact(), misfit);
      first += std::ssize(cause.columns);
      test.unknown = name_of_unknown(unknowns, point, most);
      test.columns = std::move(cause.columns);
      known ? tests.add_known(std::move(test)) : tests.add(std::move(test));
    }
  };
  test_all(misfit_causes(likelihood, point));
  const std::vector<double>& body = likelihood.record().body;
  if (!body.empty()) test_all(bridges_at(likelihood, point, body), true);
  // A bridge that is named is looked for about its place, with what may look like it.
  if (const std::optional<double> place = tests.named_place()) {
    test_all(resonances_about(likelihood, point, *place));
  }
  return tests.take();
}

}  // namespace modcal
