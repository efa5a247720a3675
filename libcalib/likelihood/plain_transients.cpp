#include "libcalib/likelihood/plain_transients.hpp"

#include <cmath>

#include "libcalib/likelihood/kernels/decay_kernel.hpp"

namespace modcal {
namespace {

// Powers of s at either end: as many as go with the residual and a sensor's decay.
constexpr std::size_t smooth_powers() { return (kDecayColumns - 2) / 2; }

// What modes above the band leave ringing is smooth in it: powers of iω/ω_top.
void add_smooth_transients(const WhitenedRecord& record, std::vector<PlainTransient>& transients) {
  const double top = record.omega[record.bins - 1];
  for (const bool right : {false, true}) {
    std::vector<Complex> numbers(record.bins, record.deviation[right ? 1 : 0]);
    for (std::size_t power = 0; power < smooth_powers(); ++power) {
      transients.push_back({right, PlanarVector(record.root_weight.size())});
      for (std::size_t k = 0; k < record.bins; ++k) {
        transients.back().numbers.set(k, numbers[k]);
        numbers[k] *= Complex(0.0, record.omega[k] / top);
      }
    }
  }
}

// One sample, which smooth transients hold already, and the sensor's own decay.
void add_sensor_transients(const WhitenedRecord& record, const Sensor& sensors,
                           std::vector<PlainTransient>& transients) {
  const std::size_t padded = record.root_weight.size();
  PlainTransient sample{true, PlanarVector(padded)};
  PlainTransient decay{true, PlanarVector(padded)};
  PlanarVector& by_corner = decay.by_sensor[Sensor::kCorner] = PlanarVector(padded);
  const double pole = std::exp(-sensors.corner / record.sample_rate);
  for (std::size_t k = 0; k < record.bins; ++k) {
    sample.numbers.set(k, record.deviation[1]);
    const Complex u = 1.0 / (1.0 - pole * record.delay.at(k));
    decay.numbers.set(k, record.deviation[1] * u);
    // dU/dE = U² z^−1 and E U z^−1 = U − 1.
    by_corner.set(k, record.deviation[1] * u * (1.0 - u) / record.sample_rate);
  }
  if (transients.empty()) transients.push_back(std::move(sample));
  transients.push_back(std::move(decay));
}

void add_lines(const WhitenedRecord& record, std::vector<PlainTransient>& transients) {
  if (!record.waves) return;
  for (const LineWaves& waves : *record.waves) {
    for (const bool right : {false, true}) {
      for (const PlanarVector& wave : waves) transients.push_back({right, wave});
    }
  }
}

// The residual takes what is at x = L from the record, and adds what is at x = 0.
void add_signals(const WhitenedRecord& record, std::vector<PlainTransient>& transients) {
  for (const SignalColumn& signal : record.signals) {
    PlanarVector left(record.root_weight.size()), right(record.root_weight.size());
    for (std::size_t k = 0; k < record.bins; ++k) {
      left.set(k, -record.deviation[0] * signal.left.at(k));
      right.set(k, record.deviation[1] * signal.right.at(k));
    }
    transients.push_back({true, std::move(right), std::move(left)});
  }
}

}  // namespace

std::vector<PlainTransient> plain_transients(const WhitenedRecord& record,
                                             const ModelPoint& point) {
  std::vector<PlainTransient> transients;
  if (record.sigma > 0.0) {
    transients = {{false, record.offset}, {true, record.offset}};
  } else {
    if (point.higher) add_smooth_transients(record, transients);
    if (point.sensors.may_differ()) add_sensor_transients(record, point.sensors, transients);
  }
  add_lines(record, transients);
  add_signals(record, transients);
  return transients;
}

}  // namespace modcal
