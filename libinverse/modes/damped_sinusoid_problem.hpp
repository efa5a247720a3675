// The separable least-squares problem of damped sinusoids: what is known at one set of poles.
#pragma once

#include <Eigen/Core>
#include <array>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "libinverse/modes/decay_record.hpp"

namespace modcal {

/// The poles as unknowns: (d_1, ν_1, d_2, ν_2, …) with λ = −d + iν. For given poles a channel is a
/// sum of columns B, exp(−dt) cos νt and exp(−dt) sin νt in turn and those that stand fixed: a
/// constant, and cosine, sine, and t times both, of every line of the mains. Inner products of
/// columns are sums in closed form (moments), so that K poles cost K passes over the samples where
/// an orthonormal basis takes K². The normal equations lose what the square of the columns'
/// condition is of rounding; one step of refinement gives most of it back.
class DampedSinusoidProblem {
 public:
  DampedSinusoidProblem(const DecayRecord& record, std::size_t poles,
                        std::span<const double> lines);

  Eigen::Index samples() const { return data_.rows(); }
  Eigen::Index channels() const { return data_.cols(); }
  Eigen::Index poles() const { return poles_; }
  double degrees_of_freedom() const;

  /// What is known at one set of poles. Times are fractions of the record.
  struct State {
    Eigen::VectorXd poles;
    Eigen::MatrixXd basis;  // exp(−dt) cos νt, exp(−dt) sin νt in turn
    /// Of t^p between the columns of poles, constant and lines.
    std::array<Eigen::MatrixXd, 5> products;
    Eigen::MatrixXd inverse;       // (BᵀB)⁻¹, of dependent columns the pseudo-inverse
    Eigen::MatrixXd coefficients;  // per channel: a cos + b sin, so that A = a − ib
    Eigen::MatrixXd residual;
  };
  State at(const Eigen::VectorXd& poles) const;

  /// Where no pole grows by more than e over the record: one that starts too broad would grow
  /// beyond all numbers, and the columns of the others would be rounding beside it.
  Eigen::VectorXd bounded(Eigen::VectorXd poles) const;

  /// Normal equations of a step of the poles: JᵀJ and Jᵀe of all channels over the variances of
  /// their noise, J the slopes of the residuals over the projector that the linear unknowns leave.
  struct Normal {
    Eigen::MatrixXd matrix;
    Eigen::VectorXd slope;
  };
  Normal normal_equations(const State& state, const Eigen::VectorXd& variances) const;

  /// How much Σ_c ‖e_c‖²/v_c would fall if t and t² times the columns of a pole were columns, too.
  double departure(const State& state, Eigen::Index pole, const Eigen::VectorXd& variances) const;

 private:
  Eigen::Index products_size() const { return 2 * (poles_ + 1 + lines_); }
  Eigen::MatrixXd along(const State& state, const Eigen::MatrixXd& signals) const;
  Eigen::MatrixXd with_times(const State& state, std::size_t power, Eigen::Index first,
                             Eigen::Index count) const;

  double rate_;
  Eigen::Index poles_, lines_;
  std::vector<std::complex<double>> fixed_exponents_;  // of the constant and the lines, per sample
  Eigen::MatrixXd fixed_;                              // their columns, then t times those of lines
  Eigen::VectorXd place_;                              // t
  Eigen::MatrixXd data_;
};

}  // namespace modcal
