// The Jacobian of one evaluation: its columns, their products, and what the end state takes of
// them.
#include <algorithm>
#include <cassert>

#include "libcalib/likelihood/kernels/far_products.hpp"
#include "libcalib/likelihood/likelihood_evaluation.hpp"
#include "libcalib/likelihood/likelihood_work.hpp"
#include "libsim/base/kernels/column_products.hpp"

namespace modcal {
namespace {

constexpr std::size_t kBins = LikelihoodBlock::kBins;

using Index = Eigen::Index;

}  // namespace

LikelihoodEvaluation::BlockColumns LikelihoodEvaluation::columns_of(
    std::size_t b, const LikelihoodColumns& columns) const {
  if (columns.knots == 0) return {.common = columns.common()};
  const std::size_t end = std::min((b + 1) * kBins, record_->bins);
  const std::size_t first = sensors_.smooth.place(record_->omega[b * kBins]).knot;
  const auto [last, next] = sensors_.smooth.place(record_->omega[end - 1]);
  return {columns.common(), first, last + (next > 0.0 ? 2 : 1) - first};
}

std::size_t LikelihoodEvaluation::most_columns(const LikelihoodColumns& columns) const {
  std::size_t most = columns.common();
  for (std::size_t b = 0; columns.knots > 0 && b < blocks_.size(); ++b) {
    most = std::max(most, columns_of(b, columns).count());
  }
  return most;
}

void LikelihoodEvaluation::fill_columns(std::size_t b, const LikelihoodColumns& columns,
                                        const BlockColumns& own, double* jacobian) {
  std::fill_n(jacobian, own.width() * kColumnLength, 0.0);
  SensorPlaces sensors{};
  for (std::size_t i = 0; i < Sensor::kCount; ++i) {
    if (columns.sensors[i]) sensors[i] = jacobian + *columns.sensors[i] * kColumnLength;
  }
  double*& by_gain = sensors[Sensor::kGain];
  if (own.knots > 0 && !by_gain) by_gain = jacobian + own.common * kColumnLength;
  finish(b, sensors);
  std::copy_n(residual_of(b), kColumnLength, jacobian + own.count() * kColumnLength);
  if (own.knots > 0) fill_response(b, own, by_gain, jacobian);
  const std::size_t first_signal = own.common - columns.signals.size();
  for (std::size_t i = 0; i < columns.signals.size(); ++i) {
    fill_signal_column(*record_, b, blocks_[b], columns.signals[i],
                       jacobian + (first_signal + i) * kColumnLength);
  }
  if (columns.shares.empty() && !columns.contact) return;
  ColumnTask task = column_task(columns);
  task.count = own.common;
  task.jacobian = jacobian;
  if (own.common <= kSharedColumns) {
    fill_shared_columns(*record_, b, splits_.of(b), blocks_[b], task);
  } else {
    fill_mode_columns(*record_, b, modes_, blocks_[b], task);
  }
}

// Shares of the column of ln gain, which may stand where the first of them goes.
void LikelihoodEvaluation::fill_response(std::size_t b, const BlockColumns& own,
                                         const double* by_gain, double* jacobian) const {
  for (std::size_t k = 0; k < kBins; ++k) {
    const double re = by_gain[k], im = by_gain[kBins + k];
    const auto [knot, next] = sensors_.smooth.place(record_->omega[b * kBins + k]);
    double* column = jacobian + own.common * kColumnLength + k;
    for (std::size_t i = 0; i < own.knots; ++i, column += 2 * kColumnLength) {
      const std::size_t at = own.first_knot + i;
      const double share = at == knot ? 1.0 - next : at == knot + 1 ? next : 0.0;
      column[0] = share * re, column[kBins] = share * im;
      column[kColumnLength] = -share * im, column[kColumnLength + kBins] = share * re;
    }
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
                                              const BlockColumns& own, double* jacobian,
                                              Products& sums) {
  const ModeSplit split = splits_.of(b);
  const std::size_t count = own.count();
  const bool nodes = end_state_.decays() > 0 && split.has_far() && count <= kFarColumns;
  std::vector<std::size_t> near;
  for (std::size_t p = 0; nodes && p < 2; ++p) {
    const auto list = split.decaying(split.near[p]);
    near.insert(near.end(), list.begin(), list.end());
  }
  const std::span<const std::size_t> list = nodes ? near : decaying_;
  const std::size_t decays = fill_state(b, list, sums.state);
  const std::size_t rows = decays + plain_.size();
  const std::size_t stride = product_stride(columns.count), own_stride = product_stride(count);
  RowMatrix found =
      RowMatrix::Zero(static_cast<Index>(tiled(rows)), static_cast<Index>(own_stride));
  add_products(sums.state.data(), tiled(rows), jacobian, tiled(count), false, found.data(),
               own_stride);
  const auto add_row = [&](const double* from, std::size_t row) {
    double* to = sums.mixed.data() + row * stride;
    for (std::size_t j = 0; j < count; ++j) to[own.place(j, columns.count)] += from[j];
  };
  for (std::size_t i = 0; i < rows; ++i) {
    add_row(found.row(static_cast<Index>(i)).data(),
            i < decays ? 2 * list[i / 2] + i % 2 : 2 * end_state_.decays() + i - decays);
  }
  if (!nodes) return;
  ColumnTask task = column_task(columns);
  task.count = count;
  task.jacobian = jacobian;
  if (own.knots == 0) {
    add_far_products(*record_, b, split, blocks_[b], task, sums.mixed.data());
    return;
  }
  const std::size_t far_rows = 2 * end_state_.decays();
  sums.block.assign(far_rows * own_stride, 0.0);
  add_far_products(*record_, b, split, blocks_[b], task, sums.block.data());
  for (std::size_t row = 0; row < far_rows; ++row) {
    add_row(sums.block.data() + row * own_stride, row);
  }
}

// The decays with the columns of the response, as many at a time as the kernel takes.
void LikelihoodEvaluation::add_decays_of_response(std::size_t b, const BlockColumns& own,
                                                  std::size_t all, const double* jacobian,
                                                  Products& sums) {
  const std::size_t stride = product_stride(all), rows = 2 * end_state_.decays();
  for (std::size_t begin = own.common; begin < own.count(); begin += kDecayColumns) {
    const std::size_t count = std::min(kDecayColumns, own.count() - begin);
    sums.block.assign(rows * count * kSumLanes, 0.0);
    add_decay_products(*record_, b, splits_.of(b), blocks_[b], jacobian + begin * kColumnLength,
                       count, sums.block.data());
    std::vector<double> found(rows * count);
    collect_decay_products(sums.block.data(), end_state_.decays(), count, found.data());
    for (std::size_t i = 0; i < found.size(); ++i) {
      sums.mixed[i / count * stride + own.place(begin + i % count, all)] += found[i];
    }
  }
}

// With the columns of the end state.
void LikelihoodEvaluation::add_cross_products(std::size_t b, const LikelihoodColumns& columns,
                                              const BlockColumns& own, double* jacobian,
                                              Products& sums) {
  if (own.common > kSharedColumns) {
    add_state_products(b, columns, own, jacobian, sums);
    return;
  }
  if (end_state_.decays() > 0) {
    add_decay_products(*record_, b, splits_.of(b), blocks_[b], jacobian, own.common,
                       sums.decays.data());
    add_decays_of_response(b, own, columns.count, jacobian, sums);
  }
  if (own.knots == 0) {
    add_products(jacobian, own.width(), plain_of(b), plain_width_, false, sums.plain.data(),
                 plain_width_);
    return;
  }
  sums.block.assign(own.width() * plain_width_, 0.0);
  add_products(jacobian, own.width(), plain_of(b), plain_width_, false, sums.block.data(),
               plain_width_);
  for (std::size_t i = 0; i < own.count(); ++i) {
    sums.plain.row(static_cast<Index>(own.place(i, columns.count))) +=
        Eigen::Map<const Eigen::RowVectorXd>(sums.block.data() + i * plain_width_,
                                             static_cast<Index>(plain_width_));
  }
}

Eigen::MatrixXd LikelihoodEvaluation::cross_products(const Columns& work,
                                                     const Products& sums) const {
  const auto n = static_cast<Index>(work.count), common = static_cast<Index>(work.common);
  const auto size = static_cast<Index>(end_state_.size());
  const auto plain = static_cast<Index>(plain_.size());
  RowMatrix cross = RowMatrix::Zero(size, n);
  if (!sums.mixed.empty()) {
    const auto stride = static_cast<Index>(product_stride(work.count));
    cross = Eigen::Map<const RowMatrix>(sums.mixed.data(), size, stride).leftCols(n);
  }
  if (!work.shared()) return cross;
  if (end_state_.decays() > 0) {
    RowMatrix decays(size - plain, common);
    collect_decay_products(sums.decays.data(), end_state_.decays(), work.common, decays.data());
    cross.topLeftCorner(size - plain, common) = decays;
  }
  cross.bottomRows(plain) = sums.plain.topLeftCorner(n, plain).transpose();
  return cross;
}

// Products of one block's columns with each other.
void LikelihoodEvaluation::add_own_products(const BlockColumns& own, std::size_t all,
                                            const double* jacobian, Products& sums) const {
  const std::size_t width = own.width(), stride = tiled(all + 1);
  if (own.knots == 0) {
    add_products(jacobian, width, jacobian, width, true, sums.own.data(), stride);
    return;
  }
  sums.block.assign(width * width, 0.0);
  add_products(jacobian, width, jacobian, width, true, sums.block.data(), width);
  for (std::size_t i = 0; i <= own.count(); ++i) {
    double* to = sums.own.data() + own.place(i, all) * stride;
    for (std::size_t j = 0; j <= i; ++j) to[own.place(j, all)] += sums.block[i * width + j];
  }
}

// Forms the columns of every block, adds up their products, and calls also(chunk, block).
LikelihoodEvaluation::Products LikelihoodEvaluation::multiply_columns(
    const LikelihoodColumns& columns, Columns& work,
    const std::function<void(std::size_t, std::size_t)>& also) {
  prepare_sensor(columns);
  const auto width = static_cast<Index>(tiled(work.count + 1));
  std::vector<Products> parts(chunks());
  for (Products& part : parts) {
    part.own = RowMatrix::Zero(width, width);
    if (!work.shared() || work.has_response()) {
      part.mixed.resize(end_state_.size() * product_stride(work.count));
    }
    if (!work.shared()) continue;
    part.decays.resize(end_state_.decays() * 2 * work.common * kSumLanes);
    part.plain = RowMatrix::Zero(width, static_cast<Index>(plain_width_));
  }
  for_blocks([&](std::size_t chunk, std::size_t b) {
    double* jacobian = work.of(chunk, b);
    const BlockColumns own = columns_of(b, columns);
    fill_columns(b, columns, own, jacobian);
    add_own_products(own, work.count, jacobian, parts[chunk]);
    if (work.count > 0) add_cross_products(b, columns, own, jacobian, parts[chunk]);
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
  Columns work(columns, most_columns(columns), keep ? blocks_.size() : chunks(), keep,
               arrays_.columns);
  const auto n = static_cast<Index>(work.count);
  const Products sum = multiply_columns(columns, work, [](std::size_t, std::size_t) {});
  const Eigen::MatrixXd products = symmetric(sum.own, work.count + 1);
  LikelihoodPoint point{.cost = products(n, n), .slope = products.col(n).head(n)};
  add_end_state(columns, point);
  give(outputs);
  if (n == 0) return point;
  const Eigen::MatrixXd cross = cross_products(work, sum);
  const Eigen::MatrixXd fit = end_state_.fit(cross);
  point.information = products.topLeftCorner(n, n) - cross.transpose() * fit;
  if (keep) project_columns(columns, work, fit, outputs, point);
  return point;
}

}  // namespace modcal
