#include "libinverse/structure/column_span.hpp"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <utility>

#include "libinverse/structure/tuning.hpp"
#include "libsim/base/kernels/column_products.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

constexpr auto kBlock = static_cast<Index>(kColumnLength);

Index padded_count(Index columns) {
  return static_cast<Index>(tiled(static_cast<std::size_t>(columns)));
}

std::size_t block_size(Index columns) {
  return static_cast<std::size_t>(padded_count(columns)) * kColumnLength;
}

// Calls visit(first row, rows) for every block.
template <typename Visit>
void for_each_block(Index rows, Visit visit) {
  for (Index first = 0; first < rows; first += kBlock) visit(first, std::min(kBlock, rows - first));
}

// Zeros stand behind the last row and the last column.
void pack_block(const Eigen::MatrixXd& columns, Index first, Index rows, double* to) {
  for (Index j = 0; j < columns.cols(); ++j, to += kBlock) {
    std::copy_n(columns.data() + j * columns.rows() + first, rows, to);
    std::fill(to + rows, to + kBlock, 0.0);
  }
}

Eigen::MatrixXd inverse_of_upper(const Eigen::MatrixXd& upper) {
  return upper.triangularView<Eigen::Upper>().solve(
      Eigen::MatrixXd::Identity(upper.rows(), upper.cols()));
}

}  // namespace

Eigen::MatrixXd square_of(const Eigen::MatrixXd& columns) {
  const Index width = padded_count(columns.cols());
  // By rows; what is not on the diagonal or below is made of what is.
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(width, width);
  AlignedVector block(block_size(columns.cols()), 0.0);
  const auto count = static_cast<std::size_t>(width);
  for_each_block(columns.rows(), [&](Index first, Index rows) {
    pack_block(columns, first, rows, block.data());
    add_products(block.data(), count, block.data(), count, true, sums.data(), count);
  });
  return sums.topLeftCorner(columns.cols(), columns.cols()).selfadjointView<Eigen::Upper>();
}

ColumnSpan::ColumnSpan(const Eigen::MatrixXd& columns) {
  const Index count = columns.cols();
  pack(columns);
  const Eigen::LLT<Eigen::MatrixXd> found(square_of(columns));
  const Eigen::MatrixXd lower = found.matrixL();
  const bool is_told =
      found.info() == Eigen::Success &&
      (lower.diagonal().array() > kOwnOfColumn * lower.rowwise().norm().array()).all();
  if (is_told) {
    orthogonal_ = root_ = inverse_of_upper(lower.transpose());
    return;
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> solver(columns);
  pack(solver.householderQ() * Eigen::MatrixXd::Identity(columns.rows(), count));
  orthogonal_ = Eigen::MatrixXd::Identity(count, count);
  root_ = inverse_of_upper(solver.matrixQR().topRows(count));
}

void ColumnSpan::pack(const Eigen::MatrixXd& columns) {
  rows_ = columns.rows();
  const std::size_t size = block_size(columns.cols());
  packed_.assign(size * static_cast<std::size_t>((rows_ + kBlock - 1) / kBlock), 0.0);
  double* to = packed_.data();
  for_each_block(rows_, [&](Index first, Index rows) {
    pack_block(columns, first, rows, std::exchange(to, to + size));
  });
}

ColumnSpan::Rows ColumnSpan::products(const Eigen::MatrixXd& others) const {
  const std::size_t own = packed_.size() / static_cast<std::size_t>((rows_ + kBlock - 1) / kBlock);
  const auto count = static_cast<Index>(own / kColumnLength), width = padded_count(others.cols());
  Rows sums = Rows::Zero(count, width);
  AlignedVector block(block_size(others.cols()), 0.0);
  const double* from = packed_.data();
  for_each_block(rows_, [&](Index first, Index rows) {
    pack_block(others, first, rows, block.data());
    add_products(std::exchange(from, from + own), static_cast<std::size_t>(count), block.data(),
                 static_cast<std::size_t>(width), false, sums.data(),
                 static_cast<std::size_t>(width));
  });
  return sums.topLeftCorner(root_.cols(), others.cols());
}

void ColumnSpan::subtract(const Rows& factors, Eigen::MatrixXd& others) const {
  const std::size_t own = block_size(root_.cols());
  const Index width = padded_count(others.cols());
  Rows by = Rows::Zero(factors.rows(), width);
  by.leftCols(factors.cols()) = factors;
  AlignedVector block(block_size(others.cols()), 0.0);
  const double* from = packed_.data();
  for_each_block(rows_, [&](Index first, Index rows) {
    pack_block(others, first, rows, block.data());
    subtract_columns(std::exchange(from, from + own), static_cast<std::size_t>(by.rows()),
                     by.data(), static_cast<std::size_t>(width), block.data());
    for (Index j = 0; j < others.cols(); ++j) {
      std::copy_n(block.data() + j * kBlock, rows, others.data() + j * others.rows() + first);
    }
  });
}

void ColumnSpan::take_from(Eigen::MatrixXd& columns) const {
  const Eigen::MatrixXd along = orthogonal_.transpose() * products(columns);
  subtract(orthogonal_ * along, columns);
}

Eigen::VectorXd ColumnSpan::take_from(Eigen::VectorXd& y) const {
  Eigen::MatrixXd column = y;
  Eigen::VectorXd taken = Eigen::VectorXd::Zero(root_.cols());
  // Of what is by far larger than what is left the first round leaves its rounding.
  for (int round = 0; round < 2; ++round) {
    const Eigen::VectorXd along = orthogonal_.transpose() * products(column);
    subtract(orthogonal_ * along, column);
    taken += root_ * along;
  }
  y = column;
  return taken;
}

Eigen::MatrixXd ColumnSpan::basis() const {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(rows_, root_.cols());
  subtract(-orthogonal_, result);
  return result;
}

}  // namespace modcal
