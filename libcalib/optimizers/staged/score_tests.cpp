#include "libcalib/optimizers/staged/score_tests.hpp"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_sf_gamma.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
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
    const Eigen::MatrixXd information = information_.block(first, first, count, count);
    const Eigen::VectorXd score = score_.segment(first, count);
    const auto solver = information.ldlt();
    const Eigen::VectorXd amplitude = -solver.solve(score);
    const auto taken = taken_.middleCols(first, count);
    ScoreTest test{
        .cause = cause.name,
        .detail = cause.detail,
        .place = cause.place,
        .statistic = -score.dot(amplitude) / std::max(1.0, misfit),
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
      test.untold = taken * told.ldlt().solve(taken.transpose());
    }
    return {test, most};
  }

 private:
  const Eigen::VectorXd& deviation_;
  Eigen::VectorXd score_;
  Eigen::MatrixXd taken_;        // K: what of an amplitude's column the unknowns take
  Eigen::MatrixXd information_;  // left of the amplitudes'
};

// Tests of one cause by one name each: of those tried at several places the one found best, with
// what they leave untold. There may be a mode of the body at any place: of every unknown it is the
// most of all, each by its likelihood e^(S/2) over that of the best.
class BestTests {
 public:
  void add(ScoreTest test) {
    const auto same = std::ranges::find(tests_, test.cause, &ScoreTest::cause);
    if (same == tests_.end()) {
      tried_.push_back({1.0, test.untold.diagonal()});
      tests_.push_back(std::move(test));
      return;
    }
    Tried& tried = tried_[static_cast<std::size_t>(same - tests_.begin())];
    const Eigen::VectorXd own = test.untold.diagonal();
    const double weight = std::exp(0.5 * (same->statistic - test.statistic));
    if (weight < 1.0) std::swap(*same, test);
    same->shift_per_root = std::max(same->shift_per_root, test.shift_per_root);
    same->untold += std::min(weight, 1.0 / weight) * test.untold;
    tried.count += 1.0;
    tried.most = (std::min(weight, 1.0) * tried.most).cwiseMax(std::min(1.0, 1.0 / weight) * own);
  }

  // At a place where there is a mode of the body what it leaves untold counts whole.
  void add_known(const ScoreTest& test) {
    if (known_.size() == 0) known_.setZero(test.untold.rows(), test.untold.cols());
    known_ += test.untold;
  }

  std::optional<double> named_place() const {
    const auto found = std::ranges::find_if(
        tests_, [](const ScoreTest& test) { return test.cause == kBridge && test.named(); });
    return found == tests_.end() ? std::nullopt : std::optional(found->place);
  }

  std::vector<ScoreTest> take() {
    for (std::size_t i = 0; i < tests_.size(); ++i) {
      ScoreTest& test = tests_[i];
      test.log_p = std::min(0.0, test.log_p + std::log(tried_[i].count));
      // With the correlations of their sum.
      const Eigen::ArrayXd sum = test.untold.diagonal();
      const Eigen::VectorXd part = (sum > 0.0).select((tried_[i].most.array() / sum).sqrt(), 0.0);
      test.untold = part.asDiagonal() * test.untold * part.asDiagonal();
      if (test.cause == kBridge && known_.size() > 0) test.untold += known_;
      if (!test.named() || !test.frees()) test.columns.clear();
      if (test.named() && test.cause == kBridge && test.amplitude > 0.0) {
        test.detail += fmt::format(", of {:.3g} kg", 1.0 / test.amplitude);
      }
    }
    doubt_resonance();
    return std::move(tests_);
  }

 private:
  // Between two modes of the string a bridge looks like a sensor's resonance: what explains not
  // twice as much may be a bridge.
  void doubt_resonance() {
    const double bridge = std::ranges::find(tests_, kBridge, &ScoreTest::cause)->statistic;
    std::erase_if(tests_, [&](const ScoreTest& test) {
      return test.cause == kResonance && test.statistic < 2.0 * bridge;
    });
  }

  struct Tried {
    double count;          // places
    Eigen::VectorXd most;  // of the diagonals of what they leave untold
  };
  std::vector<ScoreTest> tests_;
  std::vector<Tried> tried_;
  Eigen::MatrixXd known_;
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
      known ? tests.add_known(test) : tests.add(std::move(test));
    }
  };
  test_all(misfit_causes(likelihood, point));
  const std::vector<double>& body = likelihood.record().body;
  if (!body.empty()) test_all(bridges_at(likelihood, point, body, true), true);
  // A bridge that is named is looked for about its place, with what may look like it.
  if (const std::optional<double> place = tests.named_place()) {
    test_all(resonances_about(likelihood, point, *place));
  }
  return tests.take();
}

Eigen::MatrixXd covariance_of_causes(const std::vector<ScoreTest>& tests, Index unknowns) {
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(unknowns, unknowns);
  for (const ScoreTest& test : tests) {
    const Eigen::VectorXd suspected = test.suspected();
    covariance += suspected * suspected.transpose();
    if (test.untold.size() > 0) covariance += test.untold;
  }
  return covariance;
}

}  // namespace modcal
