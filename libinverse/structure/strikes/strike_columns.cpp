#include "libinverse/structure/strikes/strike_columns.hpp"

#include <algorithm>
#include <cmath>

namespace modcal {

StrikeColumns::StrikeColumns(const ContourSpectra& spectra, std::span<const double> force)
    : spectra_(spectra), force_(force.begin(), force.end()) {
  // Below double precision nothing of what rings on is left.
  rings_ = spectra.grid.sigma * spectra.duration() < 36.0;
  for (std::size_t m = 0; m < spectra.count(); ++m) {
    delay_.push_back(std::exp(-spectra.s(m) / spectra.sample_rate));
  }
}

Complex StrikeColumns::left_over(Complex rate) const {
  // Horner's scheme in exp(λ/f_s): the last sample is one step from the record's end. Four sums of
  // each fourth sample run side by side, for one would wait for every product.
  constexpr std::size_t chains = 4;
  const Complex step = std::exp(rate / spectra_.sample_rate);
  const Complex stride = std::exp(static_cast<double>(chains) * rate / spectra_.sample_rate);
  std::array<Complex, chains> sums{};
  const std::size_t lone = force_.size() % chains;
  for (std::size_t j = 0; j < lone; ++j) sums[chains - lone + j] = force_[j];
  for (std::size_t j = lone; j < force_.size(); j += chains) {
    for (std::size_t i = 0; i < chains; ++i) sums[i] = sums[i] * stride + force_[j + i];
  }
  Complex sum;
  for (const Complex& part : sums) sum = (sum + part) * step;
  return -std::exp(-spectra_.grid.sigma * spectra_.duration()) / spectra_.sample_rate * sum;
}

std::array<ColumnPair, 3> StrikeColumns::of(const ModalPole& pole,
                                            const std::array<bool, 3>& powers) const {
  const double omega = pole.omega;
  const Complex rate = omega * Complex(-pole.zeta, std::sqrt(1.0 - pole.zeta * pole.zeta));
  const std::size_t count = spectra_.count();
  const Complex left = rings_ ? left_over(rate) : 0.0;
  const Complex step = std::exp(rate / spectra_.sample_rate);
  std::vector<Complex> own(count), after(rings_ ? count : 0), other(rings_ ? count : 0);
  for (std::size_t m = 0; m < count; ++m) {
    const Complex s = spectra_.s(m);
    own[m] = spectra_.force[m] / pole.denominator(s);
    if (!rings_) continue;
    after[m] = 1.0 / (1.0 - step * delay_[m]);
    other[m] = 1.0 / (1.0 - std::conj(step) * delay_[m]);
  }
  std::array<ColumnPair, 3> result;
  for (int p = 0; p < 3; ++p) {
    if (!powers[static_cast<std::size_t>(p)]) continue;
    const double scale = std::pow(omega, 2 - p);
    const auto numerator = [&](Complex s, bool turned) {
      const Complex q = turned ? (p == 0 ? s / omega : -omega / s) : 1.0;
      return scale * q * (p == 0 ? 1.0 : p == 1 ? s : s * s);
    };
    for (const bool turned : {false, true}) {
      std::vector<Complex>& column = result[static_cast<std::size_t>(p)][turned];
      column.resize(count);
      const Complex residue = numerator(rate, turned) / (rate - std::conj(rate)) * left;
      for (std::size_t m = 0; m < count; ++m) {
        column[m] = numerator(spectra_.s(m), turned) * own[m];
        if (rings_) column[m] += residue * after[m] + std::conj(residue) * other[m];
      }
    }
  }
  return result;
}

}  // namespace modcal
