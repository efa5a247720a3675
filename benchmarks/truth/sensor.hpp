// How the sensor at x = L reads.
#pragma once

#include <cstddef>
#include <vector>

namespace modcal::truth {

/// Second-order section b₀ + b₁/z + b₂/z² over 1 + a₁/z + a₂/z² of (n₀ + n₁s + n₂s²)/(d₀ + d₁s +
/// d₂s²) with s = 2 rate (1 − 1/z)/(1 + 1/z).
class Section {
 public:
  Section(const double (&numerator)[3], const double (&denominator)[3], double rate);
  double filter(double sample);
  /// The state that a constant has led to; its answer.
  double settle(double constant);

 private:
  double b_[3], a_[3], x_[2] = {}, y_[2] = {};
};

/// Gain, delay (linear between samples), corner and resonance, in this order (TruthMismatch). What
/// came before the first sample is taken to be equal to it.
class TruthSensor {
 public:
  struct Numbers {
    double gain, delay, corner, body_peak, body_frequency, body_damping;
  };
  /// Throws std::invalid_argument for a negative delay, corner or resonance.
  TruthSensor(const Numbers& numbers, double rate);
  double read(double force);

 private:
  double gain_, part_ = 0.0;
  std::vector<double> line_;  ///< ring of the last samples
  std::size_t at_ = 0;
  std::vector<Section> sections_;
  bool started_ = false;
};

}  // namespace modcal::truth
