#include "libsim/base/kernels/column_products.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>

#include "libsim/base/aligned_vector.hpp"
#include "libsim/base/random.hpp"

namespace modcal::column_products_test {
namespace {

using Index = Eigen::Index;
using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Sums of at most 512 products of numbers of order 1, in another order.
constexpr double kRounding = 1e-11;

AlignedVector drawn(std::size_t columns, std::uint64_t key) {
  AlignedVector draw(columns * kColumnLength);
  fill_standard_normal(StreamKey(key), draw);
  return draw;
}

Eigen::MatrixXd matrix_of(const AlignedVector& columns, std::size_t length) {
  return Eigen::Map<const Eigen::MatrixXd>(columns.data(), kColumnLength,
                                           static_cast<Index>(columns.size() / kColumnLength))
      .topRows(static_cast<Index>(length));
}

TEST(ColumnProducts, AddWhatTheNumbersAskedForMake) {
  const AlignedVector a = drawn(12, 1), b = drawn(8, 2);
  for (const std::size_t length : {kVectorPadding, 5 * kVectorPadding, kColumnLength}) {
    RowMatrix found = RowMatrix::Constant(12, 9, 3.0);
    add_products(a.data(), 12, b.data(), 8, false, found.data(), 9, length);
    RowMatrix expected = RowMatrix::Constant(12, 9, 3.0);
    expected.leftCols(8) += matrix_of(a, length).transpose() * matrix_of(b, length);
    EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), kRounding) << length;
  }
}

TEST(ColumnProducts, LeaveOutTilesAboveTheDiagonal) {
  const AlignedVector a = drawn(12, 1);
  RowMatrix found = RowMatrix::Zero(12, 12);
  add_products(a.data(), 12, a.data(), 12, true, found.data(), 12);
  const Eigen::MatrixXd all = matrix_of(a, kColumnLength);
  const RowMatrix expected = all.transpose() * all;
  for (Index i = 0; i < 12; ++i) {
    for (Index j = 0; j < 12; ++j) {
      EXPECT_NEAR(found(i, j), j / 4 <= i / 4 ? expected(i, j) : 0.0, kRounding) << i << ' ' << j;
    }
  }
}

TEST(ColumnProducts, SubtractCombinationsInTheNumbersAskedFor) {
  const AlignedVector from = drawn(5, 3), start = drawn(8, 4);
  const AlignedVector draw = drawn(1, 5);
  const Eigen::Map<const RowMatrix> factors(draw.data(), 5, 8);
  for (const std::size_t length : {2 * kVectorPadding, kColumnLength}) {
    AlignedVector to = start;
    subtract_columns(from.data(), 5, draw.data(), 8, to.data(), length);
    Eigen::MatrixXd expected = matrix_of(start, kColumnLength);
    expected.topRows(static_cast<Index>(length)) -= matrix_of(from, length) * factors;
    EXPECT_LT((matrix_of(to, kColumnLength) - expected).cwiseAbs().maxCoeff(), kRounding) << length;
  }
}

TEST(ColumnProducts, ScaleBothHalvesAlike) {
  const AlignedVector start = drawn(3, 6), by = drawn(1, 7);
  AlignedVector columns = start;
  scale_columns(by.data(), 2, columns.data());
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const double factor = i < 2 * kColumnLength ? by[i % (kColumnLength / 2)] : 1.0;
    EXPECT_EQ(columns[i], factor * start[i]) << i;
  }
}

}  // namespace
}  // namespace modcal::column_products_test
