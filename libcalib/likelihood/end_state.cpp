#include "libcalib/likelihood/end_state.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace modcal {
namespace {

constexpr double kRidge = 1e-9;
// Powers of s at either end: as many as go with the residual and a sensor's decay.
constexpr std::size_t smooth_powers() { return (kDecayColumns - 2) / 2; }
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
    sum.plain += part.plain;
  }
  return sum;
}

// What modes above the band leave ringing is smooth in it: powers of iω/ω_top.
void add_smooth_transients(const WhitenedRecord& record, std::vector<PlainTransient>& transients) {
  const double top = record.omega[record.bins - 1];
  for (const bool right : {false, true}) {
    std::vector<Complex> numbers(record.bins, record.deviation[right ? 1 : 0]);
    for (std::size_t power = 0; power < smooth_powers(); ++power) {
      transients.push_back({right, PlanarVector(record.root_weight.size())});
      for (std::size_t k = 0; k < record.bins; ++k) {
        transients.back().numbers.set(k, numbers[k]);
        numbers[k] *= Complex(0.0, record.omega[k] / top);
      }
    }
  }
}

// One sample, which smooth transients hold already, and the sensor's own decay.
void add_sensor_transients(const WhitenedRecord& record, const Sensor& sensors,
                           std::vector<PlainTransient>& transients) {
  const std::size_t padded = record.root_weight.size();
  PlainTransient sample{true, PlanarVector(padded)};
  PlainTransient decay{true, PlanarVector(padded)};
  PlanarVector& by_corner = decay.by_sensor[Sensor::kCorner] = PlanarVector(padded);
  const double pole = std::exp(-sensors.corner / record.sample_rate);
  for (std::size_t k = 0; k < record.bins; ++k) {
    sample.numbers.set(k, record.deviation[1]);
    const Complex u = 1.0 / (1.0 - pole * record.delay.at(k));
    decay.numbers.set(k, record.deviation[1] * u);
    // dU/dE = U² z^−1 and E U z^−1 = U − 1.
    by_corner.set(k, record.deviation[1] * u * (1.0 - u) / record.sample_rate);
  }
  if (transients.empty()) transients.push_back(std::move(sample));
  transients.push_back(std::move(decay));
}

// Σ_j q^j and Σ_j (2j/n − 1) q^j over n samples, q = e^{±iω_h/f_s} z^−1 at σ, of which q^n is the
// same in every bin: geometric series. A line that stands in a bin is all there.
struct LineSums {
  Complex steady, changing;
};
LineSums line_sums(Complex ratio, Complex power, double samples) {
  const Complex off = 1.0 - ratio;
  // Beyond, the difference of two sums of about n takes as many digits as the limit's error leaves.
  if (std::abs(off) * samples < 1e-5) return {samples, -1.0};
  const Complex sum = (1.0 - power) / off;
  const Complex by_place = (ratio * sum - samples * power) / off;
  return {sum, 2.0 / samples * by_place - sum};
}

// Cosine and sine of the lines of the mains, steady and growing over the record: its frequency is
// known and steady but to a fraction of 1/T.
void add_lines(const WhitenedRecord& record, std::vector<PlainTransient>& transients) {
  const double samples = 2.0 * std::numbers::pi * record.sample_rate / record.spacing;
  const double norm = 1.0 / std::sqrt(samples);
  for (const double line : record.lines) {
    const Complex turn = std::polar(1.0, line / record.sample_rate);
    const Complex end = std::exp(Complex(-record.sigma, line) * samples / record.sample_rate);
    std::array<PlanarVector, 4> waves;
    waves.fill(PlanarVector(record.root_weight.size()));
    for (std::size_t k = 0; k < record.bins; ++k) {
      const Complex delay = record.delay.at(k);
      const LineSums forward = line_sums(turn * delay, end, samples);
      const LineSums backward = line_sums(std::conj(turn) * delay, std::conj(end), samples);
      waves[0].set(k, 0.5 * norm * (forward.steady + backward.steady));
      waves[1].set(k, Complex(0.0, -0.5) * norm * (forward.steady - backward.steady));
      waves[2].set(k, 0.5 * norm * (forward.changing + backward.changing));
      waves[3].set(k, Complex(0.0, -0.5) * norm * (forward.changing - backward.changing));
    }
    for (const bool right : {false, true}) {
      for (const PlanarVector& wave : waves) transients.push_back({right, wave});
    }
  }
}

// The residual takes what is at x = L from the record, and adds what is at x = 0.
void add_signals(const WhitenedRecord& record, std::vector<PlainTransient>& transients) {
  for (const SignalColumn& signal : record.signals) {
    PlanarVector left(record.root_weight.size()), right(record.root_weight.size());
    for (std::size_t k = 0; k < record.bins; ++k) {
      left.set(k, -record.deviation[0] * signal.left.at(k));
      right.set(k, record.deviation[1] * signal.right.at(k));
    }
    transients.push_back({true, std::move(right), std::move(left)});
  }
}

using Columns = Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic>>;

}  // namespace

std::vector<PlainTransient> plain_transients(const WhitenedRecord& record,
                                             const ModelPoint& point) {
  std::vector<PlainTransient> transients;
  if (record.sigma > 0.0) {
    transients = {{false, record.offset}, {true, record.offset}};
  } else {
    if (point.higher) add_smooth_transients(record, transients);
    if (point.sensors.may_differ()) add_sensor_transients(record, point.sensors, transients);
  }
  add_lines(record, transients);
  add_signals(record, transients);
  return transients;
}

EndState::EndState(const WhitenedRecord& record, std::span<const LikelihoodMode> modes,
                   std::size_t plain)
    : modes_(modes), decays_(0), plain_(plain) {
  if (record.sigma > 0.0) return;
  decays_ = static_cast<std::size_t>(std::count_if(
      modes.begin(), modes.end(), [](const LikelihoodMode& mode) { return mode.decays; }));
}

void EndState::add_gram(const WhitenedRecord& record, std::size_t block_index,
                        const ModeSplit& split, const LikelihoodBlock& block, Sums& sums) const {
  if (decays_ == 0) return;
  sums.powers.resize(decays_ * kPowerSums * kSumLanes);
  add_decay_powers(record, block_index, split, block, sums.powers.data(), sums.totals);
}

void EndState::add_products(const WhitenedRecord& record, std::size_t block_index,
                            const ModeSplit& split, const LikelihoodBlock& block,
                            const double* columns, Sums& sums) const {
  const std::size_t count = 1 + plain_;
  if (sums.plain.size() == 0) {
    sums.products.resize(decays_ * 2 * count * kSumLanes);
    sums.plain.setZero(static_cast<Index>(count), static_cast<Index>(count));
  }
  // As many at a time as the kernel takes.
  for (std::size_t begin = 0; decays_ > 0 && begin < count; begin += kDecayColumns) {
    add_decay_products(record, block_index, split, block, columns + begin * kColumnLength,
                       std::min(kDecayColumns, count - begin),
                       sums.products.data() + decays_ * 2 * begin * kSumLanes);
  }
  if (plain_ == 0) return;
  const Columns all(columns, static_cast<Index>(kColumnLength), static_cast<Index>(count));
  sums.plain += all.transpose() * all;
}

// With the residual, then with the plain transients.
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
  products.bottomRows(plain) = sums.plain.bottomRows(plain);
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
  gram.rightCols(plain) = products.rightCols(plain);
  gram.bottomLeftCorner(plain, first) = products.topRightCorner(first, plain).transpose();

  inverse_norms_ = gram.diagonal();
  for (double& norm : inverse_norms_) norm = norm > 0.0 ? 1.0 / std::sqrt(norm) : 1.0;
  Eigen::MatrixXd scaled = inverse_norms_.asDiagonal() * gram * inverse_norms_.asDiagonal();
  scaled.diagonal().array() += kRidge;
  normal_ = PositiveSolver(scaled);
  find(products.col(0));
}

void EndState::solve_again(std::span<const Sums> parts) {
  find(collect_products(added(parts)).col(0));
}

void EndState::find(const Eigen::VectorXd& products) {
  const Eigen::VectorXd found = -fit(products);
  amplitudes_.clear();
  for (std::size_t n = 0; n < decays_; ++n) {
    const auto i = static_cast<Index>(2 * n);
    amplitudes_.emplace_back(found[i], found[i + 1]);
  }
  plain_amplitudes_.assign(found.end() - static_cast<Index>(plain_), found.end());
}

Eigen::MatrixXd EndState::fit(const Eigen::MatrixXd& products) const {
  return inverse_norms_.asDiagonal() * normal_.solve(inverse_norms_.asDiagonal() * products);
}

}  // namespace modcal
