#include "libcalib/optimizers/scoring.hpp"

#include <algorithm>
#include <cmath>

#include "libcalib/likelihood/newton_step.hpp"
#include "libcalib/optimizers/tuning.hpp"
#include "libsim/base/dense_solvers.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

// Roots of the diagonal of H⁻¹ = L⁻ᵀL⁻¹: the norms of the columns of L⁻¹.
Eigen::VectorXd root_diagonal_of_inverse(const Eigen::MatrixXd& h) {
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(h.rows(), h.cols());
  const PositiveSolver solver(h);
  if (solver.factor().info() == Eigen::Success) {
    return whiten(solver, one).colwise().norm().transpose();
  }
  const Eigen::MatrixXd inverse = SemidefiniteSolver(h).solve(one);
  return inverse.diagonal().cwiseSqrt();
}

// Newton steps through an evaluator.
class Search {
 public:
  Search(Evaluator& evaluator, const Scoring::Options& options, const ScoringShortcuts& shortcuts)
      : evaluator_(evaluator), options_(options), shortcuts_(shortcuts) {
    const auto n = static_cast<Index>(evaluator.dimension());
    lower_ = Eigen::Map<const Eigen::VectorXd>(evaluator.lower().data(), n);
    upper_ = Eigen::Map<const Eigen::VectorXd>(evaluator.upper().data(), n);
    fit_.z = Eigen::VectorXd::Zero(n);
    fit_.gradient.resize(n);
  }

  ScoringFit run() {
    if (shortcuts_.at_start) fit_ = *shortcuts_.at_start;
    const bool finite =
        shortcuts_.at_start || evaluator_.evaluate(view(fit_.z), {.value = &fit_.value,
                                                                  .gradient = fit_.gradient.data(),
                                                                  .information = &fit_.information,
                                                                  .noise = &fit_.noise,
                                                                  .prior = &fit_.prior});
    if (!finite) return fit_;
    formed_ = fit_.z;
    double damping = 0.0;
    for (std::int64_t count = 0; count < options_.steps; ++count) {
      Step step = newton_step(damping);
      // Half the tolerance: the information changes less than that in a step.
      if (stale_ && !(step.decrease < 0.5 * options_.tolerance && damping < 0.1)) {
        refresh_information();
        step = newton_step(damping);
      }
      if (step.decrease < options_.tolerance && damping < 0.1) {
        fit_.converged = true;
        break;
      }
      const bool better = take(step, damping);
      damping = better ? (damping < 1e-3 ? 0.0 : 0.2 * damping) : std::max(1e-2, 6.0 * damping);
      if (damping > 1e8) break;
    }
    return fit_;
  }

 private:
  struct Step {
    Eigen::VectorXd move;
    double decrease = 0.0;
  };
  struct Trial {
    bool finite = false;
    double value = std::numeric_limits<double>::infinity();
    Eigen::VectorXd gradient;
    Eigen::MatrixXd information;
    Eigen::VectorXd formed;  // where each row of the information is from; empty: there is none
  };

  static std::span<const double> view(const Eigen::VectorXd& z) {
    return {z.data(), static_cast<std::size_t>(z.size())};
  }
  Eigen::MatrixXd hessian() const {
    return debiased_hessian(fit_.information, fit_.noise, fit_.prior);
  }

  // Of variables pressed against a bound nothing moves.
  Step newton_step(double damping) const {
    Eigen::MatrixXd h = hessian();
    Eigen::VectorXd gradient = fit_.gradient;
    for (Index i = 0; i < gradient.size(); ++i) {
      const bool pressed = (fit_.z[i] <= lower_[i] && gradient[i] > 0.0) ||
                           (fit_.z[i] >= upper_[i] && gradient[i] < 0.0);
      if (!pressed) continue;
      gradient[i] = 0.0;
      h.row(i).setZero();
      h.col(i).setZero();
      h(i, i) = 1.0;
    }
    const Eigen::VectorXd scale = h.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    h = scale.asDiagonal() * h * scale.asDiagonal();
    h.diagonal().array() += damping + 1e-12;
    const Eigen::VectorXd scaled = scale.asDiagonal() * gradient;
    // Blocked, a third of the time of a factor that pivots.
    const PositiveSolver solver(h);
    const bool positive = solver.factor().info() == Eigen::Success;
    const Eigen::VectorXd solved =
        positive ? solver.solve(scaled) : SemidefiniteSolver(h).solve(scaled);
    Step step{-(scale.asDiagonal() * solved)};
    step.decrease = -step.move.dot(gradient);
    return step;
  }

  bool take(Step& step, double damping) {
    Eigen::VectorXd& move = step.move;
    if (shortcuts_.largest.size() > 0) {
      const double share = move.cwiseAbs().cwiseQuotient(shortcuts_.largest).maxCoeff();
      if (share > 1.0) move *= 1.0 / share;
    }
    const Eigen::VectorXd trial = (fit_.z + move).cwiseMax(lower_).cwiseMin(upper_);
    const bool far = damping == 0.0 && step.decrease > kLongStep;
    Trial tried = far || !shortcuts_.slopes ? with_information(trial) : slope(trial);
    // The debiased step may pass the minimum of this draw by a little of its noise.
    if (!tried.finite || !(tried.value < fit_.value + 0.5 * options_.tolerance)) return false;
    stale_ = tried.formed.size() == 0;
    if (!stale_) {
      fit_.information = std::move(tried.information);
      formed_ = std::move(tried.formed);
    }
    fit_.z = trial;
    fit_.value = tried.value;
    fit_.gradient = std::move(tried.gradient);
    return true;
  }

  Trial slope(const Eigen::VectorXd& z) {
    Trial trial{.gradient = Eigen::VectorXd(z.size())};
    trial.finite =
        evaluator_.evaluate(view(z), {.value = &trial.value, .gradient = trial.gradient.data()});
    return trial;
  }

  std::vector<std::size_t> moved(const Eigen::VectorXd& moves) const {
    const Eigen::MatrixXd h = hessian();
    const Eigen::VectorXd scale = h.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::VectorXd least =
        kMovedDeviations *
        scale.cwiseProduct(root_diagonal_of_inverse(scale.asDiagonal() * h * scale.asDiagonal()));
    std::vector<std::size_t> result;
    for (Index i = 0; i < moves.size(); ++i) {
      if (std::abs(moves[i]) > least[i]) result.push_back(static_cast<std::size_t>(i));
    }
    return result;
  }

  // With the rows of variables that have moved.
  Trial with_information(const Eigen::VectorXd& z) {
    std::vector<std::size_t> rows;
    if (shortcuts_.rows) rows = moved(z - formed_);
    Trial trial{.gradient = Eigen::VectorXd(z.size()), .formed = formed_};
    Eigen::MatrixXd found;
    trial.finite = evaluator_.evaluate(view(z), {.value = &trial.value,
                                                 .gradient = trial.gradient.data(),
                                                 .information = &found,
                                                 .rows = shortcuts_.rows ? &rows : nullptr});
    if (!trial.finite) return trial;
    if (found.rows() == found.cols()) {
      trial.information = std::move(found);
      trial.formed = z;
      return trial;
    }
    trial.information = fit_.information;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto row = static_cast<Index>(rows[i]);
      trial.information.row(row) = found.row(static_cast<Index>(i));
      trial.information.col(row) = found.row(static_cast<Index>(i)).transpose();
      trial.formed[row] = z[row];
    }
    return trial;
  }

  // Where the fit stands; nothing is to be found where no variable has moved.
  void refresh_information() {
    stale_ = false;
    if (shortcuts_.rows && moved(fit_.z - formed_).empty()) return;
    Trial here = with_information(fit_.z);
    fit_.information = std::move(here.information);
    formed_ = std::move(here.formed);
  }

  Evaluator& evaluator_;
  const Scoring::Options& options_;
  const ScoringShortcuts& shortcuts_;
  Eigen::VectorXd lower_, upper_, formed_;
  bool stale_ = false;  // the information is that of the point before
  ScoringFit fit_;
};

}  // namespace

void Scoring::Options::visit(OptionVisitor& visitor) {
  visitor("steps", "most Newton steps", {.range = Range::at_least(1)}, steps);
  visitor("tolerance",
          "ends where a step would lower minus the log likelihood by half of "
          "this: the square of its length in standard deviations",
          {.range = Range::positive()}, tolerance);
}

ScoringFit Scoring::fit(Evaluator& evaluator, const Options& options,
                        const ScoringShortcuts& shortcuts) {
  return Search(evaluator, options, shortcuts).run();
}

StopReason Scoring::search(Evaluator& evaluator) const {
  const ScoringFit found = fit(evaluator, options_);
  if (found.converged) return StopReason::kConverged;
  return found.gradient.allFinite() && std::isfinite(found.value) ? StopReason::kNoProgress
                                                                  : StopReason::kNotFinite;
}

}  // namespace modcal
