#include "libcalib/likelihood/end_state.hpp"

#include <cmath>

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

std::vector<PlainTransient> plain_transients(const WhitenedRecord& record,
                                             const SensorPair& sensors) {
  if (record.sigma > 0.0) return {{false, record.offset, {}}, {true, record.offset, {}}};
  if (sensors.alike()) return {};
  const std::size_t padded = record.root_weight.size();
  PlainTransient sample{true, PlanarVector(padded), {}};
  PlainTransient decay{true, PlanarVector(padded), PlanarVector(padded)};
  const double pole = std::exp(-sensors.corner / record.sample_rate);
  for (std::size_t k = 0; k < record.bins; ++k) {
    sample.numbers.set(k, record.deviation[1]);
    const Complex u = 1.0 / (1.0 - pole * record.delay.at(k));
    decay.numbers.set(k, record.deviation[1] * u);
    // dU/dE = U² z^−1 and E U z^−1 = U − 1.
    decay.by_corner.set(k, record.deviation[1] * u * (1.0 - u) / record.sample_rate);
  }
  return {std::move(sample), std::move(decay)};
}

EndState::EndState(const WhitenedRecord& record, std::span<const LikelihoodMode> modes,
                   std::size_t plain)
    : modes_(modes),
      plain_(plain),
      powers_(record.sigma == 0.0 ? modes.size() : 0),
      gram_(Eigen::MatrixXd::Zero(static_cast<Index>(size()), static_cast<Index>(size()))),
      products_(Eigen::VectorXd::Zero(static_cast<Index>(size()))) {}

void EndState::add(const WhitenedRecord& record, std::size_t block_index,
                   const LikelihoodBlock& block, const double* residual, const double* plain) {
  const auto first = static_cast<Index>(2 * decays());
  if (decays() > 0) {
    add_decay_powers(record, block_index, modes_, block, powers_, totals_);
    add_decay_products(record, block_index, modes_, block, residual, products_.data());
  }
  for (std::size_t p = 0; p < plain_; ++p) {
    const auto i = first + static_cast<Index>(p);
    const double* own = plain + p * kColumnLength;
    products_[i] += column(own).dot(column(residual));
    for (std::size_t q = 0; q <= p; ++q) {
      gram_(i, first + static_cast<Index>(q)) += column(own).dot(column(plain + q * kColumnLength));
    }
    // Beside the decays' own square, whose columns are as long as this one's.
    if (decays() > 0) {
      add_decay_products(record, block_index, modes_, block, own, gram_.col(i).data());
    }
  }
}

void EndState::solve() {
  const auto first = static_cast<Index>(2 * decays());
  if (decays() > 0) gram_.topLeftCorner(first, first) = decay_gram(modes_, powers_, totals_);
  for (Index i = first; i < gram_.rows(); ++i) {
    gram_.row(i).head(first) = gram_.col(i).head(first).transpose();
    for (Index j = first; j < i; ++j) gram_(j, i) = gram_(i, j);
  }
  inverse_norms_ = gram_.diagonal();
  for (double& norm : inverse_norms_) norm = norm > 0.0 ? 1.0 / std::sqrt(norm) : 1.0;
  Eigen::MatrixXd scaled = inverse_norms_.asDiagonal() * gram_ * inverse_norms_.asDiagonal();
  scaled.diagonal().array() += kRidge;
  normal_.compute(scaled);
  const Eigen::VectorXd found = -fit(products_);
  for (Index i = 0; i < first; i += 2) amplitudes_.emplace_back(found[i], found[i + 1]);
  plain_amplitudes_.assign(found.begin() + first, found.end());
}

Eigen::MatrixXd EndState::fit(const Eigen::MatrixXd& products) const {
  return inverse_norms_.asDiagonal() * normal_.solve(inverse_norms_.asDiagonal() * products);
}

}  // namespace modcal
