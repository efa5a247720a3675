#include "libcalib/likelihood/pluck/pluck_evaluation.hpp"

#include <algorithm>

#include "libcalib/likelihood/projected_likelihood.hpp"
#include "libcalib/likelihood/tuning.hpp"
#include "libsim/base/kernels/column_products.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

}  // namespace

PluckEvaluation::Mode PluckEvaluation::mode_of(const LikelihoodMode& mode, const Sensor& sensors,
                                               double sample_rate, double scale) {
  const Complex rate = std::log(mode.pole) * sample_rate;
  const Complex response = (mode.even ? -scale : scale) * sensors.response(rate);
  const Complex by_rate = response * sensors.rate(rate);
  Mode result{.pole = mode.pole,
              .by_frequency = mode.pole_by_frequency / mode.pole,
              .by_damping = mode.pole_by_damping / mode.pole,
              .right = response};
  result.right_by_frequency = by_rate * result.by_frequency * sample_rate;
  result.right_by_damping = by_rate * result.by_damping * sample_rate;
  for (std::size_t i = 0; i < Sensor::kCount; ++i) {
    result.right_by_sensor[i] = sensors.slope(i, rate) * response;
  }
  if (!sensors.smooth.knots.empty()) result.knots = sensors.smooth.place(std::abs(rate.imag()));
  return result;
}

PluckEvaluation::PluckEvaluation(const WhitenedRecord& record, const ModelPoint& point)
    : record_(record), plain_(plain_transients(record, point)) {
  const std::vector<LikelihoodMode> modes = likelihood_modes(point, record.sample_rate);
  for (std::size_t n = 0; n < point.basis.size(); ++n) {
    modes_.push_back(mode_of(modes[n], point.sensors, record.sample_rate,
                             record.deviation[0] / record.deviation[1]));
  }
  const std::size_t width = tiled(linear_unknowns() + 1);
  RowMatrix products = RowMatrix::Zero(static_cast<Index>(width), static_cast<Index>(width));
  AlignedVector left(width * kColumnLength), right(width * kColumnLength);
  for (std::size_t b = 0; b < record.blocks(); ++b) {
    fill_linear(b, left.data(), right.data());
    for (const double* columns : {left.data(), right.data()}) {
      add_products(columns, width, columns, width, true, products.data(), width);
    }
  }
  solve(products);
}

void PluckEvaluation::fill(std::size_t block, std::size_t mode, bool slopes, Decay& decay) const {
  const std::size_t first = block * kBins;
  const std::size_t count = std::min(kBins, record_.bins - first);
  const double* delay_re = record_.delay.re.data() + first;
  const double* delay_im = record_.delay.im.data() + first;
  for (int conjugate = 0; conjugate < 2; ++conjugate) {
    const double pole_re = modes_[mode].pole.real();
    const double pole_im = conjugate ? -modes_[mode].pole.imag() : modes_[mode].pole.imag();
    double* re = decay.re[conjugate];
    double* im = decay.im[conjugate];
    for (std::size_t k = 0; k < count; ++k) {
      const double a = 1.0 - pole_re * delay_re[k] + pole_im * delay_im[k];
      const double b = pole_re * delay_im[k] + pole_im * delay_re[k];
      const double inverse = 1.0 / (a * a + b * b);
      re[k] = a * inverse;
      im[k] = b * inverse;
    }
    std::fill(re + count, re + kBins, 0.0);
    std::fill(im + count, im + kBins, 0.0);
    if (!slopes) continue;
    double* slope_re = decay.re[conjugate + kSlope];
    double* slope_im = decay.im[conjugate + kSlope];
    for (std::size_t k = 0; k < kBins; ++k) {
      slope_re[k] = re[k] * re[k] - im[k] * im[k] - re[k];
      slope_im[k] = 2.0 * re[k] * im[k] - im[k];
    }
  }
}

void PluckEvaluation::add(const Decay& decay, Part part, Complex a, double* column) {
  const double *re = decay.re[part], *im = decay.im[part];
  const double *conj_re = decay.re[part + 1], *conj_im = decay.im[part + 1];
  const double x = a.real(), y = a.imag();
  for (std::size_t k = 0; k < kBins; ++k) {
    column[k] += x * (re[k] + conj_re[k]) - y * (im[k] - conj_im[k]);
    column[kBins + k] += x * (im[k] + conj_im[k]) + y * (re[k] - conj_re[k]);
  }
}

void PluckEvaluation::fill_plain(std::size_t block, const PlanarVector& numbers, double factor,
                                 double* column) const {
  const std::size_t first = block * kBins;
  for (std::size_t k = 0; k < std::min(kBins, record_.bins - first); ++k) {
    column[k] += factor * numbers.re[first + k];
    column[kBins + k] += factor * numbers.im[first + k];
  }
}

// Columns of all that is linear, the data behind them.
void PluckEvaluation::fill_linear(std::size_t block, double* left, double* right) const {
  const std::size_t width = tiled(linear_unknowns() + 1);
  std::fill_n(left, width * kColumnLength, 0.0);
  std::fill_n(right, width * kColumnLength, 0.0);
  Decay decay;
  for (std::size_t n = 0; n < modes_.size(); ++n) {
    fill(block, n, false, decay);
    const std::size_t at = 2 * n * kColumnLength;
    add(decay, kLevel, 1.0, left + at);
    add(decay, kLevel, Complex(0.0, 1.0), left + at + kColumnLength);
    add(decay, kLevel, modes_[n].right, right + at);
    add(decay, kLevel, Complex(0.0, 1.0) * modes_[n].right, right + at + kColumnLength);
  }
  const std::size_t first = 2 * modes_.size();
  for (std::size_t p = 0; p < plain_.size(); ++p) {
    const bool at_right = plain_[p].right;
    fill_plain(block, plain_[p].numbers, 1.0 / record_.deviation[at_right ? 1 : 0],
               (at_right ? right : left) + (first + p) * kColumnLength);
  }
  fill_plain(block, record_.left, 1.0, left + linear_unknowns() * kColumnLength);
  fill_plain(block, record_.right, 1.0, right + linear_unknowns() * kColumnLength);
}

void PluckEvaluation::solve(const RowMatrix& products) {
  const auto count = static_cast<Index>(linear_unknowns());
  const Eigen::MatrixXd gram =
      Eigen::MatrixXd(products.topLeftCorner(count, count)).selfadjointView<Eigen::Lower>();
  const Eigen::VectorXd with_data = products.row(count).head(count).transpose();
  scale_ = gram.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd scaled = scale_.asDiagonal() * gram * scale_.asDiagonal();
  scaled.diagonal().array() += kPluckRidge;
  normal_ = PositiveSolver(scaled);
  linear_ = scale_.asDiagonal() * normal_.solve(scale_.asDiagonal() * with_data);
  cost_ = products(count, count) - 2.0 * linear_.dot(with_data) + linear_.dot(gram * linear_);
  for (std::size_t n = 0; n < modes_.size(); ++n) {
    const auto at = static_cast<Index>(2 * n);
    amplitudes_.emplace_back(linear_[at], linear_[at + 1]);
  }
}

// What one mode adds to the columns of -e: the Jacobian's, and the model behind them.
void PluckEvaluation::add_mode(const LikelihoodColumns& columns, std::size_t mode,
                               const Decay& decay, double* left, double* right) const {
  const Mode& own = modes_[mode];
  const Complex c = amplitudes_[mode];
  const bool any = !columns.share_begin.empty();
  const std::size_t end = any ? columns.share_begin[mode + 1] : 0;
  for (std::size_t i = any ? columns.share_begin[mode] : 0; i < end; ++i) {
    const auto& [column, frequency, damping, residue] = columns.shares[i];
    const Complex slope = c * (frequency * own.by_frequency + damping * own.by_damping);
    const Complex level = c * (frequency * own.right_by_frequency + damping * own.right_by_damping);
    add(decay, kSlope, slope, left + column * kColumnLength);
    add(decay, kSlope, slope * own.right, right + column * kColumnLength);
    if (level != 0.0) add(decay, kLevel, level, right + column * kColumnLength);
  }
  for (std::size_t i = 0; i < Sensor::kCount; ++i) {
    if (!columns.sensors[i]) continue;
    add(decay, kLevel, c * own.right_by_sensor[i], right + *columns.sensors[i] * kColumnLength);
  }
  if (columns.knots > 0) add_knots(columns, mode, decay, right);
  add(decay, kLevel, c, left + columns.count * kColumnLength);
  add(decay, kLevel, c * own.right, right + columns.count * kColumnLength);
}

// Those of the knots on either side of the mode's frequency.
void PluckEvaluation::add_knots(const LikelihoodColumns& columns, std::size_t mode,
                                const Decay& decay, double* right) const {
  const Complex level = amplitudes_[mode] * modes_[mode].right;
  const auto [knot, next] = modes_[mode].knots;
  const double shares[] = {1.0 - next, next};
  for (std::size_t i = 0; i < 2 && shares[i] > 0.0; ++i) {
    double* column = right + (columns.common() + 2 * (knot + i)) * kColumnLength;
    add(decay, kLevel, shares[i] * level, column);
    add(decay, kLevel, Complex(0.0, shares[i]) * level, column + kColumnLength);
  }
}

// Columns of -e and of its derivatives, of both ends.
void PluckEvaluation::fill_jacobian(std::size_t block, const LikelihoodColumns& columns,
                                    double* left, double* right) const {
  const std::size_t width = tiled(columns.count + 1);
  std::fill_n(left, width * kColumnLength, 0.0);
  std::fill_n(right, width * kColumnLength, 0.0);
  Decay decay;
  for (std::size_t n = 0; n < modes_.size(); ++n) {
    fill(block, n, true, decay);
    add_mode(columns, n, decay, left, right);
  }
  double* model[] = {left + columns.count * kColumnLength, right + columns.count * kColumnLength};
  for (std::size_t p = 0; p < plain_.size(); ++p) {
    const std::size_t end = plain_[p].right ? 1 : 0;
    const double factor =
        linear_[static_cast<Index>(2 * modes_.size() + p)] / record_.deviation[end];
    fill_plain(block, plain_[p].numbers, factor, model[end]);
    for (std::size_t i = 0; i < Sensor::kCount; ++i) {
      const PlanarVector& slope = plain_[p].by_sensor[i];
      if (!columns.sensors[i] || slope.size() == 0) continue;
      fill_plain(block, slope, factor, right + *columns.sensors[i] * kColumnLength);
    }
  }
  fill_plain(block, record_.left, -1.0, model[0]);
  fill_plain(block, record_.right, -1.0, model[1]);
}

LikelihoodPoint PluckEvaluation::differentiate(const LikelihoodColumns& columns,
                                               const LikelihoodOutputs& outputs) const {
  if (columns.count == 0 && !outputs.residuals) {
    return {.cost = cost_, .slope = Eigen::VectorXd(0), .information = Eigen::MatrixXd(0, 0)};
  }
  const std::size_t width = tiled(columns.count + 1);
  const std::size_t linear_width = tiled(linear_unknowns() + 1);
  RowMatrix own = RowMatrix::Zero(static_cast<Index>(width), static_cast<Index>(width));
  RowMatrix mixed = RowMatrix::Zero(static_cast<Index>(width), static_cast<Index>(linear_width));
  AlignedVector jacobian[2], linear[2];
  for (std::size_t r = 0; r < 2; ++r) {
    jacobian[r].resize(width * kColumnLength);
    linear[r].resize(linear_width * kColumnLength);
  }
  for (std::size_t b = 0; b < record_.blocks(); ++b) {
    fill_jacobian(b, columns, jacobian[0].data(), jacobian[1].data());
    fill_linear(b, linear[0].data(), linear[1].data());
    for (std::size_t r = 0; r < 2; ++r) {
      add_products(jacobian[r].data(), width, jacobian[r].data(), width, true, own.data(), width);
      add_products(jacobian[r].data(), width, linear[r].data(), linear_width, false, mixed.data(),
                   linear_width);
    }
  }
  const auto n = static_cast<Index>(columns.count);
  const Eigen::MatrixXd products =
      Eigen::MatrixXd(own.topLeftCorner(n + 1, n + 1)).selfadjointView<Eigen::Lower>();
  const Eigen::MatrixXd cross =
      mixed.topLeftCorner(n, static_cast<Index>(linear_unknowns())) * scale_.asDiagonal();
  LikelihoodPoint point{.cost = cost_, .slope = products.col(n).head(n)};
  const Eigen::MatrixXd taken = normal_.solve(cross.transpose());
  point.information = products.topLeftCorner(n, n) - cross * taken;
  if (outputs.residuals || outputs.jacobian) {
    write_rows(columns, scale_.asDiagonal() * taken, outputs);
  }
  return point;
}

void PluckEvaluation::write_rows(const LikelihoodColumns& columns, const Eigen::MatrixXd& taken,
                                 const LikelihoodOutputs& outputs) const {
  const auto length = static_cast<Index>(kColumnLength);
  const auto count = static_cast<Index>(columns.count);
  const auto unknowns = static_cast<Index>(linear_unknowns());
  AlignedVector jacobian[2], linear[2];
  for (std::size_t r = 0; r < 2; ++r) {
    jacobian[r].resize(tiled(columns.count + 1) * kColumnLength);
    linear[r].resize(tiled(linear_unknowns() + 1) * kColumnLength);
  }
  if (outputs.residuals) outputs.residuals->resize(4 * record_.bins);
  if (outputs.jacobian) outputs.jacobian->resize(static_cast<Index>(4 * record_.bins), count);
  using Columns = Eigen::Map<Eigen::MatrixXd>;
  for (std::size_t b = 0; b < record_.blocks(); ++b) {
    fill_jacobian(b, columns, jacobian[0].data(), jacobian[1].data());
    if (outputs.jacobian) fill_linear(b, linear[0].data(), linear[1].data());
    for (std::size_t r = 0; r < 2; ++r) {
      Columns own(jacobian[r].data(), length, count + 1);
      if (outputs.jacobian) {
        own.leftCols(count) -= Columns(linear[r].data(), length, unknowns) * taken;
      }
      for (std::size_t k = 0; k < std::min(kBins, record_.bins - b * kBins); ++k) {
        const std::size_t row = 4 * (b * kBins + k) + 2 * r;
        for (std::size_t part = 0; part < 2; ++part) {
          const auto at = static_cast<Index>(part * kBins + k);
          if (outputs.residuals) (*outputs.residuals)[row + part] = own(at, count);
          if (outputs.jacobian) {
            outputs.jacobian->row(static_cast<Index>(row + part)) = own.row(at).head(count);
          }
        }
      }
    }
  }
}

}  // namespace modcal
