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

namespace {

// What the forces may do as well, of contacts one after the other: the matrix of Σ_k conj(h_ik)
// h_jk/V_k + δ_ij/P_i of every bin as L D Lᴴ, by which each contact's part of the columns is
// cleared of that of those before.
class ForceElimination {
 public:
  // along: Σ_k conj(h_ik) x_k/V_k of the columns, seen: of the responses.
  std::vector<Eigen::MatrixXcd> along;
  std::vector<Eigen::VectorXcd> seen;
  std::vector<Eigen::VectorXd> share;  // 1/D_i

  ForceElimination(std::size_t contacts, Index bins, Index unknowns)
      : along(contacts, Eigen::MatrixXcd::Zero(bins, unknowns)),
        seen(contacts, Eigen::VectorXcd::Zero(bins)),
        told_(contacts, Eigen::VectorXd::Zero(bins)),
        between_(contacts) {
    for (std::size_t i = 0; i < contacts; ++i) {
      between_[i].assign(i, Eigen::VectorXcd::Zero(bins));
    }
  }

  // One sensor's part: its weighted columns and responses, h of every contact.
  void add(const std::vector<const Transfers*>& contacts, std::size_t k,
           const Eigen::VectorXd& weight, const Eigen::MatrixXcd& weighted,
           const Eigen::VectorXcd& response) {
    using Spectrum = Eigen::Map<const Eigen::VectorXcd>;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const Spectrum h((*contacts[i])[k].data(), weight.size());
      along[i] += h.conjugate().asDiagonal() * weighted;
      seen[i] += h.conjugate().cwiseProduct(weight.asDiagonal() * response);
      told_[i] += weight.cwiseProduct(h.cwiseAbs2());
      for (std::size_t j = 0; j < i; ++j) {
        const Spectrum other((*contacts[j])[k].data(), weight.size());
        between_[i][j] += h.conjugate().cwiseProduct(weight.asDiagonal() * other);
      }
    }
  }

  void eliminate(const std::vector<const std::vector<double>*>& powers) {
    for (std::size_t i = 0; i < powers.size(); ++i) {
      const Eigen::Map<const Eigen::VectorXd> prior(powers[i]->data(), told_[i].size());
      Eigen::VectorXd pivot = prior.cwiseInverse() + told_[i];
      for (std::size_t j = 0; j < i; ++j) {
        // L_ij D_j of the row, before it is divided by D_j.
        Eigen::VectorXcd& row = between_[i][j];
        for (std::size_t t = 0; t < j; ++t) {
          row -= between_[i][t].cwiseProduct(between_[j][t].conjugate()).cwiseProduct(share[t]);
        }
        pivot -= share[j].cwiseProduct(row.cwiseAbs2());
        along[i] -= row.cwiseProduct(share[j]).asDiagonal() * along[j];
        seen[i] -= row.cwiseProduct(share[j]).cwiseProduct(seen[j]);
      }
      // Rounding is all that is left where no sensor tells the contacts apart.
      share.push_back(pivot.cwiseMax(1e-14 * told_[i]).cwiseInverse());
    }
  }

 private:
  std::vector<Eigen::VectorXd> told_;
  std::vector<std::vector<Eigen::VectorXcd>> between_;  // i, j < i
};

}  // namespace

InitialState::Fit InitialState::fit(const Transfers& transfers, const BinVariances& variances,
                                    const std::vector<double>& power,
                                    const Eigen::VectorXd& widths) const {
  const Index unknowns = columns_.front().cols(), bins = columns_.front().rows();
  std::vector<const Transfers*> contacts;
  std::vector<const std::vector<double>*> powers;
  for (const OtherForce& other : variances.others) {
    contacts.push_back(&other.transfers);
    powers.push_back(&other.power);
  }
  contacts.push_back(&transfers);
  powers.push_back(&power);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(unknowns, unknowns);
  Eigen::VectorXd score = Eigen::VectorXd::Zero(unknowns);
  ForceElimination forces(contacts.size(), bins, unknowns);
  double power_of_all = 0.0;
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    const Eigen::Map<const Eigen::VectorXcd> y(spectra_.responses[k].data(), bins);
    const Eigen::VectorXd weight =
        Eigen::Map<const Eigen::VectorXd>(variances.of[k].data(), bins).cwiseInverse();
    const Columns weighted = weight.asDiagonal() * columns_[k];
    matrix += (columns_[k].adjoint() * weighted).real();
    score += (weighted.adjoint() * y).real();
    forces.add(contacts, k, weight, weighted, y);
    power_of_all += weight.dot(y.cwiseAbs2());
  }
  forces.eliminate(powers);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Columns& along = forces.along[i];
    const Eigen::VectorXd& share = forces.share[i];
    matrix -= (along.adjoint() * share.asDiagonal() * along).real();
    score -= (along.adjoint() * (share.asDiagonal() * forces.seen[i])).real();
    power_of_all -= share.dot(forces.seen[i].cwiseAbs2());
  }
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
  result.squares = scale * power_of_all;
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
