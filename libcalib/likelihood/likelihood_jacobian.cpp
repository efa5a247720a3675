// The Jacobian of one evaluation: its columns, their products, and what the end state takes of
// them.
#include <algorithm>
#include <cassert>

#include "libcalib/likelihood/column_products.hpp"
#include "libcalib/likelihood/far_products.hpp"
#include "libcalib/likelihood/likelihood_evaluation.hpp"
#include "libcalib/likelihood/likelihood_work.hpp"

namespace modcal {
namespace {

constexpr std::size_t kBins = LikelihoodBlock::kBins;

using Index = Eigen::Index;

// Calls give(row, real or imaginary part's place in the block's column) for the bins of a block.
template <typename Give>
void for_rows(std::size_t b, std::size_t bins, Give give) {
  const std::size_t count = std::min(kBins, bins - b * kBins);
  for (std::size_t k = 0; k < count; ++k) {
    give(2 * (b * kBins + k), k);
    give(2 * (b * kBins + k) + 1, kBins + k);
  }
}

}  // namespace

void LikelihoodEvaluation::fill_columns(std::size_t b, const LikelihoodColumns& columns,
                                        double* jacobian) {
  std::fill_n(jacobian, tiled(columns.count + 1) * kColumnLength, 0.0);
  SensorPlaces sensors{};
  for (std::size_t i = 0; i < Sensor::kCount; ++i) {
    if (columns.sensors[i]) sensors[i] = jacobian + *columns.sensors[i] * kColumnLength;
  }
  finish(b, sensors);
  std::copy_n(residual_of(b), kColumnLength, jacobian + columns.count * kColumnLength);
  if (columns.shares.empty() && !columns.contact) return;
  ColumnTask task = column_task(columns);
  task.jacobian = jacobian;
  if (columns.count <= kSharedColumns) {
    fill_shared_columns(*record_, b, splits_.of(b), blocks_[b], task);
  } else {
    fill_mode_columns(*record_, b, modes_, blocks_[b], task);
  }
}

// Columns of the end state, of one block: decays of the modes in a list, plain transients.
std::size_t LikelihoodEvaluation::fill_state(std::size_t b, std::span<const std::size_t> list,
                                             AlignedVector& state) {
  const std::size_t decays = end_state_.decays() > 0 ? 2 * list.size() : 0;
  const std::size_t room = tiled(decays + plain_.size()) * kColumnLength;
  if (state.size() < room) state.resize(room);
  if (decays > 0) fill_decay_columns(*record_, b, modes_, list, blocks_[b], state.data());
  std::copy_n(plain_of(b), plain_.size() * kColumnLength,
              state.begin() + static_cast<long>(decays * kColumnLength));
  return decays;
}

// With the columns of the end state, which are rows here: those of near modes and plain transients
// in the bins, those of far modes at the nodes.
void LikelihoodEvaluation::add_state_products(std::size_t b, const LikelihoodColumns& columns,
                                              double* jacobian, Products& sums) {
  const ModeSplit split = splits_.of(b);
  const bool nodes = end_state_.decays() > 0 && split.has_far() && columns.count <= kFarColumns;
  std::vector<std::size_t> near;
  for (std::size_t p = 0; nodes && p < 2; ++p) {
    const auto list = split.decaying(split.near[p]);
    near.insert(near.end(), list.begin(), list.end());
  }
  const std::span<const std::size_t> list = nodes ? near : decaying_;
  const std::size_t decays = fill_state(b, list, sums.state);
  const std::size_t rows = decays + plain_.size();
  const std::size_t stride = product_stride(columns.count);
  RowMatrix found = RowMatrix::Zero(static_cast<Index>(tiled(rows)), static_cast<Index>(stride));
  add_products(sums.state.data(), tiled(rows), jacobian, tiled(columns.count), false, found.data(),
               stride);
  for (std::size_t i = 0; i < rows; ++i) {
    const std::size_t row =
        i < decays ? 2 * list[i / 2] + i % 2 : 2 * end_state_.decays() + i - decays;
    for (std::size_t j = 0; j < columns.count; ++j) {
      sums.mixed[row * stride + j] += found(static_cast<Index>(i), static_cast<Index>(j));
    }
  }
  if (!nodes) return;
  ColumnTask task = column_task(columns);
  task.jacobian = jacobian;
  add_far_products(*record_, b, split, blocks_[b], task, sums.mixed.data());
}

// With the columns of the end state.
void LikelihoodEvaluation::add_cross_products(std::size_t b, const LikelihoodColumns& columns,
                                              const Columns& work, double* jacobian,
                                              Products& sums) {
  if (!work.shared()) {
    add_state_products(b, columns, jacobian, sums);
    return;
  }
  if (end_state_.decays() > 0) {
    add_decay_products(*record_, b, splits_.of(b), blocks_[b], jacobian, work.count,
                       sums.decays.data());
  }
  add_products(jacobian, work.width, plain_of(b), plain_width_, false, sums.plain.data(),
               plain_width_);
}

Eigen::MatrixXd LikelihoodEvaluation::cross_products(const Columns& work,
                                                     const Products& sums) const {
  const auto n = static_cast<Index>(work.count);
  const auto size = static_cast<Index>(end_state_.size());
  const auto plain = static_cast<Index>(plain_.size());
  if (!work.shared()) {
    const auto stride = static_cast<Index>(product_stride(work.count));
    return Eigen::Map<const RowMatrix>(sums.mixed.data(), size, stride).leftCols(n);
  }
  RowMatrix cross(size, n);
  if (end_state_.decays() > 0) {
    collect_decay_products(sums.decays.data(), end_state_.decays(), work.count, cross.data());
  }
  cross.bottomRows(plain) = sums.plain.topLeftCorner(n, plain).transpose();
  return cross;
}

// Forms the columns of every block, adds up their products, and calls also(chunk, block).
LikelihoodEvaluation::Products LikelihoodEvaluation::multiply_columns(
    const LikelihoodColumns& columns, Columns& work,
    const std::function<void(std::size_t, std::size_t)>& also) {
  prepare_sensor(columns);
  const auto width = static_cast<Index>(work.width);
  std::vector<Products> parts(chunks());
  for (Products& part : parts) {
    part.own = RowMatrix::Zero(width, width);
    if (work.shared()) {
      part.decays.resize(end_state_.decays() * 2 * work.count * kSumLanes);
      part.plain = RowMatrix::Zero(width, static_cast<Index>(plain_width_));
    } else {
      part.mixed.resize(end_state_.size() * product_stride(work.count));
    }
  }
  for_blocks([&](std::size_t chunk, std::size_t b) {
    double* jacobian = work.of(chunk, b);
    fill_columns(b, columns, jacobian);
    add_products(jacobian, work.width, jacobian, work.width, true, parts[chunk].own.data(),
                 work.width);
    if (work.count > 0) add_cross_products(b, columns, work, jacobian, parts[chunk]);
    also(chunk, b);
  });
  Products sum = std::move(parts[0]);
  for (std::size_t c = 1; c < parts.size(); ++c) {
    sum.own += parts[c].own;
    sum.plain += parts[c].plain;
    for (std::size_t i = 0; i < sum.mixed.size(); ++i) sum.mixed[i] += parts[c].mixed[i];
    for (std::size_t i = 0; i < sum.decays.size(); ++i) sum.decays[i] += parts[c].decays[i];
  }
  return sum;
}

LikelihoodPoint LikelihoodEvaluation::differentiate(const LikelihoodColumns& columns,
                                                    const LikelihoodOutputs& outputs) {
  assert(columns.count == 0 || columns.share_begin.size() == modes_.size() + 1);
  const bool keep = outputs.jacobian || outputs.twice_weighted;
  Columns work(columns.count, keep ? blocks_.size() : chunks(), keep, arrays_.columns);
  const auto n = static_cast<Index>(work.count);
  const Products sum = multiply_columns(columns, work, [](std::size_t, std::size_t) {});
  const Eigen::MatrixXd products = symmetric(sum.own, work.count + 1);
  LikelihoodPoint point{.cost = products(n, n), .slope = products.col(n).head(n)};
  give(outputs);
  if (n == 0) return point;
  const Eigen::MatrixXd cross = cross_products(work, sum);
  const Eigen::MatrixXd fit = end_state_.fit(cross);
  point.information = products.topLeftCorner(n, n) - cross.transpose() * fit;
  if (keep) project_columns(work, fit, outputs, point);
  return point;
}

void LikelihoodEvaluation::project_block(std::size_t b, const Eigen::MatrixXd& fit,
                                         const RowMatrix& factors, Columns& work,
                                         AlignedVector& state) {
  double* jacobian = work.of(0, b);
  if (!work.shared()) {
    fill_state(b, decaying_, state);
    subtract_columns(state.data(), end_state_.size(), factors.data(), work.width, jacobian);
    return;
  }
  const auto decays = static_cast<Index>(end_state_.decays());
  std::vector<Complex> amplitudes(end_state_.decays());
  for (Index i = 0; decays > 0 && i < fit.cols(); ++i) {
    for (Index m = 0; m < decays; ++m) {
      amplitudes[static_cast<std::size_t>(m)] = Complex(fit(2 * m, i), fit(2 * m + 1, i));
    }
    subtract_decays(*record_, b, splits_.of(b), amplitudes, blocks_[b],
                    jacobian + i * static_cast<Index>(kColumnLength));
  }
  subtract_columns(plain_of(b), plain_.size(),
                   factors.data() + 2 * end_state_.decays() * work.width, work.width, jacobian);
}

void LikelihoodEvaluation::project_columns(Columns& work, const Eigen::MatrixXd& fit,
                                           const LikelihoodOutputs& outputs,
                                           LikelihoodPoint& point) {
  const auto width = static_cast<Index>(work.width);
  RowMatrix factors = RowMatrix::Zero(fit.rows(), width);
  factors.leftCols(fit.cols()) = fit;
  if (outputs.jacobian) outputs.jacobian->resize(static_cast<long>(2 * record_->bins), fit.cols());
  struct Part {
    RowMatrix twice;
    AlignedVector state;
  };
  std::vector<Part> parts(chunks());
  for (Part& part : parts) part.twice = RowMatrix::Zero(width, width);
  for_blocks([&](std::size_t chunk, std::size_t b) {
    double* jacobian = work.of(chunk, b);
    project_block(b, fit, factors, work, parts[chunk].state);
    for (std::size_t i = 0; outputs.jacobian && i < work.count; ++i) {
      for_rows(b, record_->bins, [&](std::size_t row, std::size_t at) {
        (*outputs.jacobian)(static_cast<long>(row), static_cast<long>(i)) =
            jacobian[i * kColumnLength + at];
      });
    }
    if (!outputs.twice_weighted) return;
    scale_columns(record_->root_weight.data() + b * kBins, work.width, jacobian);
    add_products(jacobian, work.width, jacobian, work.width, true, parts[chunk].twice.data(),
                 work.width);
  });
  if (!outputs.twice_weighted) return;
  RowMatrix twice = parts[0].twice;
  for (std::size_t c = 1; c < parts.size(); ++c) twice += parts[c].twice;
  point.twice_weighted = symmetric(twice, work.count);
}

// What the passes leave in the blocks.
void LikelihoodEvaluation::give(const LikelihoodOutputs& outputs) {
  if (outputs.amplitudes) {
    outputs.amplitudes->assign(end_state_.amplitudes().begin(), end_state_.amplitudes().end());
  }
  if (outputs.residuals) {
    outputs.residuals->resize(2 * record_->bins);
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      for_rows(b, record_->bins, [&](std::size_t row, std::size_t at) {
        (*outputs.residuals)[row] = residual_of(b)[at];
      });
    }
  }
  const auto give_bins = [this](std::vector<Complex>* numbers,
                                LikelihoodBlock::Planar LikelihoodBlock::*member) {
    if (!numbers) return;
    numbers->resize(record_->bins);
    for (std::size_t k = 0; k < record_->bins; ++k) {
      const LikelihoodBlock::Planar& of_block = blocks_[k / kBins].*member;
      (*numbers)[k] = {of_block.re[k % kBins], of_block.im[k % kBins]};
    }
  };
  give_bins(outputs.force, &LikelihoodBlock::force);
  give_bins(outputs.left, &LikelihoodBlock::left);
  give_bins(outputs.right, &LikelihoodBlock::right);
  if (!outputs.gain) return;
  outputs.gain->resize(record_->bins);
  for (std::size_t k = 0; k < record_->bins; ++k) {
    (*outputs.gain)[k] = 1.0 / blocks_[k / kBins].norm[k % kBins];
  }
}

}  // namespace modcal
