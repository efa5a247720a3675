#include "libsim/dynamics/event/sliding/sliding_model.hpp"

#include "libsim/dynamics/event/sliding/tuning.hpp"

namespace modcal::event {
namespace {

using Complex = std::complex<double>;

// Weight of Z in the contact velocity: v = Re Σ a Z, a = 1 + iζω/ω_d.
Complex velocity_weight(const ContactModes& modes, std::size_t n) {
  return {1.0, modes.quadrature[n]};
}

// φ_1 … φ_count at x by the Taylor series of the highest and the downward recursion, |x| ≤ 1.3.
std::array<Complex, kMaxNodes + 1> phi_functions(Complex x, int count) {
  std::array<Complex, kMaxNodes + 1> phi{};
  Complex term = 1.0 / std::tgamma(count + 1.0);
  for (int p = 1; p < 30; ++p) {
    phi[count] += term;
    term *= x / static_cast<double>(count + p);
  }
  for (int k = count; k-- > 0;) phi[k] = x * phi[k + 1] + 1.0 / std::tgamma(k + 1.0);
  return phi;
}

}  // namespace

SlidingModel::SlidingModel(const ContactModes& modes, const LobattoRule& rule, double grid_step)
    : rule_(rule),
      modes_(modes.size()),
      effective_mass_(modes.effective_mass()),
      grid_step_(grid_step),
      series_step_(grid_step),
      pole_(modes_),
      drive_(padded_size(modes_)),
      derivative_weight_(padded_size(modes_)),
      observed_(kRows, modes_),
      series_(kSeriesTerms, modes_),
      free_factor_(modes_) {
  for (std::size_t n = 0; n < modes_; ++n) {
    pole_.set(n, modes.pole[n]);
    drive_[n] = modes.drive[n];
    largest_pole_ = std::max(largest_pole_, std::abs(modes.pole[n]));
    derivative_weight_[n] =
        std::abs(velocity_weight(modes, n)) * std::pow(std::abs(modes.pole[n]), rule_.nodes);
    free_factor_.set(n, std::exp(modes.pole[n] * grid_step));
  }
  while (series_step_ * largest_pole_ > kSlidingPhase) {
    series_step_ *= 0.5;
    ++first_level_;
  }
  fill_observed(modes);
  fill_series(modes);
}

void SlidingModel::fill_observed(const ContactModes& modes) {
  for (std::size_t n = 0; n < modes_; ++n) {
    // Re(w Z) with w = −i g is g Im Z.
    observed_.set(kVelocity, n, velocity_weight(modes, n));
    observed_.set(kDisplacement, n, {0.0, -modes.compliance[n]});
    observed_.set(kLeft, n, std::conj(modes.left_gain[n]));
    observed_.set(kRight, n, std::conj(modes.right_gain[n]));
  }
}

void SlidingModel::fill_series(const ContactModes& modes) {
  Series moments{};
  for (std::size_t n = 0; n < modes_; ++n) {
    const Complex x = modes.pole[n] * series_step_;
    Complex term = velocity_weight(modes, n);
    Complex power = series_step_ * modes.drive[n] * velocity_weight(modes, n);
    for (std::size_t p = 0; p < kSeriesTerms; ++p) {
      series_.set(p, n, term);
      moments[p] += power.real();
      term *= x / static_cast<double>(p + 1);
      power *= x;
    }
  }
  for (int k = 0; k < rule_.nodes; ++k) {
    double factor = 1.0 / (k + 1.0);  // k!/(p + k + 1)!
    for (std::size_t p = 0; p < kSeriesTerms; ++p) {
      moment_[k][p] = moment_table_[p][k] = factor * moments[p];
      factor /= static_cast<double>(p) + k + 2.0;
    }
  }
}

void SlidingModel::free_series(const PlanarVector& state, Series& out) const {
  modal_kernels().real_products(series_, state, out);
}

NodeMatrix SlidingModel::coupling(double ratio) const {
  const int nodes = rule_.nodes;
  std::array<double, 4> x{};
  for (int i = 1; i < nodes; ++i) x[i - 1] = ratio * rule_.node[i];
  std::array<Octet, 4> sum;
  modal_kernels().polynomials(moment_table_, x, sum);
  NodeMatrix result{};
  for (int i = 1; i < nodes; ++i) {
    double power = ratio * rule_.node[i];
    for (int k = 0; k < nodes; ++k) {
      const double response = power * sum[i - 1][k];  // velocity at c_i due to θ^k
      power *= rule_.node[i];
      for (int j = 0; j < nodes; ++j) result[i][j] += rule_.power[j][k] * response;
    }
  }
  return result;
}

void SlidingModel::add_forced_series(double ratio, const NodeVector& force, Series& out) const {
  double scale = ratio;
  for (std::size_t p = 0; p < kSeriesTerms; ++p) {
    for (int k = 0; k < rule_.nodes; ++k) {
      const std::size_t m = p + static_cast<std::size_t>(k) + 1;
      if (m < kSeriesTerms) out[m] += force[k] * moment_[k][p] * scale;
    }
    scale *= ratio;
  }
}

void SlidingModel::advance_any(double ratio, double theta, const NodeVector& force,
                               PlanarVector& state) const {
  const double time = theta * ratio * series_step_;
  NodeVector weight{};
  double factor = time;  // t k! θ^k
  for (int k = 0; k < rule_.nodes; ++k) {
    weight[k] = factor * force[k];
    factor *= theta * (k + 1);
  }
  modal_kernels().advance_driven_by(time, largest_pole_ * time, pole_, drive_,
                                    std::span(weight).first(static_cast<std::size_t>(rule_.nodes)),
                                    state);
}

void SlidingModel::advance_free(PlanarVector& state) {
  modal_kernels().advance(free_factor_, pole_, state, state, {}, {});
}

void SlidingModel::advance_free_by(double time, PlanarVector& state) {
  modal_kernels().advance_by(time, pole_, state, state);
}

double SlidingModel::free_derivative_bound(const PlanarVector& state) const {
  return modal_kernels().weighted_size(derivative_weight_, state);
}

MotionSample SlidingModel::observe(const PlanarVector& state, MotionRequest wanted) const {
  std::array<double, kRows> row{};
  std::size_t rows = wanted.contact ? std::size_t{kLeft} : 0;
  if (wanted.reactions) rows = kRows;
  modal_kernels().real_products(observed_, state, std::span(row).first(rows));
  return {.displacement = row[kDisplacement],
          .velocity = row[kVelocity],
          .left = row[kLeft],
          .right = row[kRight]};
}

SlidingTable SlidingModel::make_table(double step) const {
  const int nodes = rule_.nodes;
  const double ratio = step / series_step_;
  SlidingTable table;
  table.step = step;
  table.rows = PlanarRows(static_cast<std::size_t>(nodes - 1), modes_);
  table.response = PlanarRows(static_cast<std::size_t>(nodes), modes_);
  table.factor = PlanarVector(modes_);
  table.coupling = coupling(ratio);
  for (std::size_t n = 0; n < modes_; ++n) {
    const Complex pole = pole_.at(n);
    const Complex weight{observed_.re(kVelocity)[n], observed_.im(kVelocity)[n]};
    for (int i = 1; i < nodes; ++i) {
      table.rows.set(static_cast<std::size_t>(i - 1), n,
                     weight * std::exp(pole * (rule_.node[i] * step)));
    }
    const auto phi = phi_functions(pole * step, nodes);
    table.factor.set(n, std::exp(pole * step));
    for (int j = 0; j < nodes; ++j) {
      Complex response = 0.0;
      double factorial = 1.0;
      for (int k = 0; k < nodes; ++k) {
        response += rule_.power[j][k] * factorial * phi[k + 1];
        factorial *= k + 1;
      }
      table.response.set(static_cast<std::size_t>(j), n, drive_[n] * step * response);
    }
  }
  table.free_remainder = rule_.remainder * std::pow(step, nodes);
  for (int k = 0; k < nodes; ++k) {
    double scale = ratio;
    for (std::size_t p = 0; p < kSeriesTerms; ++p) {
      table.forced_remainder[k] +=
          std::abs(moment_[k][p]) * scale * rule_.power_remainder(static_cast<int>(p) + k + 1);
      scale *= ratio;
    }
  }
  return table;
}

const SlidingTable& SlidingModel::table(int level) {
  const auto index = static_cast<std::size_t>(level);
  if (tables_.size() <= index) tables_.resize(index + 1);
  if (!tables_[index]) {
    tables_[index] = std::make_unique<SlidingTable>(make_table(std::ldexp(grid_step_, -level)));
  }
  return *tables_[index];
}

}  // namespace modcal::event
