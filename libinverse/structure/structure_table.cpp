#include "libinverse/structure/structure_table.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libinverse/structure/structure_record.hpp"
#include "libinverse/structure/tuning.hpp"
#include "libsim/base/error.hpp"

namespace modcal {

double StructureTable::frequency(std::size_t n) const {
  return model.poles[n].omega / (2.0 * std::numbers::pi);
}

StructureTable StructureTable::without_sensor(std::size_t k) const {
  StructureTable table = *this;
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < model.sensors.size(); ++i) {
    if (i != k) kept.push_back(i);
  }
  table.model = model.with_sensors(kept);
  const auto drop = [k](auto& of_sensors) {
    if (!of_sensors.empty()) of_sensors.erase(of_sensors.begin() + static_cast<std::ptrdiff_t>(k));
  };
  drop(table.names);
  drop(table.scatters);
  drop(table.measured.sensors);
  for (Transfers& session : table.measured.sessions) drop(session);
  drop(table.measured.random);
  drop(table.measured.scatter);
  return table;
}

void StructureTable::require_modes(std::string_view what) const {
  MODCAL_REQUIRE(measured.empty(),
                 "{} needs modes, measured functions have none: fit modes to them (kind: fit_modes "
                 "with functions:)",
                 what);
}

void StructureTable::take_pulse(const StructureRecord& strike) {
  const std::vector<double>& force = strike.force;
  const auto larger = [](double a, double b) { return std::abs(a) < std::abs(b); };
  const auto peak = std::max_element(force.begin(), force.end(), larger) - force.begin();
  const auto reach = static_cast<std::ptrdiff_t>(10.0 * strike.sample_rate / high);
  const RealFft fft(static_cast<std::size_t>(4 * reach));
  std::vector<double> around(fft.length(), 0.0);
  for (std::ptrdiff_t j = -reach; j <= reach; ++j) {
    if (peak + j < 0 || peak + j >= std::ssize(force)) continue;
    const double fading = std::cos(0.5 * std::numbers::pi * static_cast<double>(j) /
                                   (static_cast<double>(reach) + 1.0));
    around[static_cast<std::size_t>(j + reach)] =
        fading * fading * force[static_cast<std::size_t>(peak + j)];
  }
  const std::vector<Complex> spectrum = fft.forward(around);
  lag = strike.sample_rate / static_cast<double>(fft.length());
  pulse.clear();
  for (const Complex& g : spectrum) {
    pulse.push_back(std::abs(g) / std::max(std::abs(spectrum[0]), 1e-300));
  }
}

double StructureTable::pulse_at(double frequency) const {
  if (pulse.empty()) {
    const double above = std::clamp(4.0 * (frequency / high - 1.0), 0.0, 1.0);
    const double fading = std::cos(0.5 * std::numbers::pi * above);
    return fading * fading;
  }
  const double at = frequency / lag;
  const auto i = static_cast<std::size_t>(at);
  if (i + 1 >= pulse.size()) return pulse.back();
  const double share = at - static_cast<double>(i);
  return (1.0 - share) * pulse[i] + share * pulse[i + 1];
}

StructureChange StructureChange::open() {
  StructureChange change{.is_found = true};
  change.frequency *= kFirstChange;
  change.damping *= kFirstChange;
  change.residue *= kFirstChange;
  return change;
}

bool StructureChange::is_at_bound(double StructureChange::*size) const {
  // The last step of the search may have been a tenth.
  constexpr double next_to = 0.85;
  return is_found && this->*size >= next_to * kMostChange * (StructureChange().*size);
}

double modal_power(const ModalModel& model, std::size_t pair, Complex s) {
  const SensorKind kind = model.sensors[pair / model.contacts];
  double sum = 0.0;
  for (std::size_t n = 0; n < model.poles.size(); ++n) {
    const ModalPole& pole = model.poles[n];
    const Complex constant(
        model.constant(pair, n),
        model.quadrature.empty() ? 0.0 : model.quadrature[pair * model.poles.size() + n]);
    sum += std::norm(numerator_of(kind, pole, constant, s) / pole.denominator(s));
  }
  return sum;
}

ModalModel with_quadrature(ModalModel model) {
  model.quadrature.resize(model.constants.size());
  return model;
}

ModalModel moved_by(const ModalModel& table, const Eigen::VectorXd& theta) {
  ModalModel model = with_quadrature(table);
  const std::size_t modes = model.poles.size();
  Eigen::Index i = 0;
  for (ModalPole& pole : model.poles) {
    pole.omega *= std::exp(theta[i]);
    pole.zeta = std::min(0.9, pole.zeta * std::exp(theta[i + 1]));
    i += 2;
  }
  for (std::size_t j = 0; i < theta.size() && j < modes * model.sensors.size(); ++j, i += 2) {
    const Complex constant =
        Complex(model.constants[j], model.quadrature[j]) * Complex(1.0 + theta[i], theta[i + 1]);
    model.constants[j] = constant.real();
    model.quadrature[j] = constant.imag();
  }
  return model;
}

Eigen::VectorXd deviations_of(const StructureChange& change, const ModalModel& table) {
  const std::size_t modes = table.poles.size(), sensors = table.sensors.size();
  const bool factors = change.residue > 0.0;
  Eigen::VectorXd sd = Eigen::VectorXd::Constant(
      static_cast<Eigen::Index>(2 * modes * (factors ? 1 + sensors : 1)), change.residue);
  for (std::size_t n = 0; n < modes; ++n) {
    sd.segment<2>(static_cast<Eigen::Index>(2 * n)) << change.frequency, change.damping;
  }
  const auto size = [&](std::size_t k, std::size_t n) {
    const std::size_t j = k * modes + n;
    return std::hypot(table.constants[j], table.quadrature.empty() ? 0.0 : table.quadrature[j]);
  };
  // Of mode n, rms over the sensors of one kind.
  const auto typical = [&](std::size_t k, std::size_t n) {
    double squares = 0.0, alike = 0.0;
    for (std::size_t other = 0; other < sensors; ++other) {
      if (table.sensors[other] != table.sensors[k]) continue;
      squares += std::pow(size(other, n), 2);
      alike += 1.0;
    }
    return std::sqrt(squares / alike);
  };
  for (std::size_t k = 0; factors && k < sensors; ++k) {
    for (std::size_t n = 0; n < modes; ++n) {
      const double usual = typical(k, n), own = size(k, n);
      if (!(own > 0.0)) continue;
      double variance = std::pow(change.residue * std::max(1.0, usual / own), 2);
      for (std::size_t m = 0; change.coupling > 0.0 && m < modes; ++m) {
        if (m == n) continue;
        const double a = table.poles[n].omega, b = table.poles[m].omega;
        const double turned =
            std::min(1.0, change.coupling * change.frequency * std::sqrt(a * b) / std::abs(a - b));
        // φ_kn φ_cn + …: of the sensor's φ_km φ_cn, of the contact's φ_kn φ_cm.
        variance +=
            turned * turned * (std::pow(usual / own, 2) + std::pow(typical(k, m) / usual, 2));
      }
      sd.segment<2>(static_cast<Eigen::Index>(2 * (modes + k * modes + n)))
          .setConstant(std::sqrt(variance));
    }
  }
  return sd;
}

}  // namespace modcal
