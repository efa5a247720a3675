#include "libcalib/likelihood/projected_likelihood.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

constexpr double kRidge = 1e-9;
constexpr std::size_t kTile = 4;

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

std::size_t tiled(std::size_t count) { return (count + kTile - 1) / kTile * kTile; }

Eigen::MatrixXd symmetric(const RowMatrix& lower, std::size_t count) {
  const auto n = static_cast<Eigen::Index>(count);
  return Eigen::MatrixXd(lower.topLeftCorner(n, n)).selfadjointView<Eigen::Lower>();
}

}  // namespace

std::vector<LikelihoodMode> likelihood_modes(const ModelPoint& point, double sample_rate) {
  const ModalBasis& basis = point.basis;
  const double wave = std::numbers::pi / basis.length;
  const std::vector<double> shape = basis.shape_at(point.contact);
  std::vector<LikelihoodMode> modes(basis.size());
  for (std::size_t i = 0; i < modes.size(); ++i) {
    const double n = static_cast<double>(i + 1);
    const double omega = basis.omega[i];
    const double zeta = basis.zeta[i];
    MODCAL_REQUIRE(zeta > 0.0 && zeta < 1.0,
                   "damping ratio {:g} of mode {}: the likelihood needs 0 < zeta < 1", zeta, i + 1);
    MODCAL_REQUIRE(omega > 0.0 && omega < std::numbers::pi * sample_rate,
                   "mode {} at {:g} Hz lies above the Nyquist frequency {:g} Hz: use fewer modes",
                   i + 1, basis.frequency(i), 0.5 * sample_rate);
    const double gain = basis.tension * n * wave / basis.mass[i];
    const double root = std::sqrt(1.0 - zeta * zeta);
    const Complex rate(-zeta * omega, omega * root);
    LikelihoodMode& mode = modes[i];
    mode.even = i % 2 == 1;
    mode.residue = gain * shape[i];
    mode.residue_slope = gain * n * wave * std::cos(n * wave * point.contact);
    mode.omega_squared = omega * omega;
    mode.two_zeta_omega = 2.0 * zeta * omega;
    mode.pole = std::exp(rate / sample_rate);
    mode.pole_by_frequency = mode.pole * rate / sample_rate;
    mode.pole_by_damping =
        mode.pole * Complex(-zeta * omega, -omega * zeta * zeta / root) / sample_rate;
  }
  return modes;
}

struct ProjectedLikelihood::Workspace {
  Workspace(std::vector<LikelihoodMode> the_modes, std::size_t state_count, std::size_t block_count)
      : modes(std::move(the_modes)),
        state_width(tiled(state_count)),
        state_used(state_count),
        blocks(block_count),
        state(state_width * kColumnLength * block_count),
        residual(kColumnLength * block_count),
        coefficients(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(state_count))) {}
  double* state_of(std::size_t b) { return state.data() + b * state_width * kColumnLength; }
  double* residual_of(std::size_t b) { return residual.data() + b * kColumnLength; }

  std::vector<LikelihoodMode> modes;
  std::size_t state_width, state_used;
  std::vector<LikelihoodBlock> blocks;
  AlignedVector state;     // state_width columns a block
  AlignedVector residual;  // one column a block
  Eigen::VectorXd scale;   // norms of the state's columns
  Eigen::LLT<Eigen::MatrixXd> normal;
  Eigen::VectorXd coefficients;

  void factor(const RowMatrix& products) {
    Eigen::MatrixXd gram = symmetric(products, state_used);
    scale = gram.diagonal().cwiseSqrt();
    for (Eigen::Index i = 0; i < scale.size(); ++i) {
      if (!(scale[i] > 0.0)) scale[i] = 1.0;
    }
    const Eigen::VectorXd inverse = scale.cwiseInverse();
    gram = inverse.asDiagonal() * gram * inverse.asDiagonal();
    gram.diagonal().array() += kRidge;
    normal.compute(gram);
  }
  Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const {
    const Eigen::VectorXd inverse = scale.cwiseInverse();
    return inverse.asDiagonal() * normal.solve(inverse.asDiagonal() * right);
  }
};

ProjectedLikelihood::ProjectedLikelihood(WhitenedRecord record, bool end_state)
    : record_(std::move(record)), end_state_(end_state) {
  MODCAL_REQUIRE(end_state || record_.sigma > 0.0,
                 "without damping of the record its end state must be projected out");
}

void ProjectedLikelihood::set_weights(std::span<const double> weights) {
  MODCAL_REQUIRE(weights.size() == record_.bins, "{} weights for {} bins", weights.size(),
                 record_.bins);
  for (std::size_t k = 0; k < weights.size(); ++k) {
    MODCAL_REQUIRE(weights[k] >= 0.0 && weights[k] <= 1.0, "weight {:g} must lie in [0, 1]",
                   weights[k]);
    record_.root_weight[k] = std::sqrt(weights[k]);
  }
}

std::size_t ProjectedLikelihood::state_columns(std::size_t modes) const {
  return (end_state_ ? 2 * modes : 0) + (record_.sigma > 0.0 ? 2 : 0);
}

double ProjectedLikelihood::degrees_of_freedom(std::size_t parameters, std::size_t modes) const {
  return 2.0 * static_cast<double>(record_.bins) -
         static_cast<double>(state_columns(modes) + parameters);
}

// First pass and the linear unknowns. keep_state: the columns stand from the pass before, only the
// data changed.
void ProjectedLikelihood::project(const WhitenedRecord& record, Workspace& work,
                                  bool keep_state) const {
  const auto width = static_cast<Eigen::Index>(work.state_width);
  const std::size_t offsets = end_state_ ? 2 * work.modes.size() : 0;
  RowMatrix products = RowMatrix::Zero(width, width);
  Eigen::VectorXd data = Eigen::VectorXd::Zero(width);
  for (std::size_t b = 0; b < work.blocks.size(); ++b) {
    double* state = work.state_of(b);
    double* residual = work.residual_of(b);
    fill_state_columns(
        record, b, work.modes, work.blocks[b], end_state_ && !keep_state ? state : nullptr,
        record.sigma > 0.0 && !keep_state ? state + offsets * kColumnLength : nullptr, residual);
    add_products(residual, 1, state, work.state_width, false, data.data(), work.state_width);
    if (keep_state) continue;
    add_products(state, work.state_width, state, work.state_width, true, products.data(),
                 work.state_width);
  }
  if (!keep_state) work.factor(products);
  work.coefficients = -work.solve(data.head(static_cast<Eigen::Index>(work.state_used)));
}

LikelihoodPoint ProjectedLikelihood::differentiate(const WhitenedRecord& record,
                                                   const LikelihoodColumns& columns,
                                                   Workspace& work, const Outputs& outputs) const {
  assert(columns.count == 0 || columns.share_begin.size() == work.modes.size() + 1);
  const std::size_t count = columns.count;
  const std::size_t width = tiled(count + 1);
  const std::size_t bins = record.bins;
  const auto n = static_cast<Eigen::Index>(count);
  const auto used = static_cast<Eigen::Index>(work.state_used);
  AlignedVector buffer(width * kColumnLength);
  AlignedVector kept(outputs.jacobian ? width * kColumnLength * work.blocks.size() : 0);
  std::vector<Complex> amplitudes(end_state_ ? work.modes.size() : 0);
  for (std::size_t i = 0; i < amplitudes.size(); ++i) {
    const auto j = static_cast<Eigen::Index>(2 * i);
    amplitudes[i] = {work.coefficients[j], work.coefficients[j + 1]};
  }
  JacobianTask task{.modes = work.modes,
                    .amplitudes = amplitudes,
                    .shares = columns.shares,
                    .share_begin = columns.share_begin};
  if (record.sigma > 0.0) {
    task.offset = {work.coefficients[used - 2], work.coefficients[used - 1]};
  }
  std::vector<Complex> force(outputs.force ? work.blocks.size() * LikelihoodBlock::kBins : 0);

  const auto w = static_cast<Eigen::Index>(width);
  const auto sw = static_cast<Eigen::Index>(work.state_width);
  RowMatrix own = RowMatrix::Zero(w, w);
  RowMatrix mixed = RowMatrix::Zero(w, sw);
  RowMatrix own2, mixed2, state2;
  AlignedVector scaled;
  if (outputs.twice_weighted) {
    own2 = own, mixed2 = mixed, state2 = RowMatrix::Zero(sw, sw);
    scaled.resize((width + work.state_width) * kColumnLength);
  }
  for (std::size_t b = 0; b < work.blocks.size(); ++b) {
    double* jacobian = outputs.jacobian ? kept.data() + b * width * kColumnLength : buffer.data();
    std::fill_n(jacobian, width * kColumnLength, 0.0);
    double* residual = jacobian + count * kColumnLength;
    std::copy_n(work.residual_of(b), kColumnLength, residual);
    task.jacobian = columns.shares.empty() ? nullptr : jacobian;
    task.contact = columns.contact ? jacobian + *columns.contact * kColumnLength : nullptr;
    task.residual = residual;
    task.force = outputs.force ? force.data() + b * LikelihoodBlock::kBins : nullptr;
    fill_jacobian_columns(record, b, work.blocks[b], task);
    add_products(jacobian, width, jacobian, width, true, own.data(), width);
    if (count > 0) {
      add_products(jacobian, width, work.state_of(b), work.state_width, false, mixed.data(),
                   work.state_width);
    }
    if (outputs.residuals) {
      for (std::size_t k = 0; k < LikelihoodBlock::kBins; ++k) {
        const std::size_t row = b * LikelihoodBlock::kBins + k;
        if (row >= bins) break;
        (*outputs.residuals)[2 * row] = residual[k];
        (*outputs.residuals)[2 * row + 1] = residual[LikelihoodBlock::kBins + k];
      }
    }
    if (!outputs.twice_weighted) continue;
    const double* root = record.root_weight.data() + b * LikelihoodBlock::kBins;
    const auto scale_columns = [&](const double* from, std::size_t columns_count, double* to) {
      for (std::size_t i = 0; i < columns_count * kColumnLength; ++i) {
        to[i] = from[i] * root[i % LikelihoodBlock::kBins];
      }
    };
    double* scaled_state = scaled.data() + width * kColumnLength;
    scale_columns(jacobian, width, scaled.data());
    scale_columns(work.state_of(b), work.state_width, scaled_state);
    add_products(scaled.data(), width, scaled.data(), width, true, own2.data(), width);
    add_products(scaled.data(), width, scaled_state, work.state_width, false, mixed2.data(),
                 work.state_width);
    add_products(scaled_state, work.state_width, scaled_state, work.state_width, true,
                 state2.data(), work.state_width);
  }
  const Eigen::MatrixXd products = symmetric(own, count + 1);
  LikelihoodPoint point{.cost = products(n, n), .slope = products.col(n).head(n)};
  if (outputs.amplitudes) *outputs.amplitudes = amplitudes;
  if (outputs.force) outputs.force->assign(force.begin(), force.begin() + static_cast<long>(bins));
  if (outputs.gain) {
    outputs.gain->resize(bins);
    for (std::size_t k = 0; k < bins; ++k) {
      (*outputs.gain)[k] =
          1.0 / work.blocks[k / LikelihoodBlock::kBins].norm[k % LikelihoodBlock::kBins];
    }
  }
  if (count == 0) return point;
  const Eigen::MatrixXd cross = mixed.topLeftCorner(n, used);
  const Eigen::MatrixXd fit = work.solve(cross.transpose());
  point.information = products.topLeftCorner(n, n) - cross * fit;
  if (outputs.twice_weighted) {
    const Eigen::MatrixXd cross2 = mixed2.topLeftCorner(n, used);
    const Eigen::MatrixXd half = cross2 * fit;
    point.twice_weighted = symmetric(own2, count) - half - half.transpose() +
                           fit.transpose() * symmetric(state2, work.state_used) * fit;
  }
  if (outputs.jacobian) {
    outputs.jacobian->resize(static_cast<Eigen::Index>(2 * bins), n);
    const std::size_t stride = LikelihoodBlock::kBins;
    for (std::size_t k = 0; k < bins; ++k) {
      const std::size_t b = k / stride;
      for (const std::size_t part : {0u, 1u}) {
        const std::size_t at = part * stride + k % stride;
        const double* jacobian = kept.data() + b * width * kColumnLength + at;
        const double* state = work.state_of(b) + at;
        const auto row = static_cast<Eigen::Index>(2 * k + part);
        Eigen::RowVectorXd line(n);
        for (Eigen::Index i = 0; i < n; ++i) {
          line[i] = jacobian[static_cast<std::size_t>(i) * kColumnLength];
        }
        for (Eigen::Index j = 0; j < used; ++j) {
          line -= state[static_cast<std::size_t>(j) * kColumnLength] * fit.row(j);
        }
        outputs.jacobian->row(row) = line;
      }
    }
  }
  return point;
}

double ProjectedLikelihood::cost(const ModelPoint& point) const {
  return evaluate(point, LikelihoodColumns{}).cost;
}

LikelihoodPoint ProjectedLikelihood::evaluate(const ModelPoint& point,
                                              const LikelihoodColumns& columns,
                                              const Outputs& outputs) const {
  Workspace work(likelihood_modes(point, record_.sample_rate), state_columns(point.basis.size()),
                 record_.blocks());
  project(record_, work, false);
  return differentiate(record_, columns, work, outputs);
}

Eigen::MatrixXd ProjectedLikelihood::noise_information(const ModelPoint& point,
                                                       const LikelihoodColumns& columns,
                                                       std::size_t repeats) const {
  Workspace work(likelihood_modes(point, record_.sample_rate), state_columns(point.basis.size()),
                 record_.blocks());
  project(record_, work, false);
  const auto n = static_cast<Eigen::Index>(columns.count);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t r = 0; r < repeats; ++r) {
    const WhitenedRecord noise = record_.noise(r);
    project(noise, work, true);
    sum += differentiate(noise, columns, work, {}).information;
  }
  return sum / static_cast<double>(repeats);
}

}  // namespace modcal
