#include "libinverse/structure/bin_forces.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

#include "libinverse/structure/tuning.hpp"

namespace modcal {

using Index = Eigen::Index;

namespace {

// (|H|² − E|δH|²)/|H|², the square of the true H over that of the one there is.
double share_known(Complex transfer, double variance) {
  const double power = std::norm(transfer);
  return power > variance ? std::max(kLeastKnown, 1.0 - variance / power) : kLeastKnown;
}

// Contacts differ by orders of magnitude in what a bin tells of them.
Eigen::MatrixXcd inverse_of_hermitian(const Eigen::MatrixXcd& matrix) {
  const Eigen::VectorXd size = matrix.diagonal().real().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXcd scaled = size.asDiagonal() * matrix * size.asDiagonal();
  const Eigen::MatrixXcd one = Eigen::MatrixXcd::Identity(matrix.rows(), matrix.cols());
  return size.asDiagonal() * scaled.ldlt().solve(one) * size.asDiagonal();
}

}  // namespace

double bin_weight(const Transfers& transfers, const BinVariances& variances, std::size_t k,
                  std::size_t m) {
  const double weight = 1.0 / variances.of[k][m];
  if (variances.of_transfer.empty()) return weight;
  return weight * share_known(transfers[k][m], variances.of_transfer[k][m]);
}

BinForces::BinForces(const ContourSpectra& spectra, const Transfers& transfers,
                     const BinVariances& variances, std::size_t left_out, std::size_t m)
    : spectra_(spectra), transfers_(transfers), variances_(variances), m_(m) {
  const auto count = static_cast<Index>(variances.others.size());
  Eigen::MatrixXcd matrix = Eigen::MatrixXcd::Zero(count, count);
  Eigen::VectorXcd with = Eigen::VectorXcd::Zero(count), seen = with;
  double whole = 0.0;
  Complex whole_score;
  for (std::size_t k = 0; k < transfers.size(); ++k) {
    if (k == left_out) continue;
    const double known = bin_weight(transfers, variances, k, m), weight = 1.0 / variances.of[k][m];
    const Complex h = transfers[k][m], y = spectra.responses[k][m];
    told_ += known * std::norm(h);
    score_ += known * std::conj(h) * y;
    if (count == 0) continue;
    const Eigen::VectorXcd elsewhere = others_at(k);
    whole += weight * std::norm(h);
    whole_score += weight * std::conj(h) * y;
    with += weight * h * elsewhere.conjugate();
    seen += weight * y * elsewhere.conjugate();
    matrix += weight * elsewhere.conjugate() * elsewhere.transpose();
  }
  if (count == 0) return;
  for (Index q = 0; q < count; ++q) {
    matrix(q, q) += 1.0 / variances.others[static_cast<std::size_t>(q)].power[m];
  }
  covariance_ = inverse_of_hermitian(matrix);
  given_ = covariance_ * with;
  alone_ = covariance_ * seen;
  // What h is off by takes its share of what is told of F, and nothing of what is told of the
  // others. Rounding is all that is left where no sensor tells the contacts apart.
  const double share = whole > 0.0 ? told_ / whole : 1.0;
  told_ = share * std::max(whole - with.dot(given_).real(), 1e-14 * whole);
  score_ = share * (whole_score - with.dot(alone_));
}

double BinForces::others_taken() const {
  double taken = 0.0;
  for (std::size_t q = 0; q < variances_.others.size(); ++q) {
    const auto i = static_cast<Index>(q);
    taken += 1.0 - covariance_(i, i).real() / variances_.others[q].power[m_];
  }
  return taken;
}

Complex BinForces::left(std::size_t k, Complex force) const {
  const Complex own = spectra_.responses[k][m_] - transfers_[k][m_] * force;
  if (covariance_.size() == 0) return own;
  return own - others_at(k).cwiseProduct(alone_ - given_ * force).sum();
}

double BinForces::variance(std::size_t k) const {
  if (covariance_.size() == 0) return std::norm(transfers_[k][m_]) / told_;
  const Eigen::VectorXcd elsewhere = others_at(k);
  const Complex slope = transfers_[k][m_] - elsewhere.cwiseProduct(given_).sum();
  const Eigen::VectorXcd spread = covariance_ * elsewhere.conjugate();
  return std::norm(slope) / told_ + elsewhere.cwiseProduct(spread).sum().real();
}

Eigen::VectorXcd BinForces::others_at(std::size_t k) const {
  Eigen::VectorXcd result(static_cast<Index>(variances_.others.size()));
  for (Index q = 0; q < result.size(); ++q) {
    result[q] = variances_.others[static_cast<std::size_t>(q)].transfers[k][m_];
  }
  return result;
}

}  // namespace modcal
