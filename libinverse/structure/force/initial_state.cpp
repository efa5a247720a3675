#include "libinverse/structure/force/initial_state.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "libsim/base/error.hpp"

namespace modcal {

using Index = Eigen::Index;

InitialState::InitialState(const ModalModel& model, const ContourSpectra& spectra)
    : spectra_(spectra) {
  const std::size_t modes = model.poles.size();
  for (std::size_t k = 0; k < model.sensors.size(); ++k) {
    Columns& columns =
        columns_.emplace_back(static_cast<Index>(spectra.count()), static_cast<Index>(2 * modes));
    for (std::size_t n = 0; n < modes; ++n) {
      const ModalPole& pole = model.poles[n];
      // A mode that is drawn with more than critical damping rings by nothing.
      const double turn = std::sqrt(std::max(1e-6, 1.0 - pole.zeta * pole.zeta));
      const Complex root = pole.omega * Complex(-pole.zeta, turn);
      const Complex constant(model.constant(k, n),
                             model.quadrature.empty() ? 0.0 : model.quadrature[k * modes + n]);
      const Complex residue =
          numerator_of(model.sensors[k], pole, constant, root) / (root - std::conj(root));
      if (k == 0) omegas_.push_back(pole.omega), residues_.push_back(std::abs(residue));
      const auto i = static_cast<Index>(2 * n);
      for (std::size_t m = 0; m < spectra.count(); ++m) {
        const Complex s = spectra.s(m);
        const Complex rings = residue / (1.0 - std::exp((root - s) / spectra.sample_rate));
        const Complex mirrored =
            std::conj(residue) / (1.0 - std::exp((std::conj(root) - s) / spectra.sample_rate));
        columns(static_cast<Index>(m), i) = rings + mirrored;
        columns(static_cast<Index>(m), i + 1) = Complex(0.0, 1.0) * (rings - mirrored);
      }
    }
  }
}

InitialState::Fit InitialState::fit(const Transfers& transfers, const BinVariances& variances,
                                    const std::vector<double>& power,
                                    const Eigen::VectorXd& widths) const {
  const Index unknowns = columns_.front().cols(), bins = columns_.front().rows();
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(unknowns, unknowns);
  Eigen::VectorXd score = Eigen::VectorXd::Zero(unknowns);
  // Σ_k conj(h_k) x_k/V_k of every bin, of the columns and of the responses.
  Columns along = Columns::Zero(bins, unknowns);
  Eigen::VectorXcd seen = Eigen::VectorXcd::Zero(bins);
  double power_of_all = 0.0;
  Eigen::VectorXd told = Eigen::VectorXd::Zero(bins);
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    const Eigen::Map<const Eigen::VectorXcd> h(transfers[k].data(), bins),
        y(spectra_.responses[k].data(), bins);
    const Eigen::VectorXd weight =
        Eigen::Map<const Eigen::VectorXd>(variances.of[k].data(), bins).cwiseInverse();
    const Columns weighted = weight.asDiagonal() * columns_[k];
    matrix += (columns_[k].adjoint() * weighted).real();
    score += (weighted.adjoint() * y).real();
    along += h.conjugate().asDiagonal() * weighted;
    seen += h.conjugate().cwiseProduct(weight.asDiagonal() * y);
    told += weight.cwiseProduct(h.cwiseAbs2());
    power_of_all += weight.dot(y.cwiseAbs2());
  }
  const Eigen::Map<const Eigen::VectorXd> prior(power.data(), bins);
  const Eigen::VectorXd share = (prior.cwiseInverse() + told).cwiseInverse();
  matrix -= (along.adjoint() * share.asDiagonal() * along).real();
  score -= (along.adjoint() * (share.asDiagonal() * seen)).real();
  const double scale = 2.0 / spectra_.correlated();
  matrix *= scale, score *= scale;
  if (widths.size() > 0) matrix.diagonal() += widths.cwiseAbs2().cwiseInverse();
  // Columns of modes outside of the band tell next to nothing, and what the force may do as well
  // cancels: such directions are left where they are.
  const Eigen::VectorXd size = matrix.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(size.asDiagonal() * matrix *
                                                              size.asDiagonal());
  const double least = 1e-12 * static_cast<double>(unknowns);
  const Eigen::VectorXd inverse = solver.eigenvalues().unaryExpr(
      [least](double value) { return value > least ? 1.0 / std::sqrt(value) : 0.0; });
  Fit result;
  result.root = size.asDiagonal() * solver.eigenvectors() * inverse.asDiagonal();
  result.state = result.root * (result.root.transpose() * score);
  result.gain = 0.5 * score.dot(result.state);
  result.squares = scale * (power_of_all - share.dot(seen.cwiseAbs2()));
  return result;
}

Eigen::VectorXd InitialState::widths_of(double rms) const {
  std::vector<double> powers(omegas_.size(), 0.0);
  double all = 0.0;
  for (std::size_t m = 0; m < spectra_.count(); ++m) {
    const double omega = spectra_.s(m).imag(), power = std::norm(spectra_.responses.front()[m]);
    const auto nearest = std::ranges::min_element(
        omegas_, {}, [omega](double own) { return std::abs(own - omega); });
    powers[static_cast<std::size_t>(nearest - omegas_.begin())] += power;
    all += power;
  }
  Eigen::VectorXd widths(static_cast<Index>(2 * powers.size()));
  for (std::size_t n = 0; n < powers.size(); ++n) {
    // 2 Re(r c exp(λt)) has a mean square of 2 |r c|², E|c|² = 2 d².
    // A mode that the sensor does not hear, or no bin tells, is left at rest.
    const bool is_heard = residues_[n] > 0.0 && powers[n] > 0.0;
    const double own = is_heard ? rms * std::sqrt(powers[n] / all) / (2.0 * residues_[n]) : 0.0;
    widths.segment<2>(static_cast<Index>(2 * n)).setConstant(std::max(1e-150, own));
  }
  return widths;
}

Transfers InitialState::without(const Eigen::VectorXd& state) const {
  Transfers result = spectra_.responses;
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    Eigen::Map<Eigen::VectorXcd> y(result[k].data(), columns_[k].rows());
    y -= columns_[k] * state;
  }
  return result;
}

bool InitialState::is_told(const Fit& fit) const {
  const double numbers =
      2.0 * static_cast<double>(spectra_.count() * columns_.size()) / spectra_.correlated();
  const double gain =
      0.5 * numbers * std::log(fit.squares / std::max(fit.squares - 2.0 * fit.gain, 1e-300));
  return gain > 0.5 * static_cast<double>(fit.state.size()) * std::log(numbers);
}

}  // namespace modcal
