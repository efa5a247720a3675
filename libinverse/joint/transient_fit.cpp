#include "libinverse/joint/transient_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "libinverse/joint/tuning.hpp"
#include "libsim/base/dense_solvers.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

// Complex equations of a bin: with two reactions one along the force and one across.
std::size_t equations_of(const TransientFit::Setting& setting) {
  return setting.noise_variance[0] > 0.0 && setting.noise_variance[1] > 0.0 ? 2 : 1;
}

}  // namespace

TransientFit::TransientFit(const ModalBasis& basis, double contact, const FrequencyGrid& grid,
                           double sample_rate, bool bending, const SensorPair& sensors)
    : grid_(grid), sample_rate_(sample_rate), sensors_(sensors), contact_(basis.shape_at(contact)) {
  const double law = bending ? inharmonicity_of(basis) : 0.0;
  const std::vector<double> left = reaction_gains(basis, End::kLeft);
  const std::vector<double> right = reaction_gains(basis, End::kRight);
  for (std::size_t i = 0; i < basis.size(); ++i) {
    const double decay = basis.zeta[i] * basis.omega[i];
    const double damped = basis.omega[i] * std::sqrt(1.0 - basis.zeta[i] * basis.zeta[i]);
    rates_.emplace_back(-decay, damped);
    const double n_squared = static_cast<double>((i + 1) * (i + 1));
    // Columns of one length; the unknown's unit does not matter.
    const double scale = 1.0 / std::abs(left[i]);
    const double bent = scale * (1.0 + law * n_squared);
    contact_[i] *= scale;
    modes_.push_back({.pole = std::polar(std::exp(-decay / sample_rate), damped / sample_rate),
                      .left = bent * left[i],
                      .right = bent * right[i]});
  }
}

Complex TransientFit::reading(std::size_t side, std::size_t k) const {
  return std::polar(sensors_[side].gain, -grid_.omega(k) * sensors_[side].delay);
}

Complex TransientFit::delay_of(std::size_t k) const {
  return std::polar(1.0, -grid_.omega(k) / sample_rate_);
}

// Along the force's direction in the whitened pair (variance 1 + q P) and, of two reactions, across
// it (variance 1).
TransientFit::Equations TransientFit::equations_at(const Setting& setting, std::size_t k) const {
  std::array<double, 2> weight = {0.0, 0.0};
  std::array<Complex, 2> direction;
  double q = 0.0;
  for (std::size_t r = 0; r < 2; ++r) {
    if (setting.noise_variance[r] > 0.0) weight[r] = 1.0 / std::sqrt(setting.noise_variance[r]);
    direction[r] = weight[r] * setting.transfer[r][k];
    q += std::norm(direction[r]);
  }
  const double scale = 1.0 / std::sqrt(1.0 + q * setting.prior[k]);
  if (q > 0.0) {
    for (Complex& value : direction) value /= std::sqrt(q);
  } else {
    direction = {1.0, 0.0};
  }
  return {.along = {scale * weight[0] * std::conj(direction[0]),
                    scale * weight[1] * std::conj(direction[1])},
          .across = {-weight[0] * direction[1], weight[1] * direction[0]}};
}

// The equations of a block of bins as columns, those of the unknowns and the data behind them, in
// whole vectors of bins: what they are longer is 0. Returns the length of the columns.
std::size_t TransientFit::fill_columns(const Setting& setting, std::size_t begin, std::size_t count,
                                       const Spectra& spectra, Workspace& workspace) const {
  const std::size_t equations = equations_of(setting), bins = padded_size(count);
  double* columns = workspace.columns.data();
  double* data = columns + 2 * modes_.size() * kColumnLength;
  workspace.delay = PlanarVector(bins);
  for (std::size_t e = 0; e < equations; ++e) workspace.factors[e] = RingingFactors(bins);
  std::fill_n(data, 2 * equations * bins, 0.0);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t k = begin + i;
    const Equations at = equations_at(setting, k);
    workspace.delay.set(i, delay_of(k));
    const std::array<Complex, 2> read = {reading(0, k), reading(1, k)};
    for (std::size_t e = 0; e < equations; ++e) {
      const std::array<Complex, 2>& by = e == 0 ? at.along : at.across;
      workspace.factors[e].left.set(i, by[0] * read[0]);
      workspace.factors[e].right.set(i, by[1] * read[1]);
      Complex value{};
      for (std::size_t r = 0; r < 2; ++r) {
        if (!spectra[r].empty()) value += by[r] * spectra[r][k];
      }
      data[2 * e * bins + i] = value.real();
      data[(2 * e + 1) * bins + i] = value.imag();
    }
  }
  for (std::size_t e = 0; e < equations; ++e) {
    fill_ringing_columns(modes_, workspace.delay, workspace.factors[e], columns + 2 * e * bins);
  }
  return 2 * equations * bins;
}

// Products over some bins.
void TransientFit::multiply_columns(const Setting& setting, std::size_t first, std::size_t last,
                                    const Spectra& spectra, Workspace& workspace) const {
  const std::size_t width = tiled(2 * modes_.size() + 1);
  const std::size_t most = kColumnLength / (2 * equations_of(setting));
  workspace.columns.resize(width * kColumnLength);
  workspace.products.setZero(static_cast<Index>(width), static_cast<Index>(width));
  for (std::size_t begin = first; begin < last; begin += most) {
    const std::size_t length =
        fill_columns(setting, begin, std::min(most, last - begin), spectra, workspace);
    const double* columns = workspace.columns.data();
    add_products(columns, width, columns, width, true, workspace.products.data(), width, length);
  }
}

void TransientFit::subtract(const Setting& setting, Spectra spectra, Workspace& workspace) const {
  const auto columns = static_cast<Index>(2 * modes_.size());
  multiply_columns(setting, 1, grid_.bins, spectra, workspace);
  workspace.normal = workspace.products.topLeftCorner(columns, columns);
  // A mode that the record does not show keeps no decay.
  workspace.normal.diagonal().array() += 1e-13 * workspace.normal.diagonal().maxCoeff() + 1e-300;
  const Eigen::VectorXd slope = workspace.products.row(columns).head(columns);
  workspace.decays = SemidefiniteSolver(workspace.normal).solve(slope);
  std::vector<RingingMode> modes = modes_;
  for (std::size_t n = 0; n < modes.size(); ++n) modes[n].own = workspace.decay(n);
  add_up(modes, setting.level_known ? 0 : 1, [&](std::size_t k, Complex left, Complex right) {
    if (!spectra[0].empty()) spectra[0][k] -= reading(0, k) * left;
    if (!spectra[1].empty()) spectra[1][k] -= reading(1, k) * right;
  });
}

// One of no mode, of any size.
void TransientFit::add_rate(Complex rate) {
  modes_.push_back({.pole = std::exp(rate / sample_rate_), .left = 1.0, .right = 1.0});
  rates_.push_back(rate);
  contact_.push_back(0.0);
}

// Of poles that decay by a third over the record: on the axis the sum of one has no end.
void TransientFit::add_sensors(std::span<const double> lines) {
  const double decay = 0.3 * grid_.spacing / (2.0 * std::numbers::pi);
  add_rate(-decay);
  for (const double line : lines) add_rate({-decay, 2.0 * std::numbers::pi * line});
}

TransientFit TransientFit::with_near_poles(double step) const {
  TransientFit fit = *this;
  for (std::size_t n = 0; n < modes_.size(); ++n) {
    fit.modes_.push_back(modes_[n]);
    fit.modes_.back().pole *= std::exp(step / sample_rate_);
    fit.rates_.push_back(rates_[n] + step);
    fit.contact_.push_back(contact_[n]);
  }
  return fit;
}

// a e^{λt} + b e^{(λ + ε)t} is (a + b) e^{(λ + δ)t} with δ = ε b/(a + b), as long as δ and ε are
// small over the record. The coefficient of a column is that of a decay times 1 − e^{λT}, by which
// its wrapped sum is larger. A mode that the record does not show tells no pole.
void TransientFit::move_poles(double step, const Workspace& workspace) {
  const double duration = 2.0 * std::numbers::pi / grid_.spacing;
  for (std::size_t n = 0; n < modes_.size(); ++n) {
    const Complex own = workspace.decay(n) / (1.0 - std::exp(rates_[n] * duration));
    const Complex near =
        workspace.decay(modes_.size() + n) / (1.0 - std::exp((rates_[n] + step) * duration));
    const Complex moved = step * near / (own + near);
    if (!(std::abs(moved) <= kMostMoved * std::abs(step))) continue;
    rates_[n] += moved;
    modes_[n].pole = std::exp(rates_[n] / sample_rate_);
  }
}

// What the decays leave of one reaction below bin `bins`, before their poles move on.
double TransientFit::ringing_step(const Setting& setting, std::size_t side,
                                  std::span<const Complex> spectrum, std::size_t bins,
                                  Workspace& workspace) {
  const double step = -kNearPole * grid_.spacing / (2.0 * std::numbers::pi);
  grid_.bins = bins;
  std::vector<Complex> left(spectrum.begin(), spectrum.begin() + static_cast<Index>(bins));
  Spectra one;
  one[side] = left;
  with_near_poles(step).subtract(setting, one, workspace);
  move_poles(step, workspace);
  double sum = 0.0;
  for (std::size_t k = 1; k < bins; ++k) sum += std::norm(left[k]);
  return sum / (static_cast<double>(bins - 1) * setting.noise_variance[side]);
}

double TransientFit::ringing_misfit(Setting setting, std::size_t side,
                                    std::span<const Complex> spectrum, std::size_t bins,
                                    std::span<const double> lines, Workspace& workspace) const {
  const std::vector<double> no_force(bins, 0.0);
  setting.prior = no_force;
  setting.noise_variance[1 - side] = 0.0;
  // Few modes tell most of what is driven. Those next above them reach into their band.
  if (modes_.size() > 2 * kFirstModes) {
    TransientFit few = *this;
    few.modes_.resize(kFirstModes + kFirstModes / 2);
    few.rates_.resize(few.modes_.size());
    few.contact_.resize(few.modes_.size());
    few.add_sensors(lines);
    const double top = rates_[kFirstModes].imag() / grid_.spacing;
    const double misfit = few.ringing_step(
        setting, side, spectrum, std::min(static_cast<std::size_t>(top) + 1, bins), workspace);
    if (misfit > kMostRinging) return misfit;
  }
  TransientFit fit = *this;
  fit.add_sensors(lines);
  double least = std::numeric_limits<double>::infinity();
  for (bool falls = true; falls;) {
    const double misfit = fit.ringing_step(setting, side, spectrum, bins, workspace);
    falls = misfit < 0.5 * least && misfit > kRingsByItself;
    least = std::min(least, misfit);
  }
  return least;
}

// What they do at the contact; their velocity is Re(λ_n c_n exp(λ_n t)).
std::vector<RingingMode> TransientFit::moving(bool velocity) const {
  std::vector<RingingMode> modes = modes_;
  for (std::size_t n = 0; n < modes.size(); ++n) {
    modes[n].own = velocity ? contact_[n] * rates_[n] : contact_[n];
  }
  return modes;
}

void TransientFit::add_motion(bool velocity, std::size_t first, std::span<Complex> spectrum,
                              const Workspace& workspace) const {
  std::vector<RingingMode> modes = moving(velocity);
  for (std::size_t n = 0; n < modes.size(); ++n) {
    modes[n].left = 1.0;
    modes[n].own *= workspace.decay(n);
  }
  add_up(modes, first, [&](std::size_t k, Complex sum, Complex) { spectrum[k] += sum; });
}

// Gives take(k, left, right) the sums over the decays of every bin from `first` on.
template <typename Take>
void TransientFit::add_up(std::span<const RingingMode> modes, std::size_t first, Take take) const {
  constexpr std::size_t kBins = kColumnLength / 2;
  PlanarVector delay(kBins);
  for (std::size_t begin = first; begin < grid_.bins; begin += kBins) {
    const std::size_t count = std::min(kBins, grid_.bins - begin);
    for (std::size_t i = 0; i < count; ++i) delay.set(i, delay_of(begin + i));
    PlanarVector left(kBins), right(kBins);
    add_ringing(modes, delay, left, right);
    for (std::size_t i = 0; i < count; ++i) take(begin + i, left.at(i), right.at(i));
  }
}

}  // namespace modcal
