#include "libcalib/likelihood/likelihood_evaluation.hpp"

#include <algorithm>
#include <cassert>

#include "libcalib/likelihood/column_products.hpp"
#include "libcalib/likelihood/projected_likelihood.hpp"

namespace modcal {
namespace {

constexpr std::size_t kBins = LikelihoodBlock::kBins;

Eigen::MatrixXd symmetric(const auto& lower, std::size_t count) {
  const auto n = static_cast<Eigen::Index>(count);
  return Eigen::MatrixXd(lower.topLeftCorner(n, n)).template selfadjointView<Eigen::Lower>();
}

// Calls give(row, real or imaginary part's place in the block's column) for the bins of a block.
template <typename Give>
void for_rows(std::size_t b, std::size_t bins, Give give) {
  const std::size_t count = std::min(kBins, bins - b * kBins);
  for (std::size_t k = 0; k < count; ++k) {
    give(2 * (b * kBins + k), k);
    give(2 * (b * kBins + k) + 1, kBins + k);
  }
}

PlanarVector sensor_response(const WhitenedRecord& record, const SensorPair& sensors) {
  PlanarVector response(record.root_weight.size());
  for (std::size_t k = 0; k < record.bins; ++k) {
    const Complex s(record.sigma, record.spacing * static_cast<double>(record.first + k));
    response.set(k, sensors.response(s));
  }
  return response;
}

}  // namespace

// The Jacobian's columns, the residual behind them; of one block, or of all where they are kept.
struct LikelihoodEvaluation::Columns {
  Columns(std::size_t column_count, std::size_t block_count, bool keep)
      : count(column_count),
        width(tiled(column_count + 1)),
        kept(keep),
        numbers(width * kColumnLength * (keep ? block_count : 1)) {}
  double* of(std::size_t b) { return numbers.data() + (kept ? b * width * kColumnLength : 0); }

  std::size_t count, width;
  bool kept;
  AlignedVector numbers;
};

LikelihoodEvaluation::LikelihoodEvaluation(const WhitenedRecord& record, const ModelPoint& point)
    : record_(record),
      sensors_(point.sensors),
      modes_(likelihood_modes(point, record.sample_rate)),
      plain_(plain_transients(record, point.sensors)),
      end_state_(record, modes_, plain_.size()),
      state_width_(tiled(end_state_.size())),
      blocks_(record.blocks()),
      residual_(kColumnLength * record.blocks()),
      plain_columns_(plain_.size() * kColumnLength * record.blocks()) {
  if (!sensors_.alike()) sensor_ = sensor_response(record, sensors_);
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    fill_block(record_, b, modes_, sensor_ ? &*sensor_ : nullptr, blocks_[b], residual_of(b));
    for (std::size_t p = 0; p < plain_.size(); ++p) {
      fill_plain_column(record_, b, blocks_[b], plain_[p].right, plain_[p].numbers,
                        plain_of(b) + p * kColumnLength);
    }
    end_state_.add(record_, b, blocks_[b], residual_of(b), plain_of(b));
  }
  end_state_.solve();
  sum_plain();
}

void LikelihoodEvaluation::sum_plain() {
  const auto add = [this](const PlanarVector& numbers, double amplitude,
                          std::optional<PlanarVector>& sum) {
    if (numbers.size() == 0) return;
    if (!sum) sum.emplace(record_.root_weight.size());
    for (std::size_t k = 0; k < record_.bins; ++k) {
      sum->set(k, sum->at(k) + amplitude * numbers.at(k));
    }
  };
  for (std::size_t p = 0; p < plain_.size(); ++p) {
    add(plain_[p].numbers, end_state_.plain_amplitude(p), plain_sums_[plain_[p].right ? 1 : 0]);
    add(plain_[p].by_corner, end_state_.plain_amplitude(p), by_corner_);
  }
}

// Columns of the end state; the decays' sums over the modes on the way.
const double* LikelihoodEvaluation::state_columns(std::size_t b, bool wanted) {
  if (wanted) state_.resize(state_width_ * kColumnLength);
  const std::size_t decays = 2 * end_state_.decays();
  if (decays > 0) {
    fill_decays(record_, b, modes_, end_state_.amplitudes(), blocks_[b],
                wanted ? state_.data() : nullptr);
  }
  if (wanted) {
    std::copy_n(plain_of(b), plain_.size() * kColumnLength,
                state_.begin() + static_cast<long>(decays * kColumnLength));
  }
  return state_.data();
}

void LikelihoodEvaluation::fill_columns(std::size_t b, const LikelihoodColumns& columns,
                                        double* jacobian, std::complex<double>* force) {
  double* residual = jacobian + columns.count * kColumnLength;
  std::fill_n(jacobian, tiled(columns.count + 1) * kColumnLength, 0.0);
  std::copy_n(residual_of(b), kColumnLength, residual);
  const auto place = [&](const std::optional<std::size_t>& column) {
    return column ? jacobian + *column * kColumnLength : nullptr;
  };
  const auto given = [](const std::optional<PlanarVector>& numbers) {
    return numbers ? &*numbers : nullptr;
  };
  fill_jacobian_columns(
      record_, b, blocks_[b],
      {.modes = modes_,
       .amplitudes = end_state_.amplitudes(),
       .sensor = given(sensor_),
       .plain = {given(plain_sums_[0]), given(plain_sums_[1])},
       .shares = columns.shares,
       .share_begin = columns.share_begin,
       .jacobian = columns.shares.empty() ? nullptr : jacobian,
       .contact = place(columns.contact),
       .sensors = {place(columns.gain), place(columns.delay), place(columns.corner)},
       .plain_by_corner = given(by_corner_),
       .corner = sensors_.corner,
       .residual = residual,
       .force = force});
}

LikelihoodPoint LikelihoodEvaluation::differentiate(const LikelihoodColumns& columns,
                                                    const LikelihoodOutputs& outputs) {
  assert(columns.count == 0 || columns.share_begin.size() == modes_.size() + 1);
  const bool keep = outputs.jacobian || outputs.twice_weighted;
  Columns work(columns.count, blocks_.size(), keep);
  const auto n = static_cast<Eigen::Index>(work.count);
  const auto width = static_cast<Eigen::Index>(work.width);
  const auto state_width = static_cast<Eigen::Index>(state_width_);
  RowMatrix own = RowMatrix::Zero(width, width);
  RowMatrix mixed = RowMatrix::Zero(width, state_width);
  std::vector<Complex> force(outputs.force ? blocks_.size() * kBins : 0);
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    double* jacobian = work.of(b);
    const double* state = state_columns(b, work.count > 0);
    fill_columns(b, columns, jacobian, outputs.force ? force.data() + b * kBins : nullptr);
    add_products(jacobian, work.width, jacobian, work.width, true, own.data(), work.width);
    if (work.count > 0) {
      add_products(jacobian, work.width, state, state_width_, false, mixed.data(), state_width_);
    }
    if (!outputs.residuals) continue;
    const double* residual = jacobian + work.count * kColumnLength;
    for_rows(b, record_.bins,
             [&](std::size_t row, std::size_t at) { (*outputs.residuals)[row] = residual[at]; });
  }
  const Eigen::MatrixXd products = symmetric(own, work.count + 1);
  LikelihoodPoint point{.cost = products(n, n), .slope = products.col(n).head(n)};
  force.resize(std::min(force.size(), record_.bins));
  if (outputs.force) *outputs.force = std::move(force);
  give(outputs);
  if (n == 0) return point;
  const Eigen::MatrixXd cross =
      mixed.topLeftCorner(n, static_cast<Eigen::Index>(end_state_.size()));
  const Eigen::MatrixXd fit = end_state_.fit(cross.transpose());
  point.information = products.topLeftCorner(n, n) - cross * fit;
  if (keep) project_columns(work, fit, outputs, point);
  return point;
}

void LikelihoodEvaluation::project_columns(Columns& work, const Eigen::MatrixXd& fit,
                                           const LikelihoodOutputs& outputs,
                                           LikelihoodPoint& point) {
  const auto width = static_cast<Eigen::Index>(work.width);
  RowMatrix factors = RowMatrix::Zero(fit.rows(), width);
  factors.leftCols(fit.cols()) = fit;
  RowMatrix twice = RowMatrix::Zero(width, width);
  if (outputs.jacobian) outputs.jacobian->resize(static_cast<long>(2 * record_.bins), fit.cols());
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    double* jacobian = work.of(b);
    subtract_columns(state_columns(b, true), end_state_.size(), factors.data(), work.width,
                     jacobian);
    for (std::size_t i = 0; outputs.jacobian && i < work.count; ++i) {
      for_rows(b, record_.bins, [&](std::size_t row, std::size_t at) {
        (*outputs.jacobian)(static_cast<long>(row), static_cast<long>(i)) =
            jacobian[i * kColumnLength + at];
      });
    }
    if (!outputs.twice_weighted) continue;
    scale_columns(record_.root_weight.data() + b * kBins, work.width, jacobian);
    add_products(jacobian, work.width, jacobian, work.width, true, twice.data(), work.width);
  }
  if (outputs.twice_weighted) point.twice_weighted = symmetric(twice, work.count);
}

// What the passes leave in the blocks.
void LikelihoodEvaluation::give(const LikelihoodOutputs& outputs) const {
  if (outputs.amplitudes) {
    outputs.amplitudes->assign(end_state_.amplitudes().begin(), end_state_.amplitudes().end());
  }
  if (!outputs.gain) return;
  outputs.gain->resize(record_.bins);
  for (std::size_t k = 0; k < record_.bins; ++k) {
    (*outputs.gain)[k] = 1.0 / blocks_[k / kBins].norm[k % kBins];
  }
}

}  // namespace modcal
