#include "libcalib/likelihood/end_state.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "libcalib/likelihood/tuning.hpp"
#include "libsim/base/kernels/column_products.hpp"

namespace modcal {
namespace {

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

// Σ|u|²/2 over both ends, the square of a column whose bins these share alike; u: numbers/s, or 1
// where they are no constants of the record.
double mean_square(const WhitenedRecord& record, const PlainTransient& transient) {
  const auto bins = static_cast<double>(record.bins);
  if (transient.by_sensor[Sensor::kCorner].size() > 0) return 0.5 * bins;
  double sum = 0.0;
  const auto add = [&](const PlanarVector& numbers, std::size_t end) {
    const double power = 1.0 / (record.deviation[end] * record.deviation[end]);
    for (std::size_t k = 0; numbers.size() > 0 && k < record.bins; ++k) {
      sum += power * std::norm(numbers.at(k));
    }
  };
  add(transient.numbers, transient.right ? 1 : 0);
  add(transient.left, 0);
  return 0.5 * sum;
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

void add_to(AlignedVector& sum, const AlignedVector& part) {
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += part[i];
}

EndState::Sums added(std::span<const EndState::Sums> parts) {
  EndState::Sums sum = parts[0];
  for (const EndState::Sums& part : parts.subspan(1)) {
    add_to(sum.powers, part.powers);
    add_to(sum.products, part.products);
    sum.totals.odd += part.totals.odd;
    sum.totals.even += part.totals.even;
    sum.totals.mixed += part.totals.mixed;
    add_to(sum.plain, part.plain);
    sum.left += part.left;
  }
  return sum;
}

}  // namespace

EndState::EndState(const WhitenedRecord& record, std::span<const LikelihoodMode> modes,
                   std::span<const PlainTransient> plain)
    : modes_(modes), decays_(0), plain_(plain.size()) {
  if (record.sigma == 0.0) {
    decays_ = static_cast<std::size_t>(std::count_if(
        modes.begin(), modes.end(), [](const LikelihoodMode& mode) { return mode.decays; }));
  }
  ridge_.resize(static_cast<Index>(size()));
  // Of a record that is silent that of its noise.
  const double ridge =
      kEndStateRidge / std::max(record.energy, 2.0 * static_cast<double>(record.bins));
  const double samples = 2.0 * std::numbers::pi * record.sample_rate / record.spacing;
  const double scale = ridge * samples / (record.deviation[0] * record.deviation[1]);
  for (std::size_t n = 0; n < decays_; ++n) {
    // |E_n| = e^−loss, loss = ζ_nω_n/f_s, to which ω_n and ζ_n are the same.
    const double loss = 0.5 * modes[n].two_zeta_omega / record.sample_rate;
    const double gain = scale / -std::expm1(-2.0 * loss);
    ridge_.segment<2>(static_cast<Index>(2 * n)).setConstant(gain);
    ridge_slopes_.push_back(2.0 * loss * gain / std::expm1(2.0 * loss));
  }
  for (std::size_t p = 0; p < plain_; ++p) {
    ridge_[static_cast<Index>(2 * decays_ + p)] =
        kPlainShare * ridge * mean_square(record, plain[p]);
  }
}

void EndState::add_gram(const WhitenedRecord& record, std::size_t block_index,
                        const ModeSplit& split, const LikelihoodBlock& block, const double* plain,
                        Sums& sums) const {
  if (plain_ > 0) {
    const std::size_t width = tiled(plain_);
    sums.plain.resize(width * width);
    modcal::add_products(plain, width, plain, width, true, sums.plain.data(), width);
  }
  if (decays_ == 0) return;
  sums.powers.resize(decays_ * kPowerSums * kSumLanes);
  add_decay_powers(record, block_index, split, block, sums.powers.data(), sums.totals);
}

void EndState::add_products(const WhitenedRecord& record, std::size_t block_index,
                            const ModeSplit& split, const LikelihoodBlock& block,
                            const double* columns, Sums& sums) const {
  const std::size_t count = 1 + plain_;
  sums.products.resize(decays_ * 2 * count * kSumLanes);
  // As many at a time as the kernel takes.
  for (std::size_t begin = 0; decays_ > 0 && begin < count; begin += kDecayColumns) {
    add_decay_products(record, block_index, split, block, columns + begin * kColumnLength,
                       std::min(kDecayColumns, count - begin),
                       sums.products.data() + decays_ * 2 * begin * kSumLanes);
  }
  if (plain_ == 0) return;
  const auto length = static_cast<Index>(kColumnLength);
  const Eigen::Map<const Eigen::VectorXd> residual(columns, length);
  const Eigen::Map<const Eigen::MatrixXd> transients(columns + length, length,
                                                     static_cast<Index>(plain_));
  if (sums.left.size() == 0) sums.left.setZero(static_cast<Index>(plain_));
  sums.left += transients.transpose() * residual;
}

// With the residual, then with the plain transients; of these with each other the Gram matrix has
// the products.
EndState::RowMatrix EndState::collect_products(const Sums& sums) const {
  const auto plain = static_cast<Index>(plain_);
  RowMatrix products(static_cast<Index>(size()), 1 + plain);
  for (std::size_t begin = 0; decays_ > 0 && begin < 1 + plain_; begin += kDecayColumns) {
    const std::size_t count = std::min(kDecayColumns, 1 + plain_ - begin);
    RowMatrix part(static_cast<Index>(2 * decays_), static_cast<Index>(count));
    collect_decay_products(sums.products.data() + decays_ * 2 * begin * kSumLanes, decays_, count,
                           part.data());
    products.block(0, static_cast<Index>(begin), part.rows(), part.cols()) = part;
  }
  if (plain_ > 0) {
    products.bottomRows(plain).setZero();
    products.col(0).tail(plain) = sums.left;
  }
  return products;
}

void EndState::solve(std::span<const Sums> parts) {
  const Sums sums = added(parts);
  const RowMatrix products = collect_products(sums);
  const auto first = static_cast<Index>(2 * decays_);
  const auto plain = static_cast<Index>(plain_);
  Eigen::MatrixXd gram(first + plain, first + plain);
  if (decays_ > 0) {
    std::vector<DecayPowers> powers(decays_);
    collect_decay_powers(sums.powers.data(), powers);
    gram.topLeftCorner(first, first) = decay_gram(modes_.first(decays_), powers, sums.totals);
  }
  if (plain_ > 0) {
    const auto width = static_cast<Index>(tiled(plain_));
    const Eigen::Map<const RowMatrix> lower(sums.plain.data(), width, width);
    gram.bottomRightCorner(plain, plain) =
        Eigen::MatrixXd(lower.topLeftCorner(plain, plain)).selfadjointView<Eigen::Lower>();
    gram.topRightCorner(first, plain) = products.topRightCorner(first, plain);
    gram.bottomLeftCorner(plain, first) = products.topRightCorner(first, plain).transpose();
  }

  inverse_norms_ = gram.diagonal();
  for (double& norm : inverse_norms_) norm = norm > 0.0 ? 1.0 / std::sqrt(norm) : 1.0;
  Eigen::MatrixXd scaled = inverse_norms_.asDiagonal() * gram * inverse_norms_.asDiagonal();
  scaled.diagonal() += ridge_.cwiseProduct(inverse_norms_.cwiseAbs2());
  normal_ = PositiveSolver(scaled);
  find(products.col(0));
}

void EndState::solve_again(std::span<const Sums> parts) {
  find(collect_products(added(parts)).col(0));
}

void EndState::find(const Eigen::VectorXd& products) {
  found_ = -fit(products);
  amplitudes_.clear();
  for (std::size_t n = 0; n < decays_; ++n) {
    const auto i = static_cast<Index>(2 * n);
    amplitudes_.emplace_back(found_[i], found_[i + 1]);
  }
  plain_amplitudes_.assign(found_.end() - static_cast<Index>(plain_), found_.end());
  cost_ = found_.cwiseAbs2().dot(ridge_);
}

double EndState::slope(std::size_t n) const {
  return -0.5 * ridge_slopes_[n] * std::norm(amplitudes_[n]);
}

Eigen::VectorXd EndState::root_slope(const Eigen::VectorXd& slope,
                                     const Eigen::MatrixXd& fit) const {
  if (!(cost_ > 0.0)) return Eigen::VectorXd::Zero(slope.size());
  return (slope - fit.transpose() * ridge_.cwiseProduct(found_)) / std::sqrt(cost_);
}

Eigen::MatrixXd EndState::fit(const Eigen::MatrixXd& products) const {
  return inverse_norms_.asDiagonal() * normal_.solve(inverse_norms_.asDiagonal() * products);
}

}  // namespace modcal
