#include "libinverse/joint/transient_fit.hpp"

#include <algorithm>
#include <cmath>

#include "libinverse/joint/tuning.hpp"
#include "libsim/base/dense_solvers.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

constexpr std::size_t kBlock = 256;  // bins gathered before one matrix product

// Equations of a bin: two complex ones with two reactions, one with one.
Index equations_of(const TransientFit::Setting& setting) {
  return setting.noise_variance[0] > 0.0 && setting.noise_variance[1] > 0.0 ? 4 : 2;
}

// Calls visit(begin, end) for every block of the bins from `first` on, below `last`.
template <typename Visit>
void for_blocks(std::size_t first, std::size_t last, std::size_t size, Visit visit) {
  for (std::size_t begin = first; begin < last; begin += size) {
    visit(begin, std::min(last, begin + size));
  }
}

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

}  // namespace

TransientFit::TransientFit(const ModalBasis& basis, double contact, const FrequencyGrid& grid,
                           double sample_rate, bool bending, const SensorPair& sensors)
    : grid_(grid),
      sample_rate_(sample_rate),
      sensors_(sensors),
      poles_(basis.size()),
      rates_(basis.size()),
      contact_(basis.shape_at(contact)) {
  const double law = bending ? inharmonicity_of(basis) : 0.0;
  for (std::size_t r = 0; r < 2; ++r) {
    gains_[r] = reaction_gains(basis, r == 0 ? End::kLeft : End::kRight);
  }
  for (std::size_t i = 0; i < basis.size(); ++i) {
    const double decay = basis.zeta[i] * basis.omega[i];
    const double damped = basis.omega[i] * std::sqrt(1.0 - basis.zeta[i] * basis.zeta[i]);
    rates_[i] = {-decay, damped};
    poles_[i] = std::polar(std::exp(-decay / sample_rate), damped / sample_rate);
    const double n_squared = static_cast<double>((i + 1) * (i + 1));
    // Columns of one length; the unknown's unit does not matter.
    const double scale = 1.0 / std::abs(gains_[0][i]);
    contact_[i] *= scale;
    for (auto& gains : gains_) gains[i] *= scale * (1.0 + law * n_squared);
  }
}

Complex TransientFit::reading(std::size_t side, std::size_t k) const {
  return std::polar(sensors_[side].gain, -grid_.omega(k) * sensors_[side].delay);
}

Complex TransientFit::shift_of(std::size_t k) const {
  return std::polar(1.0, -grid_.omega(k) / sample_rate_);
}

// Transforms of the real and imaginary part of the n-th decay at the bin of this shift.
std::array<Complex, 2> TransientFit::decay_of(std::size_t n, Complex shift) const {
  const Complex one = 1.0 / (1.0 - poles_[n] * shift);
  const Complex other = 1.0 / (1.0 - std::conj(poles_[n]) * shift);
  return {0.5 * (one + other), Complex{0.0, 0.5} * (one - other)};
}

// The same of what it does at the contact; its velocity is Re(λ_n c_n exp(λ_n t)).
std::array<Complex, 2> TransientFit::motion_of(bool velocity, std::size_t n, Complex shift) const {
  const auto [real, imaginary] = decay_of(n, shift);
  if (!velocity) return {contact_[n] * real, contact_[n] * imaginary};
  const Complex rate = contact_[n] * rates_[n];
  return {rate.real() * real + rate.imag() * imaginary,
          rate.real() * imaginary - rate.imag() * real};
}

// Complex equations of the bins: along the force's direction in the whitened pair (variance
// 1 + q P) and, of two reactions, across it (variance 1).
void TransientFit::fill_rows(const Setting& setting, std::size_t begin, std::size_t end,
                             const Spectra& spectra, Workspace& workspace) const {
  const Index equations = equations_of(setting);
  const auto rows = equations * static_cast<Index>(end - begin);
  workspace.rows.resize(rows, static_cast<Index>(2 * poles_.size()));
  workspace.data.resize(rows);
  std::array<double, 2> weight = {0.0, 0.0};
  for (std::size_t r = 0; r < 2; ++r) {
    if (setting.noise_variance[r] > 0.0) weight[r] = 1.0 / std::sqrt(setting.noise_variance[r]);
  }
  for (std::size_t k = begin; k < end; ++k) {
    const Index row = equations * static_cast<Index>(k - begin);
    std::array<Complex, 2> direction;
    double q = 0.0;
    for (std::size_t r = 0; r < 2; ++r) {
      direction[r] = weight[r] * setting.transfer[r][k];
      q += std::norm(direction[r]);
    }
    const double along_scale = 1.0 / std::sqrt(1.0 + q * setting.prior[k]);
    if (q > 0.0) {
      for (Complex& value : direction) value /= std::sqrt(q);
    } else {
      direction = {1.0, 0.0};
    }
    const auto put = [&](const std::array<Complex, 2>& pair, const auto& place) {
      const Complex x0 = weight[0] * pair[0], x1 = weight[1] * pair[1];
      const Complex along =
          along_scale * (std::conj(direction[0]) * x0 + std::conj(direction[1]) * x1);
      place(0, along.real());
      place(1, along.imag());
      if (equations == 2) return;
      const Complex across = direction[0] * x1 - direction[1] * x0;
      place(2, across.real());
      place(3, across.imag());
    };
    put({spectra[0].empty() ? Complex{} : spectra[0][k],
         spectra[1].empty() ? Complex{} : spectra[1][k]},
        [&](Index i, double value) { workspace.data[row + i] = value; });
    const Complex shift = shift_of(k);
    const std::array<Complex, 2> read = {reading(0, k), reading(1, k)};
    for (std::size_t n = 0; n < poles_.size(); ++n) {
      const std::array<Complex, 2> parts = decay_of(n, shift);
      for (std::size_t part = 0; part < 2; ++part) {
        const auto column = static_cast<Index>(2 * n + part);
        put({gains_[0][n] * read[0] * parts[part], gains_[1][n] * read[1] * parts[part]},
            [&](Index i, double value) { workspace.rows(row + i, column) = value; });
      }
    }
  }
}

void TransientFit::subtract(const Setting& setting, Spectra spectra, Workspace& workspace) const {
  const auto columns = static_cast<Index>(2 * poles_.size());
  workspace.normal = Eigen::MatrixXd::Zero(columns, columns);
  workspace.right = Eigen::VectorXd::Zero(columns);
  for_blocks(1, grid_.bins, kBlock, [&](std::size_t begin, std::size_t end) {
    fill_rows(setting, begin, end, spectra, workspace);
    workspace.normal.selfadjointView<Eigen::Lower>().rankUpdate(workspace.rows.transpose());
    workspace.right.noalias() += workspace.rows.transpose() * workspace.data;
  });
  // A mode that the record does not show keeps no decay.
  workspace.normal.diagonal().array() += 1e-13 * workspace.normal.diagonal().maxCoeff() + 1e-300;
  workspace.decays = SemidefiniteSolver(workspace.normal).solve(workspace.right);
  for (std::size_t k = setting.level_known ? 0 : 1; k < grid_.bins; ++k) {
    const Complex shift = shift_of(k);
    std::array<Complex, 2> sum;
    for (std::size_t n = 0; n < poles_.size(); ++n) {
      const std::array<Complex, 2> parts = decay_of(n, shift);
      const auto column = static_cast<Index>(2 * n);
      const Complex value =
          workspace.decays[column] * parts[0] + workspace.decays[column + 1] * parts[1];
      sum[0] += gains_[0][n] * value;
      sum[1] += gains_[1][n] * value;
    }
    for (std::size_t r = 0; r < 2; ++r) {
      if (!spectra[r].empty()) spectra[r][k] -= reading(r, k) * sum[r];
    }
  }
}

void TransientFit::add_motion(bool velocity, std::size_t first, std::span<Complex> spectrum,
                              const Workspace& workspace) const {
  for (std::size_t k = first; k < grid_.bins; ++k) {
    const Complex shift = shift_of(k);
    for (std::size_t n = 0; n < poles_.size(); ++n) {
      const std::array<Complex, 2> parts = motion_of(velocity, n, shift);
      const auto column = static_cast<Index>(2 * n);
      spectrum[k] += workspace.decays[column] * parts[0] + workspace.decays[column + 1] * parts[1];
    }
  }
}

// A row a cluster g: by how much the decays move where its equations a_g, with residuals e_g, are
// left out, (N − a_gᵀ a_g)⁻¹ a_gᵀ e_g; no more rows than unknowns.
Eigen::MatrixXd TransientFit::moves_without_clusters(const Setting& setting, const Spectra& spectra,
                                                     Workspace& workspace) const {
  const auto columns = static_cast<Index>(2 * poles_.size());
  const double width = std::round(kClusterWidth * rates_.front().imag() / grid_.spacing);
  const auto size = std::max<std::size_t>(1, static_cast<std::size_t>(width));
  const auto clusters = static_cast<Index>((grid_.bins + size - 2) / size);
  Eigen::MatrixXd moves(clusters, columns), rest;
  Eigen::VectorXd slope;
  Index cluster = 0;
  for_blocks(1, grid_.bins, size, [&](std::size_t first, std::size_t last) {
    // What only these equations tell has no residual to judge it by.
    rest = (1.0 + 1e-3) * workspace.normal;
    slope = Eigen::VectorXd::Zero(columns);
    for_blocks(first, last, kBlock, [&](std::size_t begin, std::size_t end) {
      fill_rows(setting, begin, end, spectra, workspace);
      workspace.data.noalias() -= workspace.rows * workspace.decays;
      rest.selfadjointView<Eigen::Lower>().rankUpdate(workspace.rows.transpose(), -1.0);
      slope.noalias() += workspace.rows.transpose() * workspace.data;
    });
    moves.row(cluster++) = SemidefiniteSolver(rest).solve(slope);
  });
  if (clusters <= columns) return moves;
  return ThinQr(moves).r();
}

// What the errors of the decays do to the motion: with the force's error, and by themselves.
void TransientFit::fill_motion(const Effect& effect, bool velocity, std::size_t k, Index row,
                               const Rows& force, Rows& rows) const {
  const Complex transfer = effect.motion[velocity ? 1 : 0][k], shift = shift_of(k);
  for (std::size_t n = 0; n < poles_.size(); ++n) {
    const std::array<Complex, 2> own = motion_of(velocity, n, shift);
    for (std::size_t part = 0; part < 2; ++part) {
      const auto column = static_cast<Index>(2 * n + part);
      const Complex moves = transfer * Complex{force(row, column), force(row + 1, column)} +
                            effect.motion_scale * own[part];
      rows(row, column) = moves.real();
      rows(row + 1, column) = moves.imag();
    }
  }
}

void TransientFit::error_variances(const Setting& setting, Spectra spectra, const Effect& effect,
                                   Workspace& workspace) const {
  const Eigen::MatrixXd moves = moves_without_clusters(setting, spectra, workspace);
  const Index equations = equations_of(setting);
  const std::vector<double> window = inner_window();
  const std::size_t order = window.size() - 1, lowest = setting.level_known ? 0 : 1;
  Rows force, motion, moved, windowed;
  for_blocks(1, grid_.bins, kBlock, [&](std::size_t begin, std::size_t end) {
    // With the bins beside the block, which the window mixes in.
    const std::size_t first = begin > order ? begin - order : lowest;
    const std::size_t last = std::min(grid_.bins, end + order);
    const auto row_of = [&](std::size_t k) { return 2 * static_cast<Index>(k - first); };
    const auto write = [&](const Rows& rows, std::span<double> variance) {
      moved.noalias() = rows * moves.transpose();
      for (std::size_t k = begin; k < end; ++k) {
        windowed = window.front() * moved.middleRows(row_of(k), 2);
        for (std::size_t m = 1; m < window.size(); ++m) {
          if (k >= first + m) windowed += window[m] * moved.middleRows(row_of(k - m), 2);
          if (m > k && m - k >= first && m - k < last) {
            // Bins below 0 are the conjugates of those above: a blow at t = 0 is in all of them.
            windowed.row(0) += window[m] * moved.row(row_of(m - k));
            windowed.row(1) -= window[m] * moved.row(row_of(m - k) + 1);
          }
          if (k + m < last) windowed += window[m] * moved.middleRows(row_of(k + m), 2);
        }
        variance[k] = windowed.squaredNorm();
      }
    };
    fill_rows(setting, first, last, {}, workspace);
    force.resize(row_of(last), workspace.rows.cols());
    motion.resize(force.rows(), force.cols());
    for (std::size_t k = first; k < last; ++k) {
      force.middleRows(row_of(k), 2) =
          -effect.force[k] * workspace.rows.middleRows(equations * (row_of(k) / 2), 2);
    }
    if (!effect.variance[0].empty()) write(force, effect.variance[0]);
    for (const bool velocity : {false, true}) {
      const std::span<double> variance = effect.variance[velocity ? 2 : 1];
      if (variance.empty()) continue;
      for (std::size_t k = first; k < last; ++k) {
        fill_motion(effect, velocity, k, row_of(k), force, motion);
      }
      write(motion, variance);
    }
  });
}

}  // namespace modcal
