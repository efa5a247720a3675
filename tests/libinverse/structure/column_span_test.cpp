// Tall columns and what is left without them, against dense algebra.
#include "libinverse/structure/column_span.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>

#include "libsim/base/random.hpp"

namespace modcal::column_span_test {
namespace {

Eigen::MatrixXd drawn(Eigen::Index rows, Eigen::Index columns, std::uint64_t seed) {
  Eigen::MatrixXd result(rows, columns);
  fill_standard_normal(StreamKey(seed), {result.data(), static_cast<std::size_t>(result.size())});
  return result;
}

// rows: none to two whole blocks of the kernel; alike: how much the last two columns differ.
struct Case {
  Eigen::Index rows, columns, others;
  double alike;
};

class ColumnSpanOf : public testing::TestWithParam<Case> {};

TEST_P(ColumnSpanOf, LeavesWhatLeastSquaresLeave) {
  const auto [rows, columns, others, alike] = GetParam();
  Eigen::MatrixXd a = drawn(rows, columns, 1);
  a.col(columns - 1) = a.col(columns - 2) + alike * a.col(columns - 1);
  a.colwise().normalize();
  EXPECT_LT((square_of(a) - a.transpose() * a).norm(), 1e-13 * static_cast<double>(columns));
  const ColumnSpan span(a);
  const Eigen::MatrixXd basis = span.basis();
  // ε over the square of what a column has of its own, 1e-4 and more, or by reflections.
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(columns, columns);
  EXPECT_LT((basis.transpose() * basis - one).norm(), 1e-7);

  Eigen::VectorXd y = 1e6 * a * drawn(columns, 1, 2) + drawn(rows, 1, 3);
  const Eigen::HouseholderQR<Eigen::MatrixXd> solver(a);
  const Eigen::VectorXd c = solver.solve(y), left = y - a * c;
  const Eigen::VectorXd found = span.take_from(y);
  // The data have 1e6 times what is left; c is told by alike of it.
  EXPECT_LT((y - left).norm(), 1e-8 * left.norm());
  EXPECT_LT((found - c).norm(), 1e-6 * c.norm());

  Eigen::MatrixXd b = drawn(rows, others, 4);
  const Eigen::MatrixXd exact = b - basis * (basis.transpose() * b);
  span.take_from(b);
  EXPECT_LT((b - exact).norm(), 1e-6 * exact.norm());
  const Eigen::MatrixXd spread = span.root() * span.root().transpose() * (a.transpose() * a);
  EXPECT_LT((spread - one).norm(), 1e-6 / alike);
}

INSTANTIATE_TEST_SUITE_P(Cases, ColumnSpanOf,
                         testing::Values(Case{1200, 9, 5, 1.0}, Case{1024, 8, 4, 1e-3},
                                         Case{300, 3, 1, 1e-6}));

}  // namespace
}  // namespace modcal::column_span_test
