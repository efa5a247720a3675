// The separable least-squares problem of damped sinusoids: what is known at one set of poles.
#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <span>

#include "libinverse/modes/decay_hum.hpp"
#include "libinverse/modes/decay_record.hpp"
#include "libsim/base/dense_solvers.hpp"

namespace modcal {

/// A R⁻¹.
inline Eigen::MatrixXd over(const Eigen::MatrixXd& a, const Eigen::MatrixXd& r) {
  return r.transpose().triangularView<Eigen::Lower>().solve(a.transpose()).transpose();
}

/// R of A = QR by Cholesky's factors of AᵀA, a third of the work of reflections, where its columns
/// are so far from dependent that rounding, ε over the square of their distance, stays below 10⁻⁸;
/// else by tall_r().
inline Eigen::MatrixXd r_by_gram(const Eigen::MatrixXd& a) {
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(a.cols(), a.cols());
  gram.selfadjointView<Eigen::Lower>().rankUpdate(a.transpose());
  const Eigen::VectorXd norms = gram.diagonal().cwiseSqrt();
  const Eigen::VectorXd inverse = norms.cwiseInverse();
  const Eigen::LLT<Eigen::MatrixXd> factor(inverse.asDiagonal() * gram * inverse.asDiagonal());
  const double distance = std::sqrt(std::numeric_limits<double>::epsilon() / 1e-8);
  const bool is_far =
      factor.info() == Eigen::Success && factor.matrixLLT().diagonal().minCoeff() > distance;
  if (!is_far) return tall_r(a);
  return Eigen::MatrixXd(factor.matrixU()) * norms.asDiagonal();
}

/// The poles as unknowns: (d_1, ν_1, d_2, ν_2, …) with λ = −d + iν.
class DampedSinusoidProblem {
 public:
  DampedSinusoidProblem(const DecayRecord& record, std::size_t poles, std::span<const double> lines)
      : rate_(record.sample_rate),
        poles_(static_cast<Eigen::Index>(poles)),
        hum_(hum_columns(record.samples(), record.sample_rate, lines)),
        data_(static_cast<Eigen::Index>(record.samples()),
              static_cast<Eigen::Index>(record.channels.size())) {
    if (hum_.cols() > 0) hum_ = ThinQr(hum_).q();
    for (Eigen::Index c = 0; c < data_.cols(); ++c) {
      for (Eigen::Index m = 0; m < data_.rows(); ++m) {
        data_(m, c) = record.channels[static_cast<std::size_t>(c)][static_cast<std::size_t>(m)];
      }
    }
    data_ = beside_hum(std::move(data_));
  }

  Eigen::Index samples() const { return data_.rows(); }
  Eigen::Index channels() const { return data_.cols(); }
  Eigen::Index poles() const { return poles_; }
  Eigen::Index columns() const { return 2 * poles_ + 1 + hum_.cols(); }
  double degrees_of_freedom() const {
    const double shared = 2.0 * static_cast<double>(poles_) / static_cast<double>(channels());
    return static_cast<double>(samples() - columns()) - shared;
  }

  /// What is known at one set of poles.
  struct State {
    Eigen::VectorXd poles;
    Eigen::MatrixXd basis;         // exp(−dt) cos νt, exp(−dt) sin νt in turn, and 1
    Eigen::MatrixXd thin_q;        // orthonormal basis of its columns, the hum projected out
    Eigen::MatrixXd coefficients;  // per channel: a cos + b sin, so that A = a − ib
    Eigen::MatrixXd residual;
  };

  State at(const Eigen::VectorXd& poles) const {
    State state{.poles = poles, .basis = Eigen::MatrixXd(samples(), 2 * poles_ + 1)};
    for (Eigen::Index k = 0; k < poles_; ++k) fill_exponential(state, k);
    state.basis.col(2 * poles_).setOnes();
    const Eigen::MatrixXd beside = beside_hum(state.basis);
    // Q = A R⁻¹ is orthogonal to the condition of A, and to rounding when it is done again.
    Eigen::MatrixXd r = r_by_gram(beside);
    const Eigen::VectorXd pivots = r.diagonal().cwiseAbs();
    if (pivots.minCoeff() > 1e-10 * pivots.maxCoeff()) {
      state.thin_q = over(beside, r);
      const Eigen::MatrixXd again = r_by_gram(state.thin_q);
      state.thin_q = over(state.thin_q, again);
      r = again * r;
    } else {  // two poles are one
      const ThinQr qr(beside);
      state.thin_q = qr.q();
      r = qr.r();
    }
    state.coefficients = r.triangularView<Eigen::Upper>().solve(state.thin_q.transpose() * data_);
    state.residual = data_ - beside * state.coefficients;
    return state;
  }

  /// Where no pole grows by more than e over the record: one that starts too broad would grow
  /// beyond all numbers, and the columns of the others would be rounding beside it.
  Eigen::VectorXd bounded(Eigen::VectorXd poles) const {
    const double least = -rate_ / static_cast<double>(samples());
    for (Eigen::Index k = 0; k < poles_; ++k) poles[2 * k] = std::max(poles[2 * k], least);
    return poles;
  }

  /// t and t² times the columns of a pole, over what the linear unknowns leave, orthonormal.
  Eigen::MatrixXd higher_terms(const State& state, Eigen::Index k) const {
    Eigen::MatrixXd terms(samples(), 4);
    for (Eigen::Index m = 0; m < samples(); ++m) {
      const double place = static_cast<double>(m) / static_cast<double>(samples());
      terms.row(m).head<2>() = place * state.basis.row(m).segment<2>(2 * k);
      terms.row(m).tail<2>() = place * terms.row(m).head<2>();
    }
    terms = beside_hum(std::move(terms));
    terms -= state.thin_q * (state.thin_q.transpose() * terms);
    return ThinQr(terms).q();
  }

  /// t times the columns of all poles, over the projector that the linear unknowns leave: by their
  /// sums every channel's residuals change.
  Eigen::MatrixXd first_terms(const State& state) const {
    Eigen::MatrixXd terms(samples(), 2 * poles_);
    for (Eigen::Index m = 0; m < samples(); ++m) {
      terms.row(m) = (static_cast<double>(m) / rate_) * state.basis.row(m).head(2 * poles_);
    }
    terms = beside_hum(std::move(terms));
    terms -= state.thin_q * (state.thin_q.transpose() * terms);
    return terms;
  }

  /// Slopes of the residuals of one channel, of its first_terms().
  Eigen::MatrixXd jacobian(const State& state, const Eigen::MatrixXd& terms,
                           Eigen::Index channel) const {
    Eigen::MatrixXd slopes(samples(), 2 * poles_);
    for (Eigen::Index k = 0; k < poles_; ++k) {
      const double a = state.coefficients(2 * k, channel);
      const double b = state.coefficients(2 * k + 1, channel);
      slopes.col(2 * k) = a * terms.col(2 * k) + b * terms.col(2 * k + 1);
      slopes.col(2 * k + 1) = a * terms.col(2 * k + 1) - b * terms.col(2 * k);
    }
    return slopes;
  }

 private:
  Eigen::MatrixXd beside_hum(Eigen::MatrixXd columns) const {
    if (hum_.cols() > 0) columns -= hum_ * (hum_.transpose() * columns);
    return columns;
  }

  // By recurrence in blocks, restarted so that rounding does not gather.
  void fill_exponential(State& state, Eigen::Index k) const {
    const std::complex<double> exponent(-state.poles[2 * k], state.poles[2 * k + 1]);
    const std::complex<double> step = std::exp(exponent / rate_);
    std::complex<double> value = 1.0;
    constexpr Eigen::Index kBlock = 32;
    for (Eigen::Index m = 0; m < samples(); ++m) {
      value =
          m % kBlock == 0 ? std::exp(exponent * (static_cast<double>(m) / rate_)) : value * step;
      state.basis(m, 2 * k) = value.real();
      state.basis(m, 2 * k + 1) = value.imag();
    }
  }

  double rate_;
  Eigen::Index poles_;
  Eigen::MatrixXd hum_;  // orthonormal, of which nothing is left in data, columns and slopes
  Eigen::MatrixXd data_;
};

}  // namespace modcal
