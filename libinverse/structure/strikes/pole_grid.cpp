// The pairs of poles that a search may add next.
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "libinverse/structure/strikes/pole_search.hpp"
#include "libinverse/structure/tuning.hpp"
#include "libsim/base/task_loop.hpp"

namespace modcal {

using Index = Eigen::Index;

void PoleSearch::lay_grid() {
  // No resonance is narrower on the contour than 2σ.
  const ContourSpectra& spectra = strikes_.front().spectra;
  const double width = std::max(2.0 * spectra.grid.sigma, spectra.grid.spacing);
  const double low = spectra.s(0).imag(), high = spectra.s(spectra.count() - 1).imag();
  const auto count = static_cast<std::size_t>(std::max(1.0, std::ceil((high - low) / width)));
  for (std::size_t i = 0; i < count; ++i) {
    const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    for (const double zeta : {0.002, 0.006, 0.02})
      grid_.push_back({low + share * (high - low), zeta});
  }
  // Of as many strikes as the memory is to hold: all show the same modes.
  const double numbers = 2.0 * static_cast<double>(grid_.size() * sensors());
  for (const Strike& strike : strikes_) {
    const Index rows = strike.first + strike.rows();
    if (grid_rows_ == 0 || static_cast<double>(rows) * numbers < grid_numbers_) grid_rows_ = rows;
  }
  for (std::size_t k = 0; k < sensors(); ++k) {
    grid_columns_.emplace_back(grid_rows_, 2 * std::ssize(grid_));
    kept_.emplace_back(grid_.size());
  }
  for_each_task(grid_.size(), [&](std::size_t i) {
    const Columns columns = columns_of(grid_[i]);
    for (std::size_t k = 0; k < sensors(); ++k) {
      for (const bool turned : {false, true}) {
        const Index at = 2 * static_cast<Index>(i) + (turned ? 1 : 0);
        grid_columns_[k].col(at) = weighted(k, columns, turned).head(grid_rows_);
        grid_columns_[k].col(at).normalize();
      }
      const auto own = grid_columns_[k].middleCols(2 * static_cast<Index>(i), 2);
      kept_[k][i] = own.transpose() * own;
    }
  });
}

// What the columns of a pair of poles on the grid keep beside those of `fit`, and what they find in
// its residual. columns: of it in all strikes; empty: they stand in the grid.
PoleSearch::Promise PoleSearch::exact(std::size_t k, std::size_t i, const Columns& columns,
                                      const SensorFit& fit) const {
  Eigen::MatrixXd own(rows_, 2);
  if (columns.empty()) {
    own = grid_columns_[k].middleCols(2 * static_cast<Index>(i), 2);
  } else {
    own << weighted(k, columns, false), weighted(k, columns, true);
    own.colwise().normalize();
  }
  const Eigen::MatrixXd mixed = fit.columns.transpose() * own;
  return {.kept = own.transpose() * own - mixed.transpose() * fit.gram.solve(mixed),
          .score = own.transpose() * fit.residual};
}

// The pair added last takes its share of what the columns of the grid keep beside the others, which
// have moved little since.
void PoleSearch::take_last(const std::vector<SensorFit>& fits) {
  for_each_task(sensors(), [&](std::size_t k) {
    const auto columns = fits[k].columns.topRows(grid_rows_);
    const Index last = columns.cols() - kStatics - 2;
    // The first time all that there is: the static terms.
    const Eigen::MatrixXd own = last < 0 ? Eigen::MatrixXd(static_[k].topRows(columns.rows()))
                                         : Eigen::MatrixXd(columns.middleCols(last, 2));
    Eigen::MatrixXd others(columns.rows(), std::max<Index>(0, last));
    if (last >= 0) {
      others.resize(columns.rows(), last + kStatics);
      others << columns.leftCols(last), columns.rightCols(kStatics);
    }
    Eigen::MatrixXd basis = own;
    if (others.cols() > 0) basis -= others * others.householderQr().solve(own);
    basis = basis.householderQr().householderQ() *
            Eigen::MatrixXd::Identity(basis.rows(), basis.cols());
    const Eigen::MatrixXd taken = basis.transpose() * grid_columns_[k];
    for (std::size_t i = 0; i < grid_.size(); ++i) {
      const auto pair = taken.middleCols(2 * static_cast<Index>(i), 2);
      kept_[k][i] -= pair.transpose() * pair;
    }
  });
}

ModalPole PoleSearch::best_addition(const std::vector<ModalPole>& poles) {
  if (grid_.empty()) lay_grid();
  const std::vector<SensorFit> fits = at(poles);
  take_last(fits);
  std::vector<Eigen::VectorXd> scores(sensors());
  for_each_task(sensors(), [&](std::size_t k) {
    scores[k] = grid_columns_[k].transpose() * fits[k].residual.head(grid_rows_);
  });
  const auto gain = [](Promise of) {
    of.kept.diagonal().array() += 1e-9;
    return of.score.dot(of.kept.ldlt().solve(of.score));
  };
  // The exact gain costs as many products as there are columns: of those alone that promise most.
  // What the shares that were taken since have left inexact promises no more than there is.
  std::vector<double> promised(grid_.size(), 0.0), most;
  for (const SensorFit& fit : fits) most.push_back(fit.residual.head(grid_rows_).squaredNorm());
  for (std::size_t i = 0; i < grid_.size(); ++i) {
    for (std::size_t k = 0; k < sensors(); ++k) {
      const double own = gain({kept_[k][i], scores[k].segment(2 * static_cast<Index>(i), 2)});
      promised[i] += std::clamp(own, 0.0, most[k]);
    }
  }
  std::vector<std::size_t> order(grid_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto few = std::min<std::ptrdiff_t>(kExactGains, std::ssize(order));
  std::ranges::partial_sort(order, order.begin() + few, std::greater{},
                            [&](std::size_t i) { return promised[i]; });
  order.resize(static_cast<std::size_t>(few));
  std::vector<double> gains(order.size(), 0.0);
  for_each_task(order.size(), [&](std::size_t j) {
    const Columns columns = grid_rows_ < rows_ ? columns_of(grid_[order[j]]) : Columns();
    for (std::size_t k = 0; k < sensors(); ++k) {
      const Promise exactly = exact(k, order[j], columns, fits[k]);
      if (grid_rows_ == rows_) kept_[k][order[j]] = exactly.kept;
      gains[j] += gain(exactly);
    }
  });
  const auto best = std::ranges::max_element(gains) - gains.begin();
  return grid_[order[static_cast<std::size_t>(best)]];
}

}  // namespace modcal
