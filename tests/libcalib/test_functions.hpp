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

#include "libcalib/objective_function.hpp"

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
