#include "libcalib/optimizers/staged/newton_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string>

#include "libcalib/optimizers/scoring.hpp"

namespace modcal {
namespace {

// Q padded with zeros for the unknowns that have no prior.
Eigen::MatrixXd padded(const Eigen::MatrixXd& prior, Eigen::Index size) {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(size, size);
  result.topLeftCorner(prior.rows(), prior.cols()) = prior;
  return result;
}

// The factor of a matrix scaled to a unit diagonal: units differ by many powers of ten.
struct UnitDiagonal {
  explicit UnitDiagonal(const Eigen::MatrixXd& matrix)
      : scale(matrix.diagonal().cwiseSqrt().cwiseInverse()), factor(scaled(matrix)) {}
  Eigen::MatrixXd scaled(const Eigen::MatrixXd& matrix) const {
    return scale.asDiagonal() * matrix * scale.asDiagonal();
  }
  Eigen::VectorXd scale;
  Eigen::LDLT<Eigen::MatrixXd> factor;
};

Eigen::MatrixXd hessian_of(const LikelihoodPoint& point, const NewtonOptions& options) {
  return debiased_hessian(2.0 * point.information, 2.0 * options.noise, options.prior);
}

// Cost and prior as an objective.
class FitFunction final : public ObjectiveFunction {
 public:
  FitFunction(const FitTarget& target, Eigen::Index size, const NewtonOptions& options)
      : target_(target), options_(options), prior_(padded(options.prior, size)) {}
  std::string_view name() const override { return "joint_likelihood"; }
  std::size_t dimension() const override { return static_cast<std::size_t>(prior_.rows()); }
  Capabilities capabilities() const override { return {.gradient = true, .information = true}; }

  Eigen::VectorXd change(const Eigen::VectorXd& theta) const {
    return options_.prior_mean.size() == 0 ? theta : Eigen::VectorXd(theta - options_.prior_mean);
  }
  ScoringFit known(const LikelihoodPoint& point, const Eigen::VectorXd& theta) const {
    const Eigen::VectorXd off = change(theta), pull = prior_ * off;
    return {.z = Eigen::VectorXd::Zero(theta.size()),
            .value = point.cost + 0.5 * off.dot(pull),
            .gradient = 2.0 * point.slope + pull,
            .information = 2.0 * point.information,
            .noise = 2.0 * options_.noise,
            .prior = prior_};
  }
  LikelihoodPoint point(const ScoringFit& fit, const Eigen::VectorXd& theta) const {
    const Eigen::VectorXd off = change(theta), pull = prior_ * off;
    return {.cost = fit.value - 0.5 * off.dot(pull),
            .slope = 0.5 * (fit.gradient - pull),
            .information = 0.5 * fit.information};
  }

  mutable std::size_t slopes = 0, partial = 0;

 private:
  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    const auto n = static_cast<Eigen::Index>(x.size());
    const Eigen::VectorXd theta = Eigen::Map<const Eigen::VectorXd>(x.data(), n);
    if (!target_.admits(theta)) {
      *outputs.value = std::numeric_limits<double>::infinity();
      return;
    }
    const ScoringFit at = known(likelihood(theta, outputs), theta);
    if (outputs.value) *outputs.value = at.value;
    if (outputs.gradient) Eigen::Map<Eigen::VectorXd>(outputs.gradient, n) = at.gradient;
    if (outputs.information) *outputs.information = at.information;
    if (outputs.noise && at.noise.size() > 0) *outputs.noise = at.noise;
    if (outputs.prior) *outputs.prior = at.prior;
  }
  LikelihoodPoint likelihood(const Eigen::VectorXd& theta, const ObjectiveOutputs& outputs) const {
    if (!outputs.information && target_.slope) {
      ++slopes;
      return target_.slope(theta);
    }
    if (!outputs.rows || !target_.rows) return target_.evaluate(theta);
    LikelihoodPoint found = target_.rows(theta, *outputs.rows);
    if (found.information.rows() != found.information.cols()) ++partial;
    return found;
  }

  const FitTarget& target_;
  const NewtonOptions& options_;
  Eigen::MatrixXd prior_;
};

// Variables that stand for unknowns: no bound is farther than any of them goes.
std::vector<Variable> variables_of(const FitTarget& target, const Eigen::VectorXd& start) {
  std::vector<Variable> variables;
  for (Eigen::Index i = 0; i < start.size(); ++i) {
    const bool bounded = target.lower.size() > 0;
    const double lower = bounded ? target.lower[i] : start[i] - 1e9;
    const double upper = bounded ? target.upper[i] : start[i] + 1e9;
    variables.push_back({.name = std::to_string(i),
                         .unit = "1",
                         .initial = std::clamp(start[i], lower, upper),
                         .lower = lower,
                         .upper = upper});
  }
  return variables;
}

NewtonFit fit_by(Evaluator& evaluator, const FitFunction& function, const FitTarget& target,
                 const NewtonOptions& options) {
  const auto n = static_cast<Eigen::Index>(function.dimension());
  Eigen::VectorXd start(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    start[i] = evaluator.variables()[static_cast<std::size_t>(i)].initial;
  }
  ScoringShortcuts shortcuts{.slopes = static_cast<bool>(target.slope),
                             .rows = static_cast<bool>(target.rows)};
  if (target.capped > 0 && std::isfinite(options.frequency_cap)) {
    shortcuts.largest = Eigen::VectorXd::Constant(n, std::numeric_limits<double>::infinity());
    shortcuts.largest.head(target.capped).setConstant(options.frequency_cap);
  }
  ScoringFit known;
  if (options.at_start) {
    known = function.known(*options.at_start, start);
    shortcuts.at_start = &known;
  }
  const ScoringFit found = Scoring::fit(
      evaluator,
      {.steps = static_cast<std::int64_t>(options.steps), .tolerance = options.tolerance},
      shortcuts);
  NewtonFit fit{.theta = start + found.z, .objective = found.value};
  fit.point = function.point(found, fit.theta);
  fit.evaluations = static_cast<std::size_t>(evaluator.evaluations());
  fit.slopes = function.slopes;
  fit.partial = function.partial;
  fit.converged = found.converged;
  return fit;
}

}  // namespace

double taken_by_fit(const LikelihoodPoint& point, const NewtonOptions& options,
                    const Eigen::MatrixXd& whole) {
  const UnitDiagonal hessian(hessian_of(point, options));
  const double followed = hessian.factor.solve(hessian.scaled(point.information)).trace();
  return 4.0 * followed - 2.0 * whole.cwiseProduct(fit_covariance(point, options)).sum();
}

Eigen::MatrixXd fit_response(const LikelihoodPoint& point, const NewtonOptions& options,
                             const Eigen::MatrixXd& change) {
  const UnitDiagonal hessian(hessian_of(point, options));
  return hessian.scale.asDiagonal() * hessian.factor.solve(hessian.scale.asDiagonal() * change);
}

Eigen::MatrixXd fit_covariance(const LikelihoodPoint& point, const NewtonOptions& options) {
  const UnitDiagonal hessian(hessian_of(point, options));
  const Eigen::Index size = hessian.scale.size();
  const Eigen::MatrixXd inverse =
      hessian.scaled(hessian.factor.solve(Eigen::MatrixXd::Identity(size, size)));
  const Eigen::MatrixXd score = 2.0 * point.twice_weighted + padded(options.prior, size);
  return inverse * score * inverse;
}

LawPosterior law_of_step(const LawStatements& statements, const LikelihoodPoint& at,
                         const Eigen::VectorXd& theta, NewtonOptions options,
                         const Eigen::MatrixXd& more) {
  const Eigen::MatrixXd there = hessian_of(at, options);
  const QuadraticPrior law = statements.law.solve(), wide = statements.wide.solve();
  options.prior = wide.precision;
  const Eigen::MatrixXd alone = hessian_of(at, options);
  const Eigen::MatrixXd error = there * more * there;  // C
  const UnitDiagonal both(alone + error);
  // P = A (A + C)⁻¹, by its transpose.
  const Eigen::MatrixXd weight =
      (both.scale.asDiagonal() * both.factor.solve(both.scale.asDiagonal() * alone)).transpose();
  const Eigen::MatrixXd tie = law.precision - wide.precision;
  const UnitDiagonal hessian(weight * alone + tie);
  const auto solve = [&](const Eigen::MatrixXd& right) -> Eigen::MatrixXd {
    return hessian.scale.asDiagonal() * hessian.factor.solve(hessian.scale.asDiagonal() * right);
  };
  const Eigen::VectorXd pull = wide.precision * (theta - wide.mean);
  const Eigen::VectorXd further = law.precision * (theta - law.mean) - pull;
  const Eigen::VectorXd step = solve(weight * (2.0 * at.slope + pull) + further);
  const Eigen::MatrixXd score = 2.0 * at.twice_weighted + wide.precision + error;
  const Eigen::MatrixXd half = solve(weight * score * weight.transpose() + tie);
  return statements.law.law(theta - step, solve(half.transpose()));
}

NewtonFit newton_fit(const FitTarget& target, const Eigen::VectorXd& start,
                     const NewtonOptions& options, Evaluator* within) {
  const FitFunction function(target, start.size(), options);
  const std::vector<Variable> variables = variables_of(target, start);
  Evaluator evaluator =
      within ? Evaluator(*within, function, variables) : Evaluator(function, variables, Budget{});
  return fit_by(evaluator, function, target, options);
}

NewtonFit newton_fit(const ProjectedLikelihood& likelihood, const StringUnknowns& unknowns,
                     const Eigen::VectorXd& start, const NewtonOptions& options) {
  return newton_fit(fit_target(likelihood, unknowns), start, options);
}

FitTarget fit_target(const ProjectedLikelihood& likelihood, const StringUnknowns& unknowns) {
  FitTarget target{
      .evaluate =
          [&likelihood, &unknowns](const Eigen::VectorXd& theta) {
            return likelihood.evaluate(unknowns.model(theta), unknowns.columns(theta));
          },
      .admits = [&unknowns](const Eigen::VectorXd& theta) { return unknowns.admits(theta); },
      .capped = unknowns.is_law() ? 0 : static_cast<Eigen::Index>(unknowns.modes()),
      .slope =
          [&likelihood, &unknowns](const Eigen::VectorXd& theta) {
            return likelihood.slope(unknowns.model(theta), unknowns.columns(theta));
          }};
  // The law's few columns cost less than some of their rows.
  if (!unknowns.is_law()) {
    target.rows = [&likelihood, &unknowns](const Eigen::VectorXd& theta,
                                           std::span<const std::size_t> wanted) {
      return likelihood.rows(unknowns.model(theta), unknowns.columns(theta), wanted);
    };
  }
  return target;
}

}  // namespace modcal
