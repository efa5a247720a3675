#include "libinverse/modes/damped_sinusoid_problem.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "libinverse/modes/exponential_moments.hpp"
#include "libsim/base/dense_solvers.hpp"

namespace modcal {
namespace {

using Complex = std::complex<double>;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Directions of normal equations that are less of their columns' scale are rounding of the sums.
double rounding(Index samples) {
  return static_cast<double>(samples) * std::numeric_limits<double>::epsilon();
}

VectorXd inverse_norms(const MatrixXd& gram) {
  return gram.diagonal().unaryExpr(
      [](double square) { return square > 0.0 ? 1.0 / std::sqrt(square) : 0.0; });
}

MatrixXd inverse_of(const MatrixXd& gram, double threshold) {
  const VectorXd scale = inverse_norms(gram);
  return scale.asDiagonal() *
         pseudo_inverse(scale.asDiagonal() * gram * scale.asDiagonal(), threshold) *
         scale.asDiagonal();
}

// By recurrence in blocks, restarted so that rounding does not gather.
void fill_exponential(Complex exponent, Eigen::Ref<MatrixXd> columns) {
  const Complex step = std::exp(exponent);
  Complex value = 1.0;
  constexpr Index kBlock = 32;
  for (Index m = 0; m < columns.rows(); ++m) {
    value = m % kBlock == 0 ? std::exp(exponent * static_cast<double>(m)) : value * step;
    columns(m, 0) = value.real();
    columns(m, 1) = value.imag();
  }
}

}  // namespace

DampedSinusoidProblem::DampedSinusoidProblem(const DecayRecord& record, std::size_t poles,
                                             std::span<const double> lines)
    : rate_(record.sample_rate),
      poles_(static_cast<Index>(poles)),
      lines_(static_cast<Index>(lines.size())),
      fixed_exponents_{0.0},
      fixed_(static_cast<Index>(record.samples()), 2 + 4 * lines_),
      place_(
          VectorXd::LinSpaced(fixed_.rows(), 0.0, 1.0 - 1.0 / static_cast<double>(fixed_.rows()))),
      data_(fixed_.rows(), static_cast<Index>(record.channels.size())) {
  for (const double line : lines) {
    fixed_exponents_.emplace_back(0.0, 2.0 * std::numbers::pi * line / rate_);
  }
  for (Index k = 0; k <= lines_; ++k) {
    fill_exponential(fixed_exponents_[static_cast<std::size_t>(k)], fixed_.middleCols(2 * k, 2));
  }
  fixed_.rightCols(2 * lines_) = place_.asDiagonal() * fixed_.middleCols(2, 2 * lines_);
  for (Index c = 0; c < data_.cols(); ++c) {
    const std::vector<double>& channel = record.channels[static_cast<std::size_t>(c)];
    data_.col(c) = Eigen::Map<const VectorXd>(channel.data(), data_.rows());
  }
}

double DampedSinusoidProblem::degrees_of_freedom() const {
  const double shared = 2.0 * static_cast<double>(poles_) / static_cast<double>(channels());
  return static_cast<double>(samples() - (2 * poles_ + 1 + 4 * lines_)) - shared;
}

// Bᵀ times signals.
MatrixXd DampedSinusoidProblem::along(const State& state, const MatrixXd& signals) const {
  MatrixXd result(state.basis.cols() + fixed_.cols(), signals.cols());
  result.topRows(state.basis.cols()) = state.basis.transpose() * signals;
  result.bottomRows(fixed_.cols()) = fixed_.transpose() * signals;
  return result;
}

// Bᵀ times t^power times `count` of the columns of poles, constant and lines from `first` on.
MatrixXd DampedSinusoidProblem::with_times(const State& state, std::size_t power, Index first,
                                           Index count) const {
  MatrixXd result(products_size() + 2 * lines_, count);
  if (count == 0) return result;  // has no address that a block of it could begin at
  result.topRows(products_size()) = state.products[power].middleCols(first, count);
  result.bottomRows(2 * lines_) =
      state.products[power + 1].bottomRows(2 * lines_).middleCols(first, count);
  return result;
}

DampedSinusoidProblem::State DampedSinusoidProblem::at(const VectorXd& poles) const {
  State state{.poles = poles, .basis = MatrixXd(samples(), 2 * poles_)};
  std::vector<Complex> exponents;
  for (Index k = 0; k < poles_; ++k) {
    exponents.push_back(Complex(-poles[2 * k], poles[2 * k + 1]) / rate_);
    fill_exponential(exponents.back(), state.basis.middleCols(2 * k, 2));
  }
  exponents.insert(exponents.end(), fixed_exponents_.begin(), fixed_exponents_.end());
  state.products = moments(exponents, static_cast<std::size_t>(samples()));
  MatrixXd gram(products_size() + 2 * lines_, products_size() + 2 * lines_);
  gram.leftCols(products_size()) = with_times(state, 0, 0, products_size());
  gram.rightCols(2 * lines_) = with_times(state, 1, products_size() - 2 * lines_, 2 * lines_);
  state.inverse = inverse_of(gram, rounding(samples()));
  state.coefficients = state.inverse * along(state, data_);
  const auto remains = [&] {
    return MatrixXd(data_ - state.basis * state.coefficients.topRows(2 * poles_) -
                    fixed_ * state.coefficients.bottomRows(fixed_.cols()));
  };
  state.coefficients += state.inverse * along(state, remains());
  state.residual = remains();
  return state;
}

VectorXd DampedSinusoidProblem::bounded(VectorXd poles) const {
  const double least = -rate_ / static_cast<double>(samples());
  for (Index k = 0; k < poles_; ++k) poles[2 * k] = std::max(poles[2 * k], least);
  return poles;
}

DampedSinusoidProblem::Normal DampedSinusoidProblem::normal_equations(
    const State& state, const VectorXd& variances) const {
  // t times the columns of the poles, over what the columns leave: by sums of two of them every
  // channel's residuals change.
  const Index size = 2 * poles_;
  const double seconds = static_cast<double>(samples()) / rate_;
  const MatrixXd with_columns = with_times(state, 1, 0, size);
  const MatrixXd terms = state.products[2].topLeftCorner(size, size) -
                         with_columns.transpose() * state.inverse * with_columns;
  const MatrixXd with_residual = state.basis.transpose() * (place_.asDiagonal() * state.residual);
  Normal normal{MatrixXd::Zero(size, size), VectorXd::Zero(size)};
  for (Index c = 0; c < channels(); ++c) {
    MatrixXd sums = MatrixXd::Zero(size, size);
    for (Index k = 0; k < size; k += 2) {
      const double a = state.coefficients(k, c), b = state.coefficients(k + 1, c);
      sums.block<2, 2>(k, k) << a, -b, b, a;
    }
    normal.matrix += seconds * seconds / variances[c] * (sums.transpose() * terms * sums);
    normal.slope += seconds / variances[c] * (sums.transpose() * with_residual.col(c));
  }
  return normal;
}

double DampedSinusoidProblem::departure(const State& state, Index pole,
                                        const VectorXd& variances) const {
  const Index first = 2 * pole;
  MatrixXd with_columns(state.inverse.rows(), 4);
  with_columns << with_times(state, 1, first, 2), with_times(state, 2, first, 2);
  Eigen::Matrix4d terms;
  const auto own = [&](std::size_t p) { return state.products[p].block<2, 2>(first, first); };
  terms << own(2), own(3), own(3), own(4);
  const Eigen::Vector4d scale = inverse_norms(terms);
  terms -= with_columns.transpose() * state.inverse * with_columns;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> axes(scale.asDiagonal() * terms *
                                                            scale.asDiagonal());
  MatrixXd times(samples(), 4);
  times.leftCols<2>() = place_.asDiagonal() * state.basis.middleCols<2>(first);
  times.rightCols<2>() = place_.asDiagonal() * times.leftCols<2>();
  const MatrixXd parts =
      axes.eigenvectors().transpose() * scale.asDiagonal() * (times.transpose() * state.residual);
  double sum = 0.0;
  for (Index i = 0; i < 4; ++i) {
    if (!(axes.eigenvalues()[i] > rounding(samples()))) continue;
    sum += (parts.row(i).cwiseAbs2().transpose().array() / variances.array()).sum() /
           axes.eigenvalues()[i];
  }
  return sum;
}

}  // namespace modcal
