#include "libinverse/modes/eigensystem_realization.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

std::vector<std::vector<double>> without_means(const DecayRecord& record) {
  std::vector<std::vector<double>> channels = record.channels;
  for (auto& channel : channels) {
    const double mean =
        std::accumulate(channel.begin(), channel.end(), 0.0) / static_cast<double>(channel.size());
    for (double& value : channel) value -= mean;
  }
  return channels;
}

Eigen::MatrixXd hankel(const std::vector<std::vector<double>>& channels, std::size_t block_rows,
                       std::size_t columns, std::size_t spread, std::size_t shift) {
  const std::size_t width = channels.size();
  Eigen::MatrixXd matrix(static_cast<Eigen::Index>(block_rows * width),
                         static_cast<Eigen::Index>(columns));
  for (std::size_t j = 0; j < columns; ++j) {
    for (std::size_t i = 0; i < block_rows; ++i) {
      for (std::size_t c = 0; c < width; ++c) {
        matrix(static_cast<Eigen::Index>(i * width + c), static_cast<Eigen::Index>(j)) =
            channels[c][i + spread * j + shift];
      }
    }
  }
  return matrix;
}

}  // namespace

EigensystemRealization::EigensystemRealization(const DecayRecord& record, std::size_t block_rows,
                                               std::size_t columns)
    : sample_rate_(record.sample_rate) {
  record.require_valid();
  MODCAL_REQUIRE(block_rows >= 1 && columns >= 1, "{} block rows and {} columns: take at least one",
                 block_rows, columns);
  MODCAL_REQUIRE(record.samples() >= 2 * block_rows + 1,
                 "a decay of {} samples is too short for {} block rows: take fewer or a longer "
                 "record",
                 record.samples(), block_rows);
  const std::size_t places = record.samples() - block_rows;  // of a column's first sample
  const std::size_t used = std::min(columns, places);
  const std::size_t spread = std::max<std::size_t>(1, (places - 1) / used);
  const auto channels = without_means(record);
  const Eigen::MatrixXd base = hankel(channels, block_rows, used, spread, 0);
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(base, Eigen::ComputeThinU | Eigen::ComputeThinV);
  sigma_ = svd.singularValues();
  shifted_ =
      svd.matrixU().transpose() * hankel(channels, block_rows, used, spread, 1) * svd.matrixV();
}

std::vector<DecayPole> EigensystemRealization::poles(std::size_t order) const {
  MODCAL_REQUIRE(order >= 1 && order <= highest_order(), "order {} must lie in 1 … {}", order,
                 highest_order());
  constexpr double kNothing = 1e-14;
  auto n = static_cast<Eigen::Index>(order);
  while (n > 0 && !(sigma_[n - 1] > kNothing * sigma_[0])) --n;
  std::vector<DecayPole> found;
  if (n == 0) return found;
  const Eigen::VectorXd root = sigma_.head(n).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd model =
      root.asDiagonal() * shifted_.topLeftCorner(n, n) * root.asDiagonal();
  const Eigen::EigenSolver<Eigen::MatrixXd> solver(model, false);
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::complex<double> z = solver.eigenvalues()[i];
    if (!(z.imag() > 0.0)) continue;
    found.push_back(DecayPole::of_exponent(std::log(z) * sample_rate_));
  }
  std::sort(found.begin(), found.end(),
            [](const DecayPole& a, const DecayPole& b) { return a.frequency < b.frequency; });
  return found;
}

}  // namespace modcal
