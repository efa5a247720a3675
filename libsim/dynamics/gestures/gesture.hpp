// Bow gestures: how velocity and normal force of the bow go with time.
#pragma once

#include "libsim/base/registry.hpp"

namespace modcal {

/// g(t) through the knots (t_i [s], g_i), linear between them and constant outside. A value: cheap
/// queries, no virtual call. Throws InvalidInput unless the knots are finite and their times rise
/// strictly.
class PiecewiseLinear {
 public:
  /// The constant `value`: no knots.
  explicit PiecewiseLinear(double value = 0.0) : first_(value), last_(value) {}
  PiecewiseLinear(std::vector<double> times, std::vector<double> values);

  /// g(t).
  double at(double t) const;
  /// Right-hand derivative of g at t [1/s].
  double slope(double t) const;
  /// ∫ g dt from 0 to t [s], t ≥ 0.
  double integral(double t) const;
  /// First knot after t [s]; +∞ where there is none. Between two knots g is linear.
  double next_knot(double t) const;

  bool is_constant() const;
  double lowest() const;
  double highest() const;
  const std::vector<double>& times() const { return times_; }
  const std::vector<double>& values() const { return values_; }

  /// factor·g.
  PiecewiseLinear scaled(double factor) const;
  /// The function through the products g·h at the knots of both.
  PiecewiseLinear product(const PiecewiseLinear& other) const;

 private:
  // Number of knots at or before t: t lies after knot i − 1, before knot i.
  std::size_t knots_until(double t) const;
  double integral_from_first_knot(double t) const;

  std::vector<double> times_, values_;
  std::vector<double> area_;  // ∫ from the first knot to each knot
  double first_ = 0.0, last_ = 0.0;
};

/// Factor g(t) [1] by which a bow's nominal velocity or normal force is multiplied. Every gesture
/// reduces to a piecewise-linear function; 0 lifts the bow (force) or halts it (velocity), a
/// negative factor reverses its velocity.
class Gesture {
 public:
  static constexpr std::string_view kKind = "gesture";
  static Registry<Gesture> registry();

  virtual ~Gesture() = default;
  /// g on [0, duration], duration > 0 [s].
  PiecewiseLinear over(double duration) const;

 private:
  virtual PiecewiseLinear factor(double duration) const = 0;
};

/// g(t) = 1.
class SteadyGesture final : public Gesture {
 public:
  struct Options {
    void visit(OptionVisitor& /*visitor*/) {}
  };
  explicit SteadyGesture(const Options& /*options*/) {}

 private:
  PiecewiseLinear factor(double /*duration*/) const override { return PiecewiseLinear(1.0); }
};

/// g(t) linear through the points (time, factor), constant outside them.
class TableGesture final : public Gesture {
 public:
  struct Options {
    std::vector<double> times;    ///< [s], strictly rising
    std::vector<double> factors;  ///< [1], as many
    void visit(OptionVisitor& visitor);
  };
  /// Throws InvalidInput where times and factors do not pair up or the times do not rise.
  explicit TableGesture(const Options& options) : factor_(options.times, options.factors) {}

 private:
  PiecewiseLinear factor(double /*duration*/) const override { return factor_; }
  PiecewiseLinear factor_;
};

/// g(t) = from until `start`, then linear to `to` over `duration`, then to.
class RampGesture final : public Gesture {
 public:
  struct Options {
    double from = 0.0;      ///< [1]
    double to = 1.0;        ///< [1]
    double start = 0.0;     ///< [s]
    double duration = 0.1;  ///< [s]
    void visit(OptionVisitor& visitor);
  };
  explicit RampGesture(const Options& options) : options_(options) {}

 private:
  PiecewiseLinear factor(double duration) const override;
  Options options_;
};

/// g(t) = mean + amplitude sin(2π f t + phase), drawn with 128 straight pieces a period: within
/// amplitude·(2π/128)²/8 = 3e-4 amplitude of the sine. Several strokes to and fro with mean 0.
class SineGesture final : public Gesture {
 public:
  struct Options {
    double mean = 1.0;       ///< [1]
    double amplitude = 0.1;  ///< [1]
    double frequency = 5.0;  ///< f [Hz]
    double phase = 0.0;      ///< [rad]
    void visit(OptionVisitor& visitor);
  };
  explicit SineGesture(const Options& options) : options_(options) {}

 private:
  PiecewiseLinear factor(double duration) const override;
  Options options_;
};

/// Unsteadiness of the player's hand: multiplies a gesture by 1 + level·n(t), n being Gaussian
/// noise of variance 1, white below the cutoff and 0 above: independent draws w_j at the Nyquist
/// rate 2 f_cut with the Lanczos-windowed sinc between them, n(t) = Σ_j w_j sinc(2 f_cut t − j)
/// sinc((2 f_cut t − j)/8), drawn with 8 straight pieces a draw. The draws depend on seed and index
/// alone: a longer record starts with the same noise.
struct GestureNoise {
  bool present = false;
  double level = 0.01;   ///< standard deviation over the nominal value [1]
  double cutoff = 20.0;  ///< f_cut [Hz]
  std::int64_t seed = 1;
  void visit(OptionVisitor& visitor);

  /// 1 + level·n(t) on [0, duration] [s]; 1 where not present. `role` names the stream, so that
  /// velocity and force of one seed have draws of their own.
  PiecewiseLinear factor(double duration, std::string_view role) const;
};

}  // namespace modcal
