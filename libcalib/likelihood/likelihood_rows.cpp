// Some rows of the information: the columns of some unknowns, and their products with what every
// other column is made of.
#include <algorithm>
#include <cassert>

#include "libcalib/likelihood/likelihood_work.hpp"
#include "libcalib/likelihood/tuning.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

static_assert(kMostRows <= kSharedColumns && kMostRows <= kDecayColumns);

// What add_mode_slopes() sums of one block and column.
std::size_t sums_of(std::size_t modes) { return modes * kSlopeSums * kSumLanes; }

// Places of the unknowns in `selected`, or none.
std::vector<std::optional<std::size_t>> places_in(std::span<const std::size_t> selected,
                                                  std::size_t count) {
  std::vector<std::optional<std::size_t>> places(count);
  for (std::size_t i = 0; i < selected.size(); ++i) places[selected[i]] = i;
  return places;
}

// The unknowns wanted, then the sensors' own: no mode tells their products.
std::vector<std::size_t> with_sensors(const LikelihoodColumns& columns,
                                      std::span<const std::size_t> wanted) {
  std::vector<std::size_t> selected(wanted.begin(), wanted.end());
  for (const auto& sensor : columns.sensors) {
    if (sensor && std::find(wanted.begin(), wanted.end(), *sensor) == wanted.end()) {
      selected.push_back(*sensor);
    }
  }
  return selected;
}

LikelihoodColumns select(const LikelihoodColumns& columns, std::span<const std::size_t> selected) {
  const auto places = places_in(selected, columns.count);
  const auto moved = [&](const std::optional<std::size_t>& column) {
    return column ? places[*column] : std::nullopt;
  };
  LikelihoodColumns some{.count = selected.size(), .contact = moved(columns.contact)};
  std::transform(columns.sensors.begin(), columns.sensors.end(), some.sensors.begin(), moved);
  for (std::size_t n = 0; n + 1 < columns.share_begin.size(); ++n) {
    some.share_begin.push_back(some.shares.size());
    for (std::size_t i = columns.share_begin[n]; i < columns.share_begin[n + 1]; ++i) {
      ColumnShare share = columns.shares[i];
      if (!places[share.column]) continue;
      share.column = *places[share.column];
      some.shares.push_back(share);
    }
  }
  some.share_begin.push_back(some.shares.size());
  return some;
}

void add(const AlignedVector& from, AlignedVector& to) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += from[i];
}

}  // namespace

bool LikelihoodEvaluation::may_give_rows(const LikelihoodColumns& columns,
                                         std::span<const std::size_t> wanted) {
  return !wanted.empty() && columns.knots == 0 && with_sensors(columns, wanted).size() <= kMostRows;
}

// Row i: products of every column with column i of `work`, projected; sensors' are left 0.
Eigen::MatrixXd LikelihoodEvaluation::project_rows(Columns& work, const Eigen::MatrixXd& fit,
                                                   std::size_t count,
                                                   const LikelihoodColumns& columns) {
  RowMatrix factors = RowMatrix::Zero(fit.rows(), static_cast<Index>(work.width));
  factors.leftCols(fit.cols()) = fit;
  struct Part {
    AlignedVector sums, state;
  };
  const std::size_t size = sums_of(modes_.size());
  std::vector<Part> parts(chunks());
  for (Part& part : parts) part.sums.resize(count * size);
  for_blocks([&](std::size_t chunk, std::size_t b) {
    project_block(b, fit, factors, work.shared(), work.of(0, b), parts[chunk].state);
    for (std::size_t i = 0; i < count; ++i) {
      add_mode_slopes(*record_, b, splits_.of(b), blocks_[b], end_state_.decays() > 0,
                      work.of(chunk, b) + i * kColumnLength, parts[chunk].sums.data() + i * size);
    }
  });
  for (std::size_t c = 1; c < parts.size(); ++c) add(parts[c].sums, parts[0].sums);
  Eigen::MatrixXd rows(static_cast<Index>(count), static_cast<Index>(columns.count));
  for (std::size_t i = 0; i < count; ++i) {
    rows.row(static_cast<Index>(i)) = mode_products(parts[0].sums.data() + i * size, columns);
  }
  return rows;
}

LikelihoodPoint LikelihoodEvaluation::rows(const LikelihoodColumns& columns,
                                           std::span<const std::size_t> wanted) {
  assert(may_give_rows(columns, wanted));
  const std::vector<std::size_t> selected = with_sensors(columns, wanted);
  const LikelihoodColumns some = select(columns, selected);
  Columns work(some, some.count, blocks_.size(), true, arrays_.columns);
  std::vector<AlignedVector> sums(chunks(), AlignedVector(sums_of(modes_.size())));
  const Products sum = multiply_columns(some, work, [&](std::size_t chunk, std::size_t b) {
    add_mode_slopes(*record_, b, splits_.of(b), blocks_[b], end_state_.decays() > 0, residual_of(b),
                    sums[chunk].data());
  });
  for (std::size_t c = 1; c < sums.size(); ++c) add(sums[c], sums[0]);
  const auto n = static_cast<Index>(some.count);
  const Eigen::MatrixXd products = symmetric(sum.own, some.count + 1);
  const Eigen::MatrixXd cross = cross_products(work, sum);
  const Eigen::MatrixXd fit = end_state_.fit(cross);
  const Eigen::MatrixXd own = products.topLeftCorner(n, n) - cross.transpose() * fit;
  LikelihoodPoint point{.cost = products(n, n),
                        .slope = mode_products(sums[0].data(), columns),
                        .information = project_rows(work, fit, wanted.size(), columns)};
  const auto places = places_in(selected, columns.count);
  for (const auto& sensor : columns.sensors) {
    if (!sensor) continue;
    const auto column = static_cast<Index>(*sensor), place = static_cast<Index>(*places[*sensor]);
    point.slope[column] = products(n, place);
    point.information.col(column) = own.col(place).head(point.information.rows());
  }
  add_end_state(columns, point);
  return point;
}

}  // namespace modcal
