#include "libcalib/likelihood/end_state.hpp"

namespace modcal {
namespace {

constexpr double kRidge = 1e-9;
using Index = Eigen::Index;

// Σ conj(κ_m U_m) κ_n U_n and the three sums with U' in the place of U_m, U_n or both.
struct PairSums {
  Complex plain, right_conj, left_conj, both_conj;
};

PairSums pair_sums(Complex left, Complex left_conj, Complex right, Complex right_conj,
                   Complex total, Complex left_pole, Complex right_pole) {
  const Complex pole = std::conj(left_pole);
  return {
      .plain = (std::conj(left) + right - total) / (1.0 - pole * right_pole),
      .right_conj = (std::conj(left) + right_conj - total) / (1.0 - pole * std::conj(right_pole)),
      .left_conj = (std::conj(left_conj) + right - total) / (1.0 - left_pole * right_pole),
      .both_conj =
          (std::conj(left_conj) + right_conj - total) / (1.0 - left_pole * std::conj(right_pole))};
}

// Products of x_m, x'_m with x_n, x'_n.
Eigen::Matrix2d column_products(const PairSums& sums) {
  const auto& [a, b, c, d] = sums;
  Eigen::Matrix2d products;
  products << (a + b + c + d).real(), -(a - b + c - d).imag(), (a + b - c - d).imag(),
      (a - b - c + d).real();
  return products;
}

// m of the odd modes first where the parities differ.
PairSums sums_of(std::span<const LikelihoodMode> modes, std::span<const DecayPowers> powers,
                 const DecayTotals& totals, std::size_t m, std::size_t n) {
  const DecayPowers& left = powers[m];
  const DecayPowers& right = powers[n];
  if (modes[m].even != modes[n].even) {
    return pair_sums(left.mixed, left.mixed_conj, right.mixed, right.mixed_conj, totals.mixed,
                     modes[m].pole, modes[n].pole);
  }
  PairSums sums = pair_sums(left.own, left.own_conj, right.own, right.own_conj,
                            modes[m].even ? totals.even : totals.odd, modes[m].pole, modes[n].pole);
  if (m == n) {  // 1 − |E|² is small: summed by itself
    sums.plain = left.square;
    sums.both_conj = left.square_conj;
  }
  return sums;
}

Eigen::MatrixXd decay_gram(std::span<const LikelihoodMode> modes,
                           std::span<const DecayPowers> powers, const DecayTotals& totals) {
  const auto size = static_cast<Index>(2 * modes.size());
  Eigen::MatrixXd gram(size, size);
  for (std::size_t m = 0; m < modes.size(); ++m) {
    for (std::size_t n = 0; n <= m; ++n) {
      const bool swapped = modes[m].even && !modes[n].even;
      const Eigen::Matrix2d products = column_products(
          swapped ? sums_of(modes, powers, totals, n, m) : sums_of(modes, powers, totals, m, n));
      const auto i = static_cast<Index>(2 * m);
      const auto j = static_cast<Index>(2 * n);
      gram.block<2, 2>(swapped ? j : i, swapped ? i : j) = products;
      gram.block<2, 2>(swapped ? i : j, swapped ? j : i) = products.transpose();
    }
  }
  return gram;
}

using Column = Eigen::Map<const Eigen::VectorXd>;
Column column(const double* numbers) { return Column(numbers, static_cast<Index>(kColumnLength)); }

}  // namespace

EndState::EndState(const WhitenedRecord& record, std::span<const LikelihoodMode> modes)
    : modes_(modes),
      decays_(record.sigma == 0.0),
      size_(decays_ ? 2 * modes.size() : 2),
      powers_(decays_ ? modes.size() : 0),
      gram_(Eigen::MatrixXd::Zero(static_cast<Index>(size_), static_cast<Index>(size_))),
      products_(Eigen::VectorXd::Zero(static_cast<Index>(size_))) {}

void EndState::add(const WhitenedRecord& record, std::size_t block_index,
                   const LikelihoodBlock& block, const double* residual, const double* offsets) {
  if (decays_) {
    add_decay_powers(record, block_index, modes_, block, powers_, totals_);
    add_decay_products(record, block_index, modes_, block, residual, products_.data());
    return;
  }
  const Column data = column(residual);
  const Column left = column(offsets);
  const Column right = column(offsets + kColumnLength);
  gram_(0, 0) += left.squaredNorm();
  gram_(1, 1) += right.squaredNorm();
  gram_(0, 1) += left.dot(right);
  gram_(1, 0) = gram_(0, 1);
  products_[0] += left.dot(data);
  products_[1] += right.dot(data);
}

void EndState::solve() {
  if (decays_) gram_ = decay_gram(modes_, powers_, totals_);
  inverse_norms_ = gram_.diagonal();
  for (double& norm : inverse_norms_) norm = norm > 0.0 ? 1.0 / std::sqrt(norm) : 1.0;
  Eigen::MatrixXd scaled = inverse_norms_.asDiagonal() * gram_ * inverse_norms_.asDiagonal();
  scaled.diagonal().array() += kRidge;
  normal_.compute(scaled);
  const Eigen::VectorXd found = -fit(products_);
  if (!decays_) {
    offset_ = {found[0], found[1]};
    return;
  }
  amplitudes_.resize(modes_.size());
  for (std::size_t n = 0; n < modes_.size(); ++n) {
    const auto i = static_cast<Index>(2 * n);
    amplitudes_[n] = {found[i], found[i + 1]};
  }
}

Eigen::MatrixXd EndState::fit(const Eigen::MatrixXd& products) const {
  return inverse_norms_.asDiagonal() * normal_.solve(inverse_norms_.asDiagonal() * products);
}

}  // namespace modcal
