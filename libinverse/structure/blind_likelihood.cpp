#include "libinverse/structure/blind_likelihood.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "libsim/base/error.hpp"
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
    turned_.push_back(-1.0 / spectra.s(m));
  }
}

Transfers BlindLikelihood::whitened(const Transfers& values) const {
  Transfers result = values;
  for (std::size_t k = 0; k < sensors(); ++k) {
    for (std::size_t m = 0; m < bins(); ++m) result[k][m] *= roots_[k][m];
  }
  return result;
}

BlindPoint BlindLikelihood::at(const ModalModel& model) const {
  BlindPoint point{.weighted = whitened(transfers_of(model, spectra_)),
                   .told = std::vector<double>(bins())};
  Transfers data = whitened(spectra_.responses);
  for (std::size_t k = 0; k < sensors(); ++k) {
    for (std::size_t m = 0; m < bins(); ++m) point.told[m] += std::norm(point.weighted[k][m]);
  }
  point.residual = projected(point, data);
  if (free_ends_) fit_ends(model, point, data);
  point.force = force_of(point, data);
  point.cost = 2.0 * point.residual.squaredNorm() / spectra_.correlated();
  return point;
}

std::vector<Complex> BlindLikelihood::force_of(const BlindPoint& point,
                                               const Transfers& data) const {
  std::vector<Complex> force(bins());
  for (std::size_t m = 0; m < bins(); ++m) {
    for (std::size_t k = 0; k < sensors(); ++k) {
      force[m] += std::conj(point.weighted[k][m]) * data[k][m] / point.told[m];
    }
  }
  return force;
}

std::vector<Complex> BlindLikelihood::force_drawn(const ModalModel& model,
                                                  std::span<const double> normal) const {
  const BlindPoint point = at(model);
  MODCAL_REQUIRE(normal.size() == static_cast<std::size_t>(point.ends.size()) + 2 * bins(),
                 "{} normal numbers for {} bins and {} parts of the ends", normal.size(), bins(),
                 point.ends.size());
  Transfers data = whitened(spectra_.responses);
  if (free_ends_) {
    const Eigen::Map<const Eigen::VectorXd> drawn(normal.data(), point.ends.size());
    take_ends(model, point.ends + point.ends_root * drawn, data);
    normal = normal.subspan(static_cast<std::size_t>(point.ends.size()));
  }
  std::vector<Complex> force = force_of(point, data);
  for (std::size_t m = 0; m < bins(); ++m) {
    force[m] += std::sqrt(0.5 / point.told[m]) * Complex(normal[2 * m], normal[2 * m + 1]);
  }
  return force;
}

Eigen::MatrixXd BlindLikelihood::jacobian(const ModalModel& start, const ModalModel& model,
                                          const BlindPoint& point, bool factors) const {
  const std::size_t modes = model.poles.size();
  const auto poles = static_cast<Index>(2 * modes);
  const Index count = factors ? poles + static_cast<Index>(2 * modes * sensors()) : poles;
  Eigen::MatrixXd result(2 * static_cast<Index>(bins() * sensors()), count);
  for_each_task(modes, [&](std::size_t n) {
    const ModalPole& pole = model.poles[n];
    std::vector<Complex> inverse(bins());
    for (std::size_t m = 0; m < bins(); ++m) inverse[m] = 1.0 / pole.denominator(spectra_.s(m));
    for (const bool damping : {false, true}) {
      Transfers slope(sensors());
      for (std::size_t k = 0; k < sensors(); ++k) {
        const Complex constant = constant_of(model, k, n);
        slope[k] = slope_of(point, k, pole, constant, inverse, damping);
        if (free_ends_) add_slope_of_ends(point, k, n, pole, constant, damping, slope[k]);
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

// What of it changes by ln ω or ln ζ through the force; inverse: 1/D.
std::vector<Complex> BlindLikelihood::slope_of(const BlindPoint& point, std::size_t k,
                                               const ModalPole& pole, Complex constant,
                                               const std::vector<Complex>& inverse,
                                               bool damping) const {
  const int p = power_of_s(kinds_[k]);
  // Of the numerator q alone moves: s/ω falls and −ω/s grows with ω.
  const double turns = damping ? 0.0 : p == 0 ? -constant.imag() : constant.imag();
  const double omega = pole.omega, loss = 2.0 * pole.zeta * omega;
  std::vector<Complex> result(bins());
  for (std::size_t m = 0; m < bins(); ++m) {
    const Complex s = spectra_.s(m), q = p == 0 ? s / omega : omega * turned_[m];
    const Complex own = p == 0 ? 1.0 : p == 1 ? s : s * s;
    const Complex rise = damping ? loss * s : 2.0 * omega * omega + loss * s;
    const Complex made = (constant.real() + constant.imag() * q) * inverse[m];
    result[m] = roots_[k][m] * point.force[m] * own * (turns * q - made * rise) * inverse[m];
  }
  return result;
}

// Through what rings at the ends, by central differences.
void BlindLikelihood::add_slope_of_ends(const BlindPoint& point, std::size_t k, std::size_t n,
                                        const ModalPole& pole, Complex constant, bool damping,
                                        std::vector<Complex>& slope) const {
  const double step = (damping ? 100.0 : 1.0) * std::cbrt(std::numeric_limits<double>::epsilon());
  ModalPole up = pole, down = pole;
  (damping ? up.zeta : up.omega) *= std::exp(step);
  (damping ? down.zeta : down.omega) *= std::exp(-step);
  const auto i = static_cast<Index>(2 * n);
  const Complex state(point.ends[i], point.ends[i + 1]);
  const std::vector<Complex> above = end_column(k, up, constant, state),
                             below = end_column(k, down, constant, state);
  for (std::size_t m = 0; m < bins(); ++m) slope[m] += (above[m] - below[m]) / (2.0 * step);
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

// y − X c, whitened.
void BlindLikelihood::take_ends(const ModalModel& model, const Eigen::VectorXd& ends,
                                Transfers& data) const {
  for (std::size_t n = 0; n < model.poles.size(); ++n) {
    const auto i = static_cast<Index>(2 * n);
    for (std::size_t k = 0; k < sensors(); ++k) {
      const std::vector<Complex> column =
          end_column(k, model.poles[n], constant_of(model, k, n), {ends[i], ends[i + 1]});
      for (std::size_t m = 0; m < bins(); ++m) data[k][m] -= column[m];
    }
  }
}

void BlindLikelihood::fit_ends(const ModalModel& model, BlindPoint& point, Transfers& data) const {
  const auto count = static_cast<Index>(2 * model.poles.size());
  Eigen::MatrixXd matrix(point.residual.size(), count);
  Eigen::VectorXd norms(count);
  for (Index i = 0; i < count; ++i) {
    const auto n = static_cast<std::size_t>(i / 2);
    const Complex state = i % 2 == 0 ? Complex(1.0) : Complex(0.0, 1.0);
    Transfers column;
    for (std::size_t k = 0; k < sensors(); ++k) {
      column.push_back(end_column(k, model.poles[n], constant_of(model, k, n), state));
    }
    matrix.col(i) = projected(point, column);
    norms[i] = std::max(matrix.col(i).norm(), std::numeric_limits<double>::min());
    matrix.col(i) /= norms[i];
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> solver(matrix);
  point.basis = solver.householderQ() * Eigen::MatrixXd::Identity(matrix.rows(), count);
  point.ends = solver.solve(point.residual).cwiseQuotient(norms);
  const Eigen::MatrixXd inverse =
      solver.matrixQR().topRows(count).triangularView<Eigen::Upper>().solve(
          Eigen::MatrixXd::Identity(count, count));
  point.ends_root =
      std::sqrt(0.5 * spectra_.correlated()) * norms.cwiseInverse().asDiagonal() * inverse;
  point.residual -= point.basis * (point.basis.transpose() * point.residual);
  take_ends(model, point.ends, data);
}

}  // namespace modcal
