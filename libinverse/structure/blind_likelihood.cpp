#include "libinverse/structure/blind_likelihood.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "libsim/base/task_loop.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

Complex rate_of(const ModalPole& pole) {
  return pole.omega * Complex(-pole.zeta, std::sqrt(1.0 - pole.zeta * pole.zeta));
}

Complex constant_of(const ModalModel& model, std::size_t k, std::size_t n) {
  const std::size_t i = k * model.poles.size() + n;
  return {model.constants[i], model.quadrature[i]};
}

}  // namespace

BlindLikelihood::BlindLikelihood(const ContourSpectra& spectra,
                                 const std::vector<SensorKind>& kinds,
                                 const BinVariances& variances, bool at_rest)
    : spectra_(spectra), kinds_(kinds), free_ends_(!at_rest) {
  for (const std::vector<double>& own : variances.of) {
    std::vector<double>& root = roots_.emplace_back();
    for (const double v : own) root.push_back(1.0 / std::sqrt(v));
  }
  for (std::size_t m = 0; m < bins(); ++m) {
    delay_.push_back(std::exp(-spectra.s(m) / spectra.sample_rate));
  }
}

BlindPoint BlindLikelihood::at(const ModalModel& model) const {
  BlindPoint point{.weighted = transfers_of(model, spectra_), .told = std::vector<double>(bins())};
  Transfers data = spectra_.responses;
  for (std::size_t k = 0; k < sensors(); ++k) {
    for (std::size_t m = 0; m < bins(); ++m) {
      point.weighted[k][m] *= roots_[k][m];
      data[k][m] *= roots_[k][m];
      point.told[m] += std::norm(point.weighted[k][m]);
    }
  }
  point.residual = projected(point, data);
  if (free_ends_) fit_ends(model, point, data);
  for (std::size_t m = 0; m < bins(); ++m) {
    Complex score;
    for (std::size_t k = 0; k < sensors(); ++k) {
      score += std::conj(point.weighted[k][m]) * data[k][m];
    }
    point.force.push_back(score / point.told[m]);
  }
  point.cost = 2.0 * point.residual.squaredNorm() / spectra_.correlated();
  return point;
}

Eigen::MatrixXd BlindLikelihood::jacobian(const ModalModel& start, const ModalModel& model,
                                          const BlindPoint& point, bool factors) const {
  const std::size_t modes = model.poles.size();
  const auto poles = static_cast<Index>(2 * modes);
  const Index count = factors ? poles + static_cast<Index>(2 * modes * sensors()) : poles;
  Eigen::MatrixXd result(2 * static_cast<Index>(bins() * sensors()), count);
  for_each_task(modes, [&](std::size_t n) {
    const ModalPole& pole = model.poles[n];
    const double step = std::cbrt(std::numeric_limits<double>::epsilon());
    for (const bool damping : {false, true}) {
      const double near = damping ? 100.0 * step : step;
      ModalPole up = pole, down = pole;
      (damping ? up.zeta : up.omega) *= std::exp(near);
      (damping ? down.zeta : down.omega) *= std::exp(-near);
      Transfers slope(sensors());
      for (std::size_t k = 0; k < sensors(); ++k) {
        const Complex constant = constant_of(model, k, n);
        slope[k] = made_by(point, k, n, up, constant);
        const std::vector<Complex> other = made_by(point, k, n, down, constant);
        for (std::size_t m = 0; m < bins(); ++m) {
          slope[k][m] = (slope[k][m] - other[m]) / (2.0 * near);
        }
      }
      result.col(static_cast<Index>(2 * n) + (damping ? 1 : 0)) = -projected(point, slope);
    }
    for (std::size_t k = 0; factors && k < sensors(); ++k) {
      for (const bool imaginary : {false, true}) {
        Transfers slope(sensors(), std::vector<Complex>(bins()));
        const Complex unit = imaginary ? Complex(0.0, 1.0) : Complex(1.0);
        slope[k] = made_by(point, k, n, pole, unit * constant_of(start, k, n));
        result.col(poles + static_cast<Index>(2 * (k * modes + n)) + (imaginary ? 1 : 0)) =
            -projected(point, slope);
      }
    }
  });
  if (free_ends_) result -= point.basis * (point.basis.transpose() * result);
  return result;
}

double BlindLikelihood::numbers(std::size_t modes) const {
  return 2.0 * static_cast<double>(bins() * (sensors() - 1)) / correlated() -
         (free_ends_ ? 2.0 * static_cast<double>(modes) : 0.0);
}

// P v, stacked.
Eigen::VectorXd BlindLikelihood::projected(const BlindPoint& point, const Transfers& v) const {
  const auto count = static_cast<Index>(bins() * sensors());
  Eigen::VectorXd result(2 * count);
  for (std::size_t m = 0; m < bins(); ++m) {
    Complex along;
    for (std::size_t k = 0; k < sensors(); ++k) along += std::conj(point.weighted[k][m]) * v[k][m];
    along /= point.told[m];
    for (std::size_t k = 0; k < sensors(); ++k) {
      const Complex left = v[k][m] - point.weighted[k][m] * along;
      const auto i = static_cast<Index>(k * bins() + m);
      result[i] = left.real();
      result[i + count] = left.imag();
    }
  }
  return result;
}

// What a mode makes of the force at a sensor, whitened, with what it makes of its end state.
std::vector<Complex> BlindLikelihood::made_by(const BlindPoint& point, std::size_t k, std::size_t n,
                                              const ModalPole& pole, Complex constant) const {
  std::vector<Complex> result(bins());
  for (std::size_t m = 0; m < bins(); ++m) {
    const Complex s = spectra_.s(m);
    result[m] = roots_[k][m] * numerator_of(kinds_[k], pole, constant, s) / pole.denominator(s) *
                point.force[m];
  }
  if (!free_ends_) return result;
  const auto i = static_cast<Index>(2 * n);
  const std::vector<Complex> ends =
      end_column(k, pole, constant, {point.ends[i], point.ends[i + 1]});
  for (std::size_t m = 0; m < bins(); ++m) result[m] += ends[m];
  return result;
}

// r c U + conj(r c) U', whitened.
std::vector<Complex> BlindLikelihood::end_column(std::size_t k, const ModalPole& pole,
                                                 Complex constant, Complex state) const {
  const Complex rate = rate_of(pole), step = std::exp(rate / spectra_.sample_rate);
  const Complex residue =
      numerator_of(kinds_[k], pole, constant, rate) / (rate - std::conj(rate)) * state;
  std::vector<Complex> result(bins());
  for (std::size_t m = 0; m < bins(); ++m) {
    result[m] = roots_[k][m] * (residue / (1.0 - step * delay_[m]) +
                                std::conj(residue) / (1.0 - std::conj(step) * delay_[m]));
  }
  return result;
}

void BlindLikelihood::fit_ends(const ModalModel& model, BlindPoint& point, Transfers& data) const {
  const std::size_t modes = model.poles.size();
  std::vector<Transfers> columns(2 * modes);
  Eigen::MatrixXd matrix(point.residual.size(), static_cast<Index>(2 * modes));
  Eigen::VectorXd norms(matrix.cols());
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const Complex state = i % 2 == 0 ? Complex(1.0) : Complex(0.0, 1.0);
    for (std::size_t k = 0; k < sensors(); ++k) {
      columns[i].push_back(end_column(k, model.poles[i / 2], constant_of(model, k, i / 2), state));
    }
    const auto at = static_cast<Index>(i);
    matrix.col(at) = projected(point, columns[i]);
    norms[at] = std::max(matrix.col(at).norm(), std::numeric_limits<double>::min());
    matrix.col(at) /= norms[at];
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> solver(matrix);
  point.basis = solver.householderQ() * Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols());
  point.ends = solver.solve(point.residual).cwiseQuotient(norms);
  point.residual -= point.basis * (point.basis.transpose() * point.residual);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    for (std::size_t k = 0; k < sensors(); ++k) {
      for (std::size_t m = 0; m < bins(); ++m) {
        data[k][m] -= point.ends[static_cast<Index>(i)] * columns[i][k][m];
      }
    }
  }
}

}  // namespace modcal
