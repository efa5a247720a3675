#include "libinverse/structure/force/pulse_train.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libinverse/structure/tuning.hpp"
#include "libsim/base/error.hpp"
#include "libsim/base/task_loop.hpp"
#include "libsim/base/turn.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

double step_of(const StructureTable& table, double sample_rate) {
  return std::max(1.0 / (3.0 * table.high), 0.5 / sample_rate);
}

}  // namespace

double PulseTrain::instants_in(const StructureTable& table, double sample_rate, double window) {
  return std::floor(window / step_of(table, sample_rate));
}

PulseTrain::PulseTrain(const StructureTable& table, const ContourSpectra& spectra, double window)
    : table_(table), spectra_(spectra), step_(step_of(table, spectra.sample_rate)) {
  const double most = instants_in(table, spectra.sample_rate, window);
  MODCAL_REQUIRE(most >= 1.0 && most <= kMostInstants,
                 "a window of {:g} s holds {:g} instants of a pulse, {:g} s apart: state a window "
                 "of 1 to {:g} of them, or shape: smooth",
                 window, most, step_, kMostInstants);
  at_.resize(static_cast<std::size_t>(most));
  std::iota(at_.begin(), at_.end(), Index{0});
}

void PulseTrain::keep(const std::vector<Index>& chosen) {
  std::vector<Index> kept;
  for (const Index j : chosen) kept.push_back(at_[static_cast<std::size_t>(j)]);
  at_ = std::move(kept);
}

std::pair<Eigen::MatrixXd, Eigen::VectorXd> PulseTrain::normal_of(
    const BinEvidence& evidence) const {
  const Index steps = at_.back() + 1, count = std::ssize(at_);
  const double share = 2.0 / spectra_.correlated();
  Eigen::VectorXd lags = Eigen::VectorXd::Zero(steps), scores = Eigen::VectorXd::Zero(steps);
  for (std::size_t m = 0; m < spectra_.count(); ++m) {
    const double omega = spectra_.s(m).imag(), pulse = table_.pulse_at(omega / kTurn);
    const Complex step = std::polar(1.0, omega * step_);
    const Complex right = share * pulse * evidence.score[m];
    const double weight = share * pulse * pulse * evidence.told[m];
    Complex turn = 1.0;
    for (Index i = 0; i < steps; ++i) {
      lags[i] += weight * turn.real();
      scores[i] += turn.real() * right.real() - turn.imag() * right.imag();
      turn *= step;
    }
  }
  Eigen::VectorXd decay(count), score(count);
  for (Index i = 0; i < count; ++i) {
    const Index at = at_[static_cast<std::size_t>(i)];
    decay[i] = std::exp(-spectra_.grid.sigma * step_ * static_cast<double>(at));
    score[i] = scores[at] * decay[i];
  }
  Eigen::MatrixXd matrix(count, count);
  for (Index i = 0; i < count; ++i) {
    for (Index j = 0; j < count; ++j) {
      const Index lag = at_[static_cast<std::size_t>(i)] - at_[static_cast<std::size_t>(j)];
      matrix(i, j) = lags[std::abs(lag)] * decay[i] * decay[j];
    }
  }
  return {std::move(matrix), std::move(score)};
}

std::vector<Complex> PulseTrain::spectrum(const Eigen::VectorXd& amplitudes) const {
  std::vector<Complex> result;
  for (std::size_t m = 0; m < spectra_.count(); ++m) {
    const Complex step = std::exp(-spectra_.s(m) * step_);
    Complex sum, turn = 1.0;
    for (Index i = 0, reached = 0; i < amplitudes.size(); ++i) {
      for (; reached < at_[static_cast<std::size_t>(i)]; ++reached) turn *= step;
      sum += amplitudes[i] * turn;
    }
    result.push_back(sum * table_.pulse_at(spectra_.s(m).imag() / kTurn));
  }
  return result;
}

Eigen::MatrixXd PulseTrain::columns(Index samples) const {
  // Long enough that no pulse comes round to the other end; |G| beyond the band is that of its end.
  const std::size_t length = 4 * static_cast<std::size_t>(samples) + 1024;
  const RealFft fft(length);
  const double spacing = kTurn * spectra_.sample_rate / static_cast<double>(length);
  Eigen::MatrixXd result(samples, std::ssize(at_));
  for_each_task(at_.size(), [&](std::size_t i) {
    const double instant = step_ * static_cast<double>(at_[i]);
    std::vector<Complex> spectrum(fft.bins());
    for (std::size_t k = 0; k < spectrum.size(); ++k) {
      const double omega = spacing * static_cast<double>(k);
      spectrum[k] = std::polar(table_.pulse_at(omega / kTurn), -omega * instant);
    }
    std::vector<double> signal(length);
    fft.inverse(spectrum, signal);
    for (Index j = 0; j < samples; ++j) {
      result(j, static_cast<Index>(i)) = signal[static_cast<std::size_t>(j)];
    }
  });
  return result;
}

}  // namespace modcal
