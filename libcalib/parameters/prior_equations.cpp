#include "libcalib/parameters/prior_equations.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "libsim/base/dense_solvers.hpp"

namespace modcal {

using Index = Eigen::Index;

PriorEquations::PriorEquations(Index unknowns)
    : unknowns_(unknowns),
      normal_(Eigen::MatrixXd::Zero(unknowns + 2, unknowns + 2)),
      right_(Eigen::VectorXd::Zero(unknowns + 2)) {}

void PriorEquations::add(const std::vector<LinearForm>& forms, const Eigen::VectorXd& means,
                         const Eigen::MatrixXd& covariance) {
  if (forms.empty()) return;
  const auto count = static_cast<Index>(forms.size());
  Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(count, unknowns_ + 2);
  Eigen::VectorXd targets(count);
  // Deviations differ by many powers of ten: whitened by those first.
  const Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  for (Index i = 0; i < count; ++i) {
    const LinearForm& form = forms[static_cast<std::size_t>(i)];
    const Index own = form.slope.size() - 2;
    slopes.row(i).head(own) = scale[i] * form.slope.head(own).transpose();
    slopes.row(i).tail(2) = scale[i] * form.slope.tail(2).transpose();
    targets[i] = scale[i] * (means[i] - form.offset);
  }
  const PositiveSolver factor(scale.asDiagonal() * covariance * scale.asDiagonal());
  slopes = whiten(factor, slopes);
  targets = whiten(factor, targets);
  normal_ += slopes.transpose() * slopes;
  right_ += slopes.transpose() * targets;
}

// A form names few of the unknowns.
void PriorEquations::add(const LinearForm& form, double mean, double deviation) {
  const Index own = form.slope.size() - 2;
  std::vector<std::pair<Index, double>> entries;
  for (Index i = 0; i < form.slope.size(); ++i) {
    if (form.slope[i] == 0.0) continue;
    entries.emplace_back(i < own ? i : unknowns_ + i - own, form.slope[i] / deviation);
  }
  const double target = (mean - form.offset) / deviation;
  for (const auto& [i, slope] : entries) {
    for (const auto& [j, other] : entries) normal_(i, j) += slope * other;
    right_[i] += slope * target;
  }
}

void PriorEquations::add_scatter(const LawScatter& law, const Eigen::VectorXd& reference) {
  for (Index i = 0; i < law.widths.size(); ++i) {
    const double n = static_cast<double>(i + 1);
    const double stiff = 1.0 + law.inharmonicity * n * n;
    const double slope = 0.5 * n * n / stiff;
    LinearForm form{.slope = Eigen::VectorXd::Zero(unknowns_ + 2)};
    form.slope[i] = 1.0;
    form.slope[unknowns_] = -1.0;
    form.slope[unknowns_ + 1] = -slope;
    form.offset = reference[i] - std::log(n * std::sqrt(stiff)) + slope * law.inharmonicity;
    add(form, 0.0, law.widths[i]);
  }
}

void PriorEquations::hold(Index i, double value) {
  right_ -= normal_.col(i) * value;
  normal_.row(i).setZero();
  normal_.col(i).setZero();
  right_[i] = 0.0;
  if (i >= unknowns_) return;
  normal_(i, i) = 1.0;
  right_[i] = value;
}

Eigen::VectorXd PriorEquations::completed(const Eigen::VectorXd& theta) const {
  Eigen::VectorXd z = Eigen::VectorXd::Zero(unknowns_ + 2);
  z.head(unknowns_) = theta;
  z.tail(2) = law_covariance() * (right_.tail(2) - normal_.bottomRows(2) * z);
  return z;
}

// Of (ln f_0, B) where θ is known.
Eigen::Matrix2d PriorEquations::law_covariance() const {
  const Eigen::Matrix2d normal = normal_.bottomRightCorner<2, 2>();
  const Eigen::Vector2d scale = normal.diagonal().unaryExpr(
      [](double entry) { return entry > 0.0 ? 1.0 / std::sqrt(entry) : 0.0; });
  return scale.asDiagonal() *
         pseudo_inverse(scale.asDiagonal() * normal * scale.asDiagonal(), 1e-11) *
         scale.asDiagonal();
}

LawPosterior PriorEquations::law(const Eigen::VectorXd& theta,
                                 const Eigen::MatrixXd& covariance) const {
  const Eigen::Matrix2d own = law_covariance();
  const Eigen::MatrixXd gain = own * normal_.bottomLeftCorner(2, unknowns_);
  return {completed(theta).tail<2>(), own + gain * covariance * gain.transpose()};
}

QuadraticPrior PriorEquations::solve() const {
  Eigen::MatrixXd normal = normal_;
  Eigen::VectorXd right = right_;
  for (const Index law : {unknowns_, unknowns_ + 1}) {
    const double pivot = normal(law, law);
    if (!(pivot > 1e-12 * normal_(law, law))) continue;
    const Eigen::VectorXd column = normal.col(law) / pivot;
    right -= column * right[law];
    normal -= column * normal.row(law).eval();
  }
  QuadraticPrior prior{.precision = normal.topLeftCorner(unknowns_, unknowns_)};
  const Eigen::VectorXd scale = prior.precision.diagonal().unaryExpr(
      [](double entry) { return entry > 0.0 ? 1.0 / std::sqrt(entry) : 0.0; });
  prior.mean = scale.asDiagonal() *
               least_norm_solution(scale.asDiagonal() * prior.precision * scale.asDiagonal(),
                                   scale.asDiagonal() * right.head(unknowns_), 1e-11);
  return prior;
}

}  // namespace modcal
