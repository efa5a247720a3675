// Standard problems with known answers.
#pragma once

#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "libcalib/problem/objective_function.hpp"

namespace modcal {

/// A function of two variables given by residuals: value ½ ‖r‖², all outputs.
class LeastSquaresProblem : public ObjectiveFunction {
 public:
  std::string_view name() const override { return "least_squares_problem"; }
  std::size_t dimension() const override { return 2; }
  std::size_t residual_count() const override { return 2; }
  Capabilities capabilities() const override { return {.gradient = true, .least_squares = true}; }
  mutable std::atomic<int> calls = 0;

 protected:
  virtual std::array<double, 2> residuals(double x, double y) const = 0;
  virtual std::array<double, 4> jacobian(double x, double y) const = 0;

 private:
  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    ++calls;
    const auto r = residuals(x[0], x[1]);
    const auto j = jacobian(x[0], x[1]);
    if (outputs.value) *outputs.value = 0.5 * (r[0] * r[0] + r[1] * r[1]);
    for (std::size_t i = 0; i < 2; ++i) {
      if (outputs.gradient) outputs.gradient[i] = j[i] * r[0] + j[2 + i] * r[1];
      if (outputs.residuals) outputs.residuals[i] = r[i];
    }
    if (outputs.jacobian) std::copy(j.begin(), j.end(), outputs.jacobian);
  }
};

/// ½ ((x − 3)² + 4 (y + 1)²), minimum 0 at (3, −1).
class Quadratic final : public LeastSquaresProblem {
  std::array<double, 2> residuals(double x, double y) const override {
    return {x - 3.0, 2.0 * (y + 1.0)};
  }
  std::array<double, 4> jacobian(double /*x*/, double /*y*/) const override {
    return {1.0, 0.0, 0.0, 2.0};
  }
};

/// Half of Rosenbrock's (1960) function, minimum 0 at (1, 1).
class Rosenbrock final : public LeastSquaresProblem {
  std::array<double, 2> residuals(double x, double y) const override {
    return {1.0 - x, 10.0 * (y - x * x)};
  }
  std::array<double, 4> jacobian(double x, double /*y*/) const override {
    return {-1.0, 0.0, -20.0 * x, 10.0};
  }
};

/// Powell's (1970) badly scaled function, minimum 0 at (1.098159e-5, 9.106147) (Moré, Garbow and
/// Hillstrom, 1981, problem 3), here with all digits, by Newton's method in 40.
class PowellBadlyScaled final : public LeastSquaresProblem {
 public:
  static constexpr double kX = 1.0981593296998175e-5;
  static constexpr double kY = 9.106146739866524;

 private:
  std::array<double, 2> residuals(double x, double y) const override {
    return {1e4 * x * y - 1.0, std::exp(-x) + std::exp(-y) - 1.0001};
  }
  std::array<double, 4> jacobian(double x, double y) const override {
    return {1e4 * y, 1e4 * x, -std::exp(-x), -std::exp(-y)};
  }
};

/// Powell's (1962) singular function, minimum 0 at the origin, where its Hessian is singular.
class PowellSingular final : public ObjectiveFunction {
 public:
  std::string_view name() const override { return "powell_singular"; }
  std::size_t dimension() const override { return 4; }
  std::size_t residual_count() const override { return 4; }
  Capabilities capabilities() const override { return {.gradient = true, .least_squares = true}; }

 private:
  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    const double a = x[1] - 2.0 * x[2];
    const double b = x[0] - x[3];
    const double root5 = std::sqrt(5.0), root10 = std::sqrt(10.0);
    const std::array<double, 4> r = {x[0] + 10.0 * x[1], root5 * (x[2] - x[3]), a * a,
                                     root10 * b * b};
    const std::array<double, 16> j = {1.0,      10.0, 0.0,
                                      0.0,  //
                                      0.0,      0.0,  root5,
                                      -root5,   0.0,  2.0 * a,
                                      -4.0 * a, 0.0,  2.0 * root10 * b,
                                      0.0,      0.0,  -2.0 * root10 * b};
    if (outputs.value) *outputs.value = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
      if (outputs.value) *outputs.value += 0.5 * r[i] * r[i];
      if (outputs.residuals) outputs.residuals[i] = r[i];
      if (outputs.gradient) outputs.gradient[i] = 0.0;
      for (std::size_t k = 0; outputs.gradient && k < 4; ++k) {
        outputs.gradient[i] += j[4 * k + i] * r[k];
      }
    }
    if (outputs.jacobian) std::copy(j.begin(), j.end(), outputs.jacobian);
  }
};

/// Sum of two damped sinusoids A_k exp(−d_k t) sin(ω_k t + φ_k) sampled 200 times over 2 s, fitted
/// in (ω_1, d_1, ω_2, d_2); minimum 0 at the truth below.
class DampedSinusoids final : public ObjectiveFunction {
 public:
  static constexpr std::array<double, 4> kTruth = {12.0, 0.8, 19.0, 1.5};
  std::string_view name() const override { return "damped_sinusoids"; }
  std::size_t dimension() const override { return 4; }
  std::size_t residual_count() const override { return 200; }
  Capabilities capabilities() const override { return {.gradient = true, .least_squares = true}; }

 private:
  static double term(std::span<const double> x, std::size_t k, double t, double quarter) {
    const double amplitude = k == 0 ? 1.0 : 0.7;
    return amplitude * std::exp(-x[2 * k + 1] * t) *
           std::sin(x[2 * k] * t + 0.4 + 0.5 * std::numbers::pi * quarter);
  }
  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    double value = 0.0;
    if (outputs.gradient) std::fill_n(outputs.gradient, 4, 0.0);
    for (std::size_t j = 0; j < 200; ++j) {
      const double t = 0.01 * static_cast<double>(j);
      double r = 0.0;
      for (std::size_t k = 0; k < 2; ++k) r += term(x, k, t, 0.0) - term(kTruth, k, t, 0.0);
      value += 0.5 * r * r;
      if (outputs.residuals) outputs.residuals[j] = r;
      for (std::size_t i = 0; i < 4; ++i) {
        const double slope = i % 2 == 0 ? t * term(x, i / 2, t, 1.0) : -t * term(x, i / 2, t, 0.0);
        if (outputs.jacobian) outputs.jacobian[4 * j + i] = slope;
        if (outputs.gradient) outputs.gradient[i] += slope * r;
      }
    }
    if (outputs.value) *outputs.value = value;
  }
};

/// The outputs of another function, save those that are left out.
class Without final : public ObjectiveFunction {
 public:
  Without(const ObjectiveFunction& function, Capabilities kept)
      : function_(function), kept_(kept) {}
  std::string_view name() const override { return "without"; }
  std::size_t dimension() const override { return function_.dimension(); }
  std::size_t residual_count() const override { return function_.residual_count(); }
  Capabilities capabilities() const override { return kept_; }

 private:
  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    function_.evaluate(x, outputs);
  }
  const ObjectiveFunction& function_;
  Capabilities kept_;
};

/// Branin's function, minimum 5/(4π) = 0.397887… at (−π, 12.275), (π, 2.275), (3π, 2.475).
class Branin final : public ObjectiveFunction {
 public:
  std::string_view name() const override { return "branin"; }
  std::size_t dimension() const override { return 2; }
  Capabilities capabilities() const override { return {.gradient = true}; }
  static constexpr double kMinimum = 5.0 / (4.0 * std::numbers::pi);

 private:
  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    constexpr double pi = std::numbers::pi;
    constexpr double b = 5.1 / (4.0 * pi * pi);
    const double u = x[1] - b * x[0] * x[0] + 5.0 / pi * x[0] - 6.0;
    const double v = 10.0 * (1.0 - 1.0 / (8.0 * pi));
    if (outputs.value) *outputs.value = u * u + v * std::cos(x[0]) + 10.0;
    if (!outputs.gradient) return;
    outputs.gradient[0] = 2.0 * u * (-2.0 * b * x[0] + 5.0 / pi) - v * std::sin(x[0]);
    outputs.gradient[1] = 2.0 * u;
  }
};

/// Value by a lambda, nothing else.
class ValueOnly final : public ObjectiveFunction {
 public:
  ValueOnly(std::size_t dimension, std::function<double(std::span<const double>)> value)
      : dimension_(dimension), value_(std::move(value)) {}
  std::string_view name() const override { return "value_only"; }
  std::size_t dimension() const override { return dimension_; }
  Capabilities capabilities() const override { return {}; }

 private:
  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    if (outputs.value) *outputs.value = value_(x);
  }
  std::size_t dimension_;
  std::function<double(std::span<const double>)> value_;
};

struct Boom : std::runtime_error {
  Boom() : std::runtime_error("boom") {}
};

/// The quadratic, which throws Boom at its n-th evaluation.
class Throwing final : public LeastSquaresProblem {
 public:
  explicit Throwing(int at) : at_(at) {}

 private:
  std::array<double, 2> residuals(double x, double y) const override {
    if (calls >= at_) throw Boom();
    return {x - 3.0, 2.0 * (y + 1.0)};
  }
  std::array<double, 4> jacobian(double /*x*/, double /*y*/) const override {
    return {1.0, 0.0, 0.0, 2.0};
  }
  int at_;
};

inline std::vector<Variable> box(double x, double y, double lower, double upper,
                                 double scale = 1.0) {
  return {{"x", "m", x, lower, upper, scale}, {"y", "Hz", y, lower, upper, scale}};
}

/// The domain of Branin's function, started in its middle.
inline std::vector<Variable> branin_box() {
  return {{"x", "1", 2.0, -5.0, 10.0, 7.5}, {"y", "1", 7.0, 0.0, 15.0, 7.5}};
}

}  // namespace modcal
