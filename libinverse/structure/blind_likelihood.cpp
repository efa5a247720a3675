#include "libinverse/structure/blind_likelihood.hpp"

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

// r of the states 1: the residue of numerator/D at λ.
Complex residue_of(SensorKind kind, const ModalPole& pole, Complex constant) {
  const Complex rate = rate_of(pole);
  return numerator_of(kind, pole, constant, rate) / (rate - std::conj(rate));
}

// −P (signals), signals of every sensor.
void project(const BlindBins& bins, const std::vector<PlanarVector>& signals, double* column) {
  const std::vector<double> none(bins.sensors.size(), 0.0);
  project_column(bins, {&bins.s, &bins.s, &bins.s, none.data(), none.data(), &signals}, column);
}

}  // namespace

BlindLikelihood::BlindLikelihood(const ContourSpectra& spectra,
                                 const std::vector<SensorKind>& kinds,
                                 const BinVariances& variances, bool at_rest)
    : spectra_(spectra),
      kinds_(kinds),
      free_ends_(!at_rest),
      s_(spectra.count()),
      turned_(spectra.count()),
      delay_(spectra.count()) {
  for (const std::vector<double>& own : variances.of) {
    roots_.push_back(
        padded(own.size(), 0.0, [&own](std::size_t m) { return 1.0 / std::sqrt(own[m]); }));
  }
  for (std::size_t m = 0; m < bins(); ++m) {
    s_.set(m, spectra.s(m));
    turned_.set(m, -1.0 / spectra.s(m));
    delay_.set(m, std::exp(-spectra.s(m) / spectra.sample_rate));
  }
  for (std::size_t k = 0; k < roots_.size(); ++k) {
    PlanarVector& own = data_.emplace_back(bins());
    for (std::size_t m = 0; m < bins(); ++m) own.set(m, roots_[k][m] * spectra.responses[k][m]);
  }
}

BlindBins BlindLikelihood::bins_of(const ModalModel& model, std::vector<double>& told) const {
  BlindBins result{.s = s_, .turned = turned_};
  const Transfers transfers = transfers_of(model, spectra_);
  told.assign(bins(), 0.0);
  for (std::size_t k = 0; k < sensors(); ++k) {
    result.sensors.push_back({.low = power_of_s(kinds_[k]) == 0,
                              .weighted = PlanarVector(bins()),
                              .told = PlanarVector(bins()),
                              .made = PlanarVector(bins())});
    for (std::size_t m = 0; m < bins(); ++m) {
      const Complex own = roots_[k][m] * transfers[k][m];
      result.sensors[k].weighted.set(m, own);
      told[m] += std::norm(own);
    }
  }
  for (BlindBins::Sensor& sensor : result.sensors) {
    for (std::size_t m = 0; m < bins(); ++m) {
      sensor.told.set(m, std::conj(sensor.weighted.at(m)) / told[m]);
    }
  }
  return result;
}

BlindPoint BlindLikelihood::at(const ModalModel& model) const {
  BlindPoint point;
  point.bins = bins_of(model, point.told);
  point.residual.resize(2 * static_cast<Index>(sensors() * s_.size()));
  project(point.bins, data_, point.residual.data());
  point.residual = -point.residual;
  Signals data = data_;
  if (free_ends_) fit_ends(model, point, data);
  point.force = force_of(point, data);
  for (std::size_t k = 0; k < sensors(); ++k) {
    const int p = power_of_s(kinds_[k]);
    for (std::size_t m = 0; m < bins(); ++m) {
      const Complex s = spectra_.s(m), own = p == 0 ? 1.0 : p == 1 ? s : s * s;
      point.bins.sensors[k].made.set(m, roots_[k][m] * own * point.force[m]);
    }
  }
  point.cost = 2.0 * point.residual.squaredNorm() / spectra_.correlated();
  return point;
}

std::vector<Complex> BlindLikelihood::force_of(const BlindPoint& point, const Signals& data) const {
  std::vector<Complex> force(bins());
  for (std::size_t k = 0; k < sensors(); ++k) {
    const PlanarVector& told = point.bins.sensors[k].told;
    for (std::size_t m = 0; m < bins(); ++m) force[m] += told.at(m) * data[k].at(m);
  }
  return force;
}

std::vector<Complex> BlindLikelihood::force_drawn(const ModalModel& model,
                                                  std::span<const double> normal) const {
  const BlindPoint point = at(model);
  MODCAL_REQUIRE(normal.size() == static_cast<std::size_t>(point.ends.size()) + 2 * bins(),
                 "{} normal numbers for {} bins and {} parts of the ends", normal.size(), bins(),
                 point.ends.size());
  Signals data = data_;
  if (free_ends_) {
    const Eigen::Map<const Eigen::VectorXd> drawn(normal.data(), point.ends.size());
    take_ends(model, point, point.ends + point.ends_root * drawn, data);
    normal = normal.subspan(static_cast<std::size_t>(point.ends.size()));
  }
  std::vector<Complex> force = force_of(point, data);
  for (std::size_t m = 0; m < bins(); ++m) {
    force[m] += std::sqrt(0.5 / point.told[m]) * Complex(normal[2 * m], normal[2 * m + 1]);
  }
  return force;
}

Transfers BlindLikelihood::without_ends(const ModalModel& model, const BlindPoint& point) const {
  Signals data = data_;
  if (free_ends_) take_ends(model, point, point.ends, data);
  Transfers result(sensors(), std::vector<Complex>(bins()));
  for (std::size_t k = 0; k < sensors(); ++k) {
    for (std::size_t m = 0; m < bins(); ++m) result[k][m] = data[k].at(m) / roots_[k][m];
  }
  return result;
}

Eigen::MatrixXd BlindLikelihood::jacobian(const ModalModel& start, const ModalModel& model,
                                          const BlindPoint& point, bool factors) const {
  const std::size_t modes = model.poles.size();
  const auto count = static_cast<Index>(2 * modes * (factors ? 1 + sensors() : 1));
  Eigen::MatrixXd result(point.residual.size(), count);
  for_each_task(modes,
                [&](std::size_t n) { mode_columns(start, model, point, n, factors, result); });
  if (free_ends_) point.span.take_from(result);
  return result;
}

void BlindLikelihood::mode_columns(const ModalModel& start, const ModalModel& model,
                                   const BlindPoint& point, std::size_t n, bool factors,
                                   Eigen::MatrixXd& result) const {
  const std::size_t modes = model.poles.size();
  ModeShapes shapes(bins());
  shape_mode(point.bins, model.poles[n], shapes);
  std::vector<double> a, b;
  for (std::size_t k = 0; k < sensors(); ++k) {
    a.push_back(constant_of(model, k, n).real());
    b.push_back(constant_of(model, k, n).imag());
  }
  Signals ends;
  ColumnTerms omega{&shapes.by_omega, &shapes.low_omega, &shapes.high_omega, a.data(), b.data()};
  ColumnTerms zeta{&shapes.by_zeta, &shapes.low_zeta, &shapes.high_zeta, a.data(), b.data()};
  for (const bool damping : {false, true}) {
    ColumnTerms& terms = damping ? zeta : omega;
    if (free_ends_) ends = slope_of_ends(point, model, n, damping), terms.extra = &ends;
    project_column(point.bins, terms,
                   result.col(static_cast<Index>(2 * n) + (damping ? 1 : 0)).data());
  }
  for (std::size_t k = 0; factors && k < sensors(); ++k) {
    for (const bool imaginary : {false, true}) {
      const Complex unit = (imaginary ? Complex(0.0, 1.0) : 1.0) * constant_of(start, k, n);
      std::ranges::fill(a, 0.0);
      std::ranges::fill(b, 0.0);
      a[k] = unit.real();
      b[k] = unit.imag();
      ColumnTerms terms{&shapes.inverse, &shapes.low, &shapes.high, a.data(), b.data()};
      if (free_ends_) {
        ends = rest();
        const auto i = static_cast<Index>(2 * n);
        const Complex state(point.ends[i], point.ends[i + 1]);
        add_ends(point.ends_shapes[n], roots_[k],
                 state * residue_of(kinds_[k], model.poles[n], unit), 0.0, ends[k]);
        terms.extra = &ends;
      }
      const std::size_t column = 2 * (modes + k * modes + n) + (imaginary ? 1 : 0);
      project_column(point.bins, terms, result.col(static_cast<Index>(column)).data());
    }
  }
}

double BlindLikelihood::numbers() const {
  return 2.0 * static_cast<double>(bins() * (sensors() - 1)) / correlated();
}

BlindLikelihood::Signals BlindLikelihood::rest() const {
  return Signals(sensors(), PlanarVector(bins()));
}

// What of a mode's ringing at the ends changes by ln ω or ln ζ: of its residue by central
// differences, of U by dU/dλ = U (U − 1)/f_s.
BlindLikelihood::Signals BlindLikelihood::slope_of_ends(const BlindPoint& point,
                                                        const ModalModel& model, std::size_t n,
                                                        bool damping) const {
  const double step = (damping ? 100.0 : 1.0) * std::cbrt(std::numeric_limits<double>::epsilon());
  ModalPole up = model.poles[n], down = up;
  (damping ? up.zeta : up.omega) *= std::exp(step);
  (damping ? down.zeta : down.omega) *= std::exp(-step);
  const auto i = static_cast<Index>(2 * n);
  const Complex state(point.ends[i], point.ends[i + 1]);
  const Complex moves = (rate_of(up) - rate_of(down)) / (2.0 * step * spectra_.sample_rate);
  Signals result = rest();
  for (std::size_t k = 0; k < sensors(); ++k) {
    const Complex constant = constant_of(model, k, n);
    const Complex slope =
        (residue_of(kinds_[k], up, constant) - residue_of(kinds_[k], down, constant)) /
        (2.0 * step);
    add_ends(point.ends_shapes[n], roots_[k], state * slope,
             state * residue_of(kinds_[k], model.poles[n], constant) * moves, result[k]);
  }
  return result;
}

// y − X c.
void BlindLikelihood::take_ends(const ModalModel& model, const BlindPoint& point,
                                const Eigen::VectorXd& ends, Signals& data) const {
  for (std::size_t n = 0; n < model.poles.size(); ++n) {
    const auto i = static_cast<Index>(2 * n);
    const Complex state(ends[i], ends[i + 1]);
    for (std::size_t k = 0; k < sensors(); ++k) {
      const Complex residue = residue_of(kinds_[k], model.poles[n], constant_of(model, k, n));
      add_ends(point.ends_shapes[n], roots_[k], -state * residue, 0.0, data[k]);
    }
  }
}

void BlindLikelihood::fit_ends(const ModalModel& model, BlindPoint& point, Signals& data) const {
  const auto count = static_cast<Index>(2 * model.poles.size());
  Eigen::MatrixXd matrix(point.residual.size(), count);
  Eigen::VectorXd norms(count);
  point.ends_shapes.assign(model.poles.size(), EndShapes(bins()));
  for (Index i = 0; i < count; ++i) {
    const auto n = static_cast<std::size_t>(i / 2);
    const ModalPole& pole = model.poles[n];
    const Complex state = i % 2 == 0 ? Complex(-1.0) : Complex(0.0, -1.0);
    if (i % 2 == 0) {
      shape_ends(delay_, std::exp(rate_of(pole) / spectra_.sample_rate), point.ends_shapes[n]);
    }
    Signals column = rest();
    for (std::size_t k = 0; k < sensors(); ++k) {
      const Complex residue = residue_of(kinds_[k], pole, constant_of(model, k, n));
      add_ends(point.ends_shapes[n], roots_[k], state * residue, 0.0, column[k]);
    }
    project(point.bins, column, matrix.col(i).data());
    norms[i] = std::max(matrix.col(i).norm(), std::numeric_limits<double>::min());
    matrix.col(i) /= norms[i];
  }
  point.span = ColumnSpan(matrix);
  point.ends = point.span.take_from(point.residual).cwiseQuotient(norms);
  point.ends_root = std::sqrt(0.5 * spectra_.correlated()) * norms.cwiseInverse().asDiagonal() *
                    point.span.root();
  take_ends(model, point, point.ends, data);
}

}  // namespace modcal
