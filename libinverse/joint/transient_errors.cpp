// How well the decays at the ends of a record are known, and what their errors do.
#include <algorithm>
#include <cmath>

#include "libinverse/joint/transient_fit.hpp"
#include "libinverse/joint/tuning.hpp"
#include "libsim/base/dense_solvers.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

// C(2p, p)/4ᵖ, the mean of cos^(2p).
double mean_of_cosine(int order) {
  double mean = 1.0;
  for (int j = 1; j <= order; ++j) mean *= 1.0 - 0.5 / j;
  return mean;
}

// Lines of the window w = 1 − cos^(2p)(πt/T), which leaves out a fifteenth of the record at either
// end, over √(mean of w²), the one at 0 first: C(2p, p + m)/4ᵖ of the cosine's.
std::vector<double> inner_window() {
  double line = mean_of_cosine(kEndsOrder);
  const double scale = 1.0 / std::sqrt(1.0 - 2.0 * line + mean_of_cosine(2 * kEndsOrder));
  std::vector<double> lines = {scale * (1.0 - line)};
  for (int m = 1; m <= kEndsOrder; ++m) {
    line *= static_cast<double>(kEndsOrder - m + 1) / (kEndsOrder + m);
    lines.push_back(-scale * line);
  }
  return lines;
}

// Moves of the decays, by which columns of theirs become columns of what moves, in tiles as the
// kernel takes them.
class Moves {
 public:
  explicit Moves(const Eigen::MatrixXd& moves)
      : unknowns_(static_cast<std::size_t>(moves.cols())),
        columns_(tiled(static_cast<std::size_t>(moves.rows())) * kColumnLength) {
    for (Index row = 0; row < moves.rows(); row += kColumnTile) {
      const Index rows = std::min<Index>(kColumnTile, moves.rows() - row);
      Tile& tile = tiles_.emplace_back();
      // Of a triangle what is not 0.
      while (tile.first < unknowns_ &&
             moves.middleRows(row, rows).col(static_cast<Index>(tile.first)).isZero(0.0)) {
        ++tile.first;
      }
      for (std::size_t j = tile.first; j < unknowns_; ++j) {
        for (Index i = 0; i < static_cast<Index>(kColumnTile); ++i) {
          tile.factors.push_back(i < rows ? moves(row + i, static_cast<Index>(j)) : 0.0);
        }
      }
    }
  }

  /// Squares of what the columns `from`, real and imaginary parts of `bins` bins, make of all
  /// moves.
  void add_powers(const double* from, std::size_t bins, std::span<double> powers) {
    std::fill(columns_.begin(), columns_.end(), 0.0);
    double* to = columns_.data();
    for (const Tile& tile : tiles_) {
      subtract_columns(from + tile.first * kColumnLength, unknowns_ - tile.first,
                       tile.factors.data(), kColumnTile, to, 2 * bins);
      for (std::size_t i = 0; i < kColumnTile; ++i, to += kColumnLength) {
        for (std::size_t k = 0; k < powers.size(); ++k) {
          powers[k] += to[k] * to[k] + to[bins + k] * to[bins + k];
        }
      }
    }
  }

 private:
  struct Tile {
    std::size_t first = 0;  ///< unknown
    std::vector<double> factors;
  };
  std::size_t unknowns_;
  std::vector<Tile> tiles_;
  AlignedVector columns_;
};

}  // namespace

// A row a cluster g: by how much the decays move where its equations a_g, with residuals e_g, are
// left out, (N − a_gᵀ a_g)⁻¹ a_gᵀ e_g; no more rows than unknowns.
Eigen::MatrixXd TransientFit::moves_without_clusters(const Setting& setting, const Spectra& spectra,
                                                     Workspace& workspace) const {
  const auto columns = static_cast<Index>(2 * modes_.size());
  const double width = std::round(kClusterWidth * rates_.front().imag() / grid_.spacing);
  const auto size = std::max<std::size_t>(1, static_cast<std::size_t>(width));
  const auto clusters = static_cast<Index>((grid_.bins + size - 2) / size);
  Eigen::MatrixXd moves(clusters, columns), own, rest;
  Eigen::VectorXd slope;
  Index cluster = 0;
  for (std::size_t first = 1; first < grid_.bins; first += size) {
    multiply_columns(setting, first, std::min(grid_.bins, first + size), spectra, workspace);
    own = workspace.products.topLeftCorner(columns, columns);
    slope = workspace.products.row(columns).head(columns);
    slope.noalias() -= own.selfadjointView<Eigen::Lower>() * workspace.decays;
    // What only these equations tell has no residual to judge it by.
    rest = (1.0 + 1e-3) * workspace.normal - own;
    moves.row(cluster++) = SemidefiniteSolver(rest).solve(slope);
  }
  if (clusters <= columns) return moves;
  return ThinQr(moves).r();
}

// Factors of what the errors of the decays do in bins from `first` on, some beside the record:
// those below 0 are the conjugates of those above, as a blow at t = 0 is in all of them.
void TransientFit::fill_effect(const Setting& setting, const Effect& effect, Signal signal,
                               std::ptrdiff_t first, Workspace& workspace) const {
  const std::size_t lowest = setting.level_known ? 0 : 1;
  RingingFactors& factors = workspace.factors[0];
  for (std::size_t i = 0; i < workspace.delay.size(); ++i) {
    const std::ptrdiff_t place = first + static_cast<std::ptrdiff_t>(i);
    const auto k = static_cast<std::size_t>(std::abs(place));
    workspace.delay.set(i, {});
    factors.set(i, {}, {}, 0.0);
    if (k < lowest || k >= grid_.bins) continue;
    const auto turned = [place](Complex z) { return place < 0 ? std::conj(z) : z; };
    Complex by = -effect.force[k];
    if (signal != kForce) by *= effect.motion[signal == kVelocity ? 1 : 0][k];
    const Equations at = equations_at(setting, k);
    workspace.delay.set(i, turned(delay_of(k)));
    factors.set(i, turned(by * at.along[0] * reading(0, k)),
                turned(by * at.along[1] * reading(1, k)),
                signal == kForce ? 0.0 : effect.motion_scale);
  }
}

void TransientFit::error_variances(const Setting& setting, Spectra spectra, const Effect& effect,
                                   Workspace& workspace) const {
  Moves moves(moves_without_clusters(setting, spectra, workspace));
  const std::vector<double> window = inner_window();
  const std::size_t beside = window.size() - 1, unknowns = 2 * modes_.size();
  const std::size_t most = kColumnLength / 2 - padded_size(2 * beside);
  AlignedVector windowed(unknowns * kColumnLength);
  for (const Signal signal : {kForce, kDisplacement, kVelocity}) {
    const std::span<double> variance = effect.variance[signal];
    if (variance.empty()) continue;
    const std::vector<RingingMode> modes = moving(signal == kVelocity);
    for (std::size_t begin = 1; begin < grid_.bins; begin += most) {
      const std::size_t count = std::min(most, grid_.bins - begin), bins = padded_size(count);
      // With the bins beside the block, which the window mixes in.
      const std::size_t all = bins + padded_size(2 * beside);
      workspace.delay = PlanarVector(all);
      workspace.factors[0] = RingingFactors(all);
      fill_effect(setting, effect, signal,
                  static_cast<std::ptrdiff_t>(begin) - static_cast<std::ptrdiff_t>(beside),
                  workspace);
      const double* columns = workspace.columns.data();
      fill_ringing_columns(modes, workspace.delay, workspace.factors[0], workspace.columns.data());
      for (std::size_t j = 0; j < unknowns; ++j) {
        for (std::size_t part = 0; part < 2; ++part) {
          smear(window, columns + j * kColumnLength + part * all, bins,
                windowed.data() + j * kColumnLength + part * bins);
        }
      }
      std::fill_n(variance.begin() + static_cast<std::ptrdiff_t>(begin), count, 0.0);
      moves.add_powers(windowed.data(), bins, variance.subspan(begin, count));
    }
  }
}

}  // namespace modcal
