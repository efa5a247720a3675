#include "libinverse/observer/steady_gain.hpp"

#include <Eigen/Cholesky>
#include <complex>

#include "libinverse/observer/tuning.hpp"
#include "libsim/base/dense_solvers.hpp"
#include "libsim/base/error.hpp"
#include "libsim/dynamics/scene/contact_modes.hpp"

namespace modcal::observer {
namespace {

using Eigen::MatrixXd;

struct SampledString {
  MatrixXd transition;   // A, 2N × 2N: (Re, Im) of every Z/φ
  MatrixXd drive;        // B, 2N × 1
  MatrixXd observation;  // H, 2 × 2N
};

SampledString sampled_string(const ContactModes& modes, const std::vector<double>& shape,
                             double period) {
  const auto size = static_cast<Eigen::Index>(modes.size());
  SampledString s{MatrixXd::Zero(2 * size, 2 * size), MatrixXd::Zero(2 * size, 1),
                  MatrixXd::Zero(2, 2 * size)};
  for (Eigen::Index n = 0; n < size; ++n) {
    const auto i = static_cast<std::size_t>(n);
    const std::complex<double> r = std::exp(modes.pole[i] * period);
    const std::complex<double> b = modes.drive[i] / shape[i] * (r - 1.0) / modes.pole[i];
    s.transition.block<2, 2>(2 * n, 2 * n) << r.real(), -r.imag(), r.imag(), r.real();
    s.drive(2 * n, 0) = b.real();
    s.drive(2 * n + 1, 0) = b.imag();
    s.observation(0, 2 * n + 1) = modes.left_gain[i].imag() * shape[i];
    s.observation(1, 2 * n + 1) = modes.right_gain[i].imag() * shape[i];
  }
  return s;
}

struct RiccatiSolution {
  MatrixXd covariance;
  std::size_t doublings = 0;
  bool converged = false;
};

// X = lim H_k for X = A (X⁻¹ + G)⁻¹ Aᵀ + Q; `transition` is that of the filter, A.
RiccatiSolution solve_by_doubling(const MatrixXd& transition, MatrixXd g, MatrixXd q) {
  const Eigen::Index n = transition.rows();
  MatrixXd a = transition.transpose(), v(n, 2 * n);
  RiccatiSolution solution;
  while (solution.doublings < kMostDoublings && !solution.converged) {
    MatrixXd w = g * q;
    w.diagonal().array() += 1.0;
    v << a, g;
    v = solve_general(w, v);
    const MatrixXd turned = q * v.leftCols(n);
    MatrixXd growth = a.transpose() * turned;
    growth = 0.5 * (growth + growth.transpose().eval());
    const MatrixXd spread = v.rightCols(n) * a.transpose();
    MatrixXd g_growth = a * spread;
    g += 0.5 * (g_growth + g_growth.transpose().eval());
    a = (a * v.leftCols(n)).eval();
    q += growth;
    ++solution.doublings;
    solution.converged = growth.norm() <= 1e-14 * q.norm();
  }
  solution.covariance = std::move(q);
  return solution;
}

// X = Σ_k Fᵏ Q (Fᵏ)ᵀ.
MatrixXd solve_stein(MatrixXd f, MatrixXd q) {
  for (std::size_t i = 0; i < kMostDoublings; ++i) {
    const MatrixXd growth = f * q * f.transpose();
    q += growth;
    if (growth.norm() <= 1e-12 * q.norm()) break;
    f = (f * f).eval();
  }
  return q;
}

// Mean of (H P₀ Hᵀ + R)/R over the reactions for the gain `k`.
double quiet_misfit_of(const SampledString& s, const MatrixXd& k, const Eigen::Vector2d& variance) {
  const MatrixXd turned = s.transition * k;
  const MatrixXd loop = s.transition - turned * s.observation;
  const MatrixXd p = solve_stein(loop, turned * variance.asDiagonal() * turned.transpose());
  const Eigen::Vector2d spread = (s.observation * p * s.observation.transpose()).diagonal();
  return 1.0 + spread.cwiseQuotient(variance).mean();
}

}  // namespace

SteadyGain steady_gain(const ModalBasis& basis, double contact, double sample_rate,
                       double force_noise, const double (&noise)[2]) {
  MODCAL_REQUIRE(force_noise > 0.0 && noise[0] > 0.0 && noise[1] > 0.0 && sample_rate > 0.0,
                 "a gain needs a positive force noise, sensor noise and sample rate, not {:g} N, "
                 "{:g} and {:g} N, {:g} Hz",
                 force_noise, noise[0], noise[1], sample_rate);
  const ContactModes modes = contact_modes(basis, contact, {});
  std::vector<double> shape;
  for (const double value : basis.shape_at(contact)) {
    if (!is_node(value)) shape.push_back(value);
  }
  const SampledString s = sampled_string(modes, shape, 1.0 / sample_rate);
  const Eigen::Vector2d variance(noise[0] * noise[0], noise[1] * noise[1]);
  const MatrixXd& h = s.observation;
  const MatrixXd q = force_noise * force_noise * (s.drive * s.drive.transpose());
  const RiccatiSolution solution =
      solve_by_doubling(s.transition, h.transpose() * variance.cwiseInverse().asDiagonal() * h, q);
  const MatrixXd& p = solution.covariance;
  const MatrixXd ph = p * h.transpose();
  Eigen::Matrix2d spread = h * ph;
  spread.diagonal() += variance;
  const MatrixXd k = spread.llt().solve(ph.transpose()).transpose();

  SteadyGain result;
  result.quiet_misfit = quiet_misfit_of(s, k, variance);
  result.doublings = solution.doublings;
  result.converged = solution.converged;
  const MatrixXd corrected = p - k * ph.transpose();
  result.residual = (s.transition * corrected * s.transition.transpose() + q - p).norm() / p.norm();
  result.gain = {PlanarVector(modes.size()), PlanarVector(modes.size())};
  for (std::size_t n = 0; n < modes.size(); ++n) {
    const auto row = static_cast<Eigen::Index>(2 * n);
    for (int r = 0; r < 2; ++r) {
      result.gain[r].set(n, shape[n] * std::complex<double>(k(row, r), k(row + 1, r)));
    }
  }
  return result;
}

}  // namespace modcal::observer
