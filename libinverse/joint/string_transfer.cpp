#include "libinverse/joint/string_transfer.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

namespace modcal {
namespace {

constexpr std::size_t kBlock = 256;  // bins gathered before one matrix product

void read_by_sensor(const FrequencyGrid& grid, const Sensor& sensor,
                    std::vector<Complex>& transfer) {
  if (sensor.gain == 1.0 && sensor.delay == 0.0) return;
  const double magnitude = sensor.gain * std::exp(-grid.sigma * sensor.delay);
  for (std::size_t k = 0; k < transfer.size(); ++k) {
    transfer[k] *= std::polar(1.0, -grid.omega(k) * sensor.delay) * magnitude;
  }
}

}  // namespace

StringTransfer string_transfer(const ModalBasis& basis, double contact, const FrequencyGrid& grid,
                               const StringSupport& support, const SensorPair& sensors) {
  std::vector<std::vector<Complex>> all = string_model(basis, contact, support).transfer(grid);
  StringTransfer transfer{{std::move(all[0]), std::move(all[1])}, std::move(all[2])};
  for (std::size_t r = 0; r < 2; ++r) {
    read_by_sensor(grid, sensors[r], transfer.reaction[r]);
  }
  return transfer;
}

TransientFit::TransientFit(const ModalBasis& basis, const FrequencyGrid& grid, double sample_rate,
                           bool bending, const SensorPair& sensors)
    : grid_(grid), sample_rate_(sample_rate), sensors_(sensors), poles_(basis.size()) {
  const double law = bending ? inharmonicity_of(basis) : 0.0;
  for (std::size_t r = 0; r < 2; ++r) {
    gains_[r] = reaction_gains(basis, r == 0 ? End::kLeft : End::kRight);
  }
  for (std::size_t i = 0; i < basis.size(); ++i) {
    const double decay = basis.zeta[i] * basis.omega[i];
    const double damped = basis.omega[i] * std::sqrt(1.0 - basis.zeta[i] * basis.zeta[i]);
    poles_[i] = std::polar(std::exp(-decay / sample_rate), damped / sample_rate);
    const double n_squared = static_cast<double>((i + 1) * (i + 1));
    // Columns of one length; the unknown's unit does not matter.
    const double scale = (1.0 + law * n_squared) / std::abs(gains_[0][i]);
    for (auto& gains : gains_) gains[i] *= scale;
  }
}

Complex TransientFit::reading(std::size_t side, std::size_t k) const {
  return std::polar(sensors_[side].gain, -grid_.omega(k) * sensors_[side].delay);
}

// Transforms of the real and imaginary part of the n-th decay at the bin of this shift.
std::array<Complex, 2> TransientFit::decay_of(std::size_t n, Complex shift) const {
  const Complex one = 1.0 / (1.0 - poles_[n] * shift);
  const Complex other = 1.0 / (1.0 - std::conj(poles_[n]) * shift);
  return {0.5 * (one + other), Complex{0.0, 0.5} * (one - other)};
}

// Two complex equations a bin: along the force's direction in the whitened pair (variance
// 1 + q P) and across it (variance 1). With one side there is the first alone.
void TransientFit::fill_rows(const Setting& setting, std::size_t k,
                             const std::array<std::span<Complex>, 2>& spectra, Eigen::Index row,
                             Workspace& workspace) const {
  std::array<double, 2> weight = {0.0, 0.0};
  std::array<Complex, 2> direction;
  double q = 0.0;
  for (std::size_t r = 0; r < 2; ++r) {
    if (setting.noise_variance[r] > 0.0) weight[r] = 1.0 / std::sqrt(setting.noise_variance[r]);
    direction[r] = weight[r] * setting.transfer[r][k];
    q += std::norm(direction[r]);
  }
  const double along_scale = 1.0 / std::sqrt(1.0 + q * setting.prior[k]);
  if (q > 0.0) {
    for (Complex& value : direction) value /= std::sqrt(q);
  } else {
    direction = {1.0, 0.0};
  }
  const double across_scale = weight[0] > 0.0 && weight[1] > 0.0 ? 1.0 : 0.0;
  const auto put = [&](const std::array<Complex, 2>& pair, const auto& place) {
    const Complex x0 = weight[0] * pair[0], x1 = weight[1] * pair[1];
    const Complex along =
        along_scale * (std::conj(direction[0]) * x0 + std::conj(direction[1]) * x1);
    const Complex across = across_scale * (direction[0] * x1 - direction[1] * x0);
    place(0, along.real());
    place(1, along.imag());
    place(2, across.real());
    place(3, across.imag());
  };
  put({spectra[0].empty() ? Complex{} : spectra[0][k],
       spectra[1].empty() ? Complex{} : spectra[1][k]},
      [&](Eigen::Index i, double value) { workspace.data[row + i] = value; });
  const Complex shift = std::polar(1.0, -grid_.omega(k) / sample_rate_);
  const std::array<Complex, 2> read = {reading(0, k), reading(1, k)};
  for (std::size_t n = 0; n < poles_.size(); ++n) {
    const std::array<Complex, 2> parts = decay_of(n, shift);
    for (std::size_t part = 0; part < 2; ++part) {
      const auto column = static_cast<Eigen::Index>(2 * n + part);
      put({gains_[0][n] * read[0] * parts[part], gains_[1][n] * read[1] * parts[part]},
          [&](Eigen::Index i, double value) { workspace.rows(row + i, column) = value; });
    }
  }
}

void TransientFit::subtract(const Setting& setting, std::array<std::span<Complex>, 2> spectra,
                            Workspace& workspace) const {
  const auto columns = static_cast<Eigen::Index>(2 * poles_.size());
  workspace.normal = Eigen::MatrixXd::Zero(columns, columns);
  workspace.right = Eigen::VectorXd::Zero(columns);
  for (std::size_t begin = 1; begin < grid_.bins; begin += kBlock) {
    const std::size_t end = std::min(grid_.bins, begin + kBlock);
    const auto rows = static_cast<Eigen::Index>(4 * (end - begin));
    workspace.rows.resize(rows, columns);
    workspace.data.resize(rows);
    for (std::size_t k = begin; k < end; ++k) {
      fill_rows(setting, k, spectra, static_cast<Eigen::Index>(4 * (k - begin)), workspace);
    }
    workspace.normal.selfadjointView<Eigen::Lower>().rankUpdate(workspace.rows.transpose());
    workspace.right.noalias() += workspace.rows.transpose() * workspace.data;
  }
  // A mode that the record does not show keeps no decay.
  workspace.normal.diagonal().array() += 1e-13 * workspace.normal.diagonal().maxCoeff() + 1e-300;
  const Eigen::VectorXd decays =
      workspace.normal.selfadjointView<Eigen::Lower>().ldlt().solve(workspace.right);
  for (std::size_t k = 1; k < grid_.bins; ++k) {
    const Complex shift = std::polar(1.0, -grid_.omega(k) / sample_rate_);
    std::array<Complex, 2> sum;
    for (std::size_t n = 0; n < poles_.size(); ++n) {
      const std::array<Complex, 2> parts = decay_of(n, shift);
      const auto column = static_cast<Eigen::Index>(2 * n);
      const Complex value = decays[column] * parts[0] + decays[column + 1] * parts[1];
      sum[0] += gains_[0][n] * value;
      sum[1] += gains_[1][n] * value;
    }
    for (std::size_t r = 0; r < 2; ++r) {
      if (!spectra[r].empty()) spectra[r][k] -= reading(r, k) * sum[r];
    }
  }
}

}  // namespace modcal
