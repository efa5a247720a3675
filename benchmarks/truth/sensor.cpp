#include "benchmarks/truth/sensor.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace modcal::truth {

Section::Section(const double (&numerator)[3], const double (&denominator)[3], double rate) {
  const double c = 2.0 * rate;
  const auto mapped = [c](const double(&p)[3], double(&out)[3]) {
    out[0] = p[0] + p[1] * c + p[2] * c * c;
    out[1] = 2.0 * p[0] - 2.0 * p[2] * c * c;
    out[2] = p[0] - p[1] * c + p[2] * c * c;
  };
  mapped(numerator, b_);
  mapped(denominator, a_);
  for (int i = 2; i >= 0; --i) {
    b_[i] /= a_[0];
    a_[i] /= a_[0];
  }
}

double Section::filter(double sample) {
  const double y = b_[0] * sample + b_[1] * x_[0] + b_[2] * x_[1] - a_[1] * y_[0] - a_[2] * y_[1];
  x_[1] = x_[0];
  x_[0] = sample;
  y_[1] = y_[0];
  y_[0] = y;
  return y;
}

double Section::settle(double constant) {
  const double y = constant * (b_[0] + b_[1] + b_[2]) / (a_[0] + a_[1] + a_[2]);
  x_[0] = x_[1] = constant;
  y_[0] = y_[1] = y;
  return y;
}

TruthSensor::TruthSensor(const Numbers& n, double rate) : gain_(n.gain) {
  if (!(n.delay >= 0.0) || !(n.corner >= 0.0) || !(n.body_frequency > 0.0) ||
      !(n.body_damping > 0.0)) {
    throw std::invalid_argument(
        "sensor: delay and corner >= 0, frequency and damping of the resonance > 0");
  }
  const double samples = n.delay * rate;
  part_ = samples - std::floor(samples);
  line_.resize(static_cast<std::size_t>(std::floor(samples)) + 2);
  const double corner = 2.0 * std::numbers::pi * n.corner;
  if (corner > 0.0) sections_.push_back(Section({0.0, 1.0, 0.0}, {corner, 1.0, 0.0}, rate));
  if (n.body_peak != 0.0) {
    const double omega = 2.0 * std::numbers::pi * n.body_frequency;
    const double loss = 2.0 * n.body_damping * omega;
    sections_.push_back(Section({omega * omega, loss * (1.0 + n.body_peak), 1.0},
                                {omega * omega, loss, 1.0}, rate));
  }
}

double TruthSensor::read(double force) {
  if (!started_) {
    line_.assign(line_.size(), force);
    double settled = gain_ * force;
    for (Section& section : sections_) settled = section.settle(settled);
    started_ = true;
  }
  line_[at_] = force;
  const std::size_t size = line_.size();
  // The oldest sample is floor(delay) + 1 steps old, the next one floor(delay).
  const std::size_t oldest = (at_ + 1) % size, next = (at_ + 2) % size;
  at_ = oldest;
  double value = gain_ * ((1.0 - part_) * line_[next] + part_ * line_[oldest]);
  for (Section& section : sections_) value = section.filter(value);
  return value;
}

}  // namespace modcal::truth
