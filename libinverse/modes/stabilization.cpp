#include "libinverse/modes/stabilization.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "libinverse/modes/tuning.hpp"
#include "libsim/base/dense_solvers.hpp"
#include "libsim/base/error.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

std::vector<std::vector<double>> without_means(const DecayRecord& record) {
  std::vector<std::vector<double>> channels = record.channels;
  for (auto& channel : channels) remove_mean(channel);
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

using Points = std::vector<StabilizationPoint>;

/// The pole of an earlier order that this one continues; null where there is none.
const StabilizationPoint* predecessor(const Points& earlier, const DecayPole& pole,
                                      const StabilizationOptions& options) {
  const StabilizationPoint* nearest = nullptr;
  double distance = options.frequency_tolerance * pole.frequency;
  for (const StabilizationPoint& point : earlier) {
    const double apart = std::abs(point.pole.frequency - pole.frequency);
    if (apart > distance) continue;
    if (std::abs(point.pole.damping_ratio - pole.damping_ratio) > options.damping_tolerance) {
      continue;
    }
    distance = apart;
    nearest = &point;
  }
  return nearest;
}

Points of_order(const Points& diagram, std::size_t order) {
  Points row;
  std::copy_if(diagram.begin(), diagram.end(), std::back_inserter(row),
               [order](const StabilizationPoint& point) { return point.order == order; });
  return row;
}

double deviation_of(const std::vector<double>& values) {
  double mean = 0.0, sum = 0.0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  for (const double value : values) sum += (value - mean) * (value - mean);
  return std::sqrt(sum / static_cast<double>(values.size() - 1));
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
  const ThinSvd svd(base);
  sigma_ = svd.values;
  shifted_ = svd.left.transpose() * hankel(channels, block_rows, used, spread, 1) * svd.right;
}

std::vector<DecayPole> EigensystemRealization::poles(std::size_t order) const {
  MODCAL_REQUIRE(order >= 1 && order <= highest_order(), "order {} must lie in 1 … {}", order,
                 highest_order());
  auto n = static_cast<Eigen::Index>(order);
  while (n > 0 && !(sigma_[n - 1] > kNoSingularValue * sigma_[0])) --n;
  std::vector<DecayPole> found;
  if (n == 0) return found;
  const Eigen::VectorXd root = sigma_.head(n).cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd model =
      root.asDiagonal() * shifted_.topLeftCorner(n, n) * root.asDiagonal();
  for (const std::complex<double> z : eigenvalues(model)) {
    if (!(z.imag() > 0.0)) continue;
    found.push_back(DecayPole::of_exponent(std::log(z) * sample_rate_));
  }
  std::sort(found.begin(), found.end(),
            [](const DecayPole& a, const DecayPole& b) { return a.frequency < b.frequency; });
  return found;
}

void StabilizationOptions::visit(OptionVisitor& visitor) {
  visitor("lowest_order", "first order of the realizations; two a mode",
          {.range = Range::closed(2, 1000)}, lowest_order);
  visitor("highest_order", "last order of the realizations", {.range = Range::closed(2, 1000)},
          highest_order);
  visitor("frequency_tolerance", "largest relative change of a stable frequency between orders",
          {.range = Range::positive()}, frequency_tolerance);
  visitor("damping_tolerance", "largest change of a stable damping ratio between orders",
          {.range = Range::positive()}, damping_tolerance);
  visitor("required", "orders in a row over which a mode must be stable",
          {.range = Range::closed(2, 500)}, required);
  visitor("highest_damping", "damping ratio above which a pole is taken for none",
          {.range = Range::open(0.0, 1.0)}, highest_damping);
}

std::vector<StabilizationPoint> stabilization_diagram(const EigensystemRealization& realization,
                                                      const StabilizationOptions& options) {
  const auto last = std::min<std::size_t>(static_cast<std::size_t>(options.highest_order),
                                          realization.highest_order());
  Points diagram, earlier;
  for (auto order = static_cast<std::size_t>(options.lowest_order); order <= last; order += 2) {
    Points row;
    for (const DecayPole& pole : realization.poles(order)) {
      if (!(pole.damping_ratio > 0.0 && pole.damping_ratio < options.highest_damping)) continue;
      const StabilizationPoint* before = predecessor(earlier, pole, options);
      row.push_back({order, pole, before ? before->stable_orders + 1 : 1});
    }
    diagram.insert(diagram.end(), row.begin(), row.end());
    earlier = std::move(row);
  }
  return diagram;
}

std::vector<StablePole> stable_poles(const std::vector<StabilizationPoint>& diagram,
                                     const StabilizationOptions& options) {
  MODCAL_REQUIRE(options.required >= 2, "{} orders in a row say nothing: take at least 2",
                 options.required);
  std::vector<StablePole> stable;
  if (diagram.empty()) return stable;
  const std::size_t last = diagram.back().order;
  for (const StabilizationPoint& point : of_order(diagram, last)) {
    if (point.stable_orders < options.required) continue;
    std::vector<double> frequencies = {point.pole.frequency};
    std::vector<double> ratios = {point.pole.damping_ratio};
    StabilizationPoint current = point;
    while (current.stable_orders > 1) {
      const Points earlier = of_order(diagram, current.order - 2);
      current = *predecessor(earlier, current.pole, options);
      frequencies.push_back(current.pole.frequency);
      ratios.push_back(current.pole.damping_ratio);
    }
    stable.push_back({point.pole, {deviation_of(frequencies), deviation_of(ratios)}});
  }
  return stable;
}

}  // namespace modcal
