#include "benchmarks/problems/known_structures.hpp"

#include <algorithm>
#include <cmath>

#include "libsim/base/random.hpp"
#include "libsim/base/turn.hpp"

namespace modcal::known_structures {
namespace {

std::vector<Complex> force_spectrum(const FrequencyGrid& grid, bool impact) {
  std::vector<double> normal(2 * grid.bins);
  fill_standard_normal(StreamKey(11).with("force"), normal);
  std::vector<Complex> force(grid.bins);
  for (std::size_t i = 1; i < force.size(); ++i) {
    const double at = grid.omega(i) / kTurn;
    if (at < 5.0 || at > 600.0) continue;
    force[i] = 100.0 * Complex(normal[2 * i], normal[2 * i + 1]);
    if (!impact) continue;
    // Of 8 ms at 2.4 s, as high as ten times the rest.
    const double width = 0.002;
    force[i] += 100.0 * std::exp(-0.5 * std::pow(grid.omega(i) * width, 2)) *
                std::exp(Complex(0.0, -grid.omega(i) * 2.4));
  }
  return force;
}

}  // namespace

ModalModel six_modes(std::size_t sensors) {
  const std::vector<double> frequencies = {47.0, 88.0, 161.0, 171.0, 256.0, 372.0};
  const std::vector<double> ratios = {0.01, 0.008, 0.006, 0.007, 0.005, 0.004};
  const std::vector<SensorKind> kinds = {SensorKind::kAcceleration, SensorKind::kVelocity,
                                         SensorKind::kDisplacement};
  ModalModel model{
      .sensors = {kinds.begin(), kinds.begin() + static_cast<std::ptrdiff_t>(sensors)}};
  for (std::size_t n = 0; n < 6; ++n) model.poles.push_back({kTurn * frequencies[n], ratios[n]});
  for (std::size_t k = 0; k < sensors; ++k) {
    for (std::size_t n = 0; n < 6; ++n) {
      const double at = static_cast<double>((n + 1) * (k + 2));
      model.constants.push_back(std::cos(0.9 * at));
      model.quadrature.push_back(0.2 * std::sin(1.7 * at));
    }
  }
  return model;
}

ModalModel plate() {
  constexpr double kLength = 1.0, kWidth = 0.72, kScale = 6.85;  // sides and f a², [Hz]
  struct Shape {
    double frequency, p, q;
    double at(double x, double y) const {
      return std::sin(0.5 * kTurn * p * x / kLength) * std::sin(0.5 * kTurn * q * y / kWidth);
    }
  };
  std::vector<Shape> shapes;
  for (int across = 1; across < 12; ++across) {
    for (int along = 1; along < 12; ++along) {
      const double p = across, q = along;
      const double frequency = kScale * (std::pow(p / kLength, 2) + std::pow(q / kWidth, 2));
      if (frequency < 390.0) shapes.push_back({frequency, p, q});
    }
  }
  std::ranges::sort(shapes, {}, &Shape::frequency);
  ModalModel model{.sensors = std::vector<SensorKind>(4, SensorKind::kAcceleration)};
  for (std::size_t n = 0; n < shapes.size(); ++n) {
    const double ratio = 0.003 + 0.005 * std::pow(std::sin(1.3 * static_cast<double>(n)), 2);
    model.poles.push_back({kTurn * shapes[n].frequency, ratio});
  }
  constexpr double kStruck[2] = {0.37, 0.31};
  constexpr double kSensors[4][2] = {{0.11, 0.13}, {0.83, 0.21}, {0.61, 0.57}, {0.23, 0.46}};
  for (const auto& sensor : kSensors) {
    for (const Shape& shape : shapes) {
      const double constant = shape.at(sensor[0], sensor[1]) * shape.at(kStruck[0], kStruck[1]);
      model.constants.push_back(constant);
      model.quadrature.push_back(0.1 * constant * std::cos(shape.frequency));
    }
  }
  return model;
}

StructureRecord clean_record(const ModalModel& model, bool impact) {
  const auto long_count = static_cast<std::size_t>(6.0 * kRate),
             count = static_cast<std::size_t>(kRate);
  const RealFft fft(long_count);
  const FrequencyGrid grid = FrequencyGrid::of_record(long_count, kRate);
  const std::vector<Complex> force = force_spectrum(grid, impact);
  const auto middle = [&](std::vector<Complex> spectrum) {
    std::vector<double> samples(long_count);
    fft.inverse(spectrum, samples);
    return std::vector<double>(samples.begin() + 2 * static_cast<std::ptrdiff_t>(count),
                               samples.begin() + 3 * static_cast<std::ptrdiff_t>(count));
  };
  StructureRecord record{.sample_rate = kRate, .force = middle(force)};
  for (const std::vector<Complex>& transfer : model.transfer(grid)) {
    std::vector<Complex> spectrum = force;
    for (std::size_t i = 0; i < spectrum.size(); ++i) spectrum[i] *= transfer[i];
    record.responses.push_back(middle(spectrum));
  }
  return record;
}

BinVariances Noisy::variances(const ContourSpectra& spectra) const {
  BinVariances result;
  for (const double sd : noise) {
    result.of.emplace_back(spectra.count(), sd * sd * spectra.noise_power());
  }
  return result;
}

Noisy with_noise(StructureRecord record, double level, std::uint64_t seed) {
  Noisy noisy{.record = std::move(record)};
  std::size_t k = 0;
  for (std::vector<double>& response : noisy.record.responses) {
    double power = 0.0;
    for (const double x : response) power += x * x / static_cast<double>(response.size());
    std::vector<double> normal(response.size());
    fill_standard_normal(StreamKey(seed).with("noise").with(k++), normal);
    const double sd = level * std::sqrt(power);
    for (std::size_t j = 0; j < response.size(); ++j) response[j] += sd * normal[j];
    noisy.noise.push_back(sd);
  }
  return noisy;
}

ModalModel started_off(ModalModel model, std::uint64_t seed, double frequency, double damping) {
  std::vector<double> normal(2 * model.poles.size());
  fill_standard_normal(StreamKey(seed).with("start"), normal);
  // Between −1 and 1, by the normal distribution's own function.
  const auto uniform = [&normal](std::size_t i) { return std::erf(normal[i] / std::sqrt(2.0)); };
  for (std::size_t n = 0; n < model.poles.size(); ++n) {
    model.poles[n].omega *= 1.0 + frequency * uniform(2 * n);
    model.poles[n].zeta *= 1.0 + damping * uniform(2 * n + 1);
  }
  return model;
}

ModalModel with_wrong_residues(ModalModel model, std::uint64_t seed, double deviation) {
  std::vector<double> normal(2 * model.constants.size());
  fill_standard_normal(StreamKey(seed).with("residues"), normal);
  model.quadrature.resize(model.constants.size());
  for (std::size_t i = 0; i < model.constants.size(); ++i) {
    const Complex wrong = Complex(model.constants[i], model.quadrature[i]) *
                          Complex(1.0 + deviation * normal[2 * i], deviation * normal[2 * i + 1]);
    model.constants[i] = wrong.real();
    model.quadrature[i] = wrong.imag();
  }
  return model;
}

Eigen::VectorXd logarithms(const ModalModel& model) {
  Eigen::VectorXd result(2 * std::ssize(model.poles));
  for (std::size_t n = 0; n < model.poles.size(); ++n) {
    const auto i = static_cast<Eigen::Index>(2 * n);
    result[i] = std::log(model.poles[n].omega);
    result[i + 1] = std::log(model.poles[n].zeta);
  }
  return result;
}

}  // namespace modcal::known_structures
