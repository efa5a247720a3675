// A bowed or plucked string by finite differences: records whose truth no part of modcal has made.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "benchmarks/truth/friction.hpp"
#include "benchmarks/truth/wave.hpp"

namespace modcal::truth {

/// Torsion of the string, as displacement of its surface: the same wave equation without stiffness,
/// with wave speed and impedance over the transverse ones. Ends do not turn (Galluzzo and
/// Woodhouse, 2014, use the same two numbers).
struct TruthTorsion {
  double speed_ratio = 5.2;      ///< c_τ/c [1]
  double impedance_ratio = 1.8;  ///< Z_τ/Z [1]
  double loss = 100.0;           ///< σ₀ [1/s]
  double diffusion = 0.02;       ///< σ₁ [m²/s]
};

/// The continuum's string, pinned at both ends: f_n = n f₀ √(1 + B n²), decay σ_n = σ₀ + σ₁
/// (nπ/L)², ζ_n = σ_n/2πf_n.
struct TruthString {
  double fundamental = 294.0;      ///< f₀ [Hz]
  double inharmonicity = 1.1e-4;   ///< B [1]
  double length = 0.33;            ///< L [m]
  double linear_density = 1.0e-3;  ///< ρ [kg/m]
  double loss = 3.0;               ///< σ₀ [1/s]
  double diffusion = 8e-4;         ///< σ₁ [m²/s]
  std::optional<TruthTorsion> torsion;

  double wave_speed() const { return 2.0 * length * fundamental; }
  double tension() const { return wave_speed() * wave_speed() * linear_density; }  ///< T [N]
  double bending() const;  ///< EI = B T L²/π² [N m²]
};

/// Linear between knots, constant beyond them; one knot: constant.
struct Knot {
  double time;   ///< [s]
  double value;  ///< in the unit of what it is the course of
};
using Course = std::vector<Knot>;
double value_at(const Course& course, double time);

/// A bow with its velocity [m/s], its normal force [N] and its friction.
struct TruthBow {
  Course velocity = {{0.0, 0.1}};
  Course normal_force = {{0.0, 0.5}};
  Friction friction;
};
/// A force that is stated, in newtons: a plectrum that draws the string aside and lets go.
struct TruthForce {
  Course force = {{0.0, 0.0}, {0.02, 0.5}, {0.0205, 0.0}};
};
/// The string at rest drawn aside to a triangle with a corner as wide as a finger (a parabola), and
/// let go at t = 0.
struct TruthPluck {
  double height = 1e-3;  ///< of the corner of the triangle [m]
  double width = 4e-3;   ///< [m]
};

struct TruthGesture {
  double position = 0.041;  ///< x_c from the end of R1 [m]
  std::variant<TruthBow, TruthForce, TruthPluck> action;
};

/// What the sensors at the ends read, the force of the support on the string. kTension: −T y'(0)
/// and T y'(L); kSupport: with bending, −T y' + EI y''' and its mirror image. Neither has the flux
/// of the losses, −2σ₁ρ ẏ', which a real support may feel: a share of about 2ζ_n, a quarter turn
/// late.
enum class Reactions { kTension, kSupport };

/// What a real rig has and a model of a string may not: R2 = (gain exp(−sτ) s/(s + ω_c) (1 + b(s)))
/// R2, b(s) = peak · 2ζω_r s/(s² + 2ζω_r s + ω_r²), bilinear at the rate of the scheme; a second
/// polarization; a string that goes out of tune; a bow that wanders; a bridge that moves.
struct TruthMismatch {
  double gain = 1.0;              ///< of the sensor at x = L over that at x = 0 [1]
  double delay = 0.0;             ///< of the same, τ [s]
  double corner = 0.0;            ///< of the same, ω_c/2π [Hz]
  double body_peak = 0.0;         ///< of a resonance that the sensor at x = L feels [1]
  double body_frequency = 280.0;  ///< [Hz]
  double body_damping = 0.02;     ///< ζ [1]
  /// The same force moves a second string with speed c (1 + detuning); so much of its reactions is
  /// added to R1 and R2.
  double polarization[2] = {0.0, 0.0};
  double detuning = 1.3e-3;
  /// Relative change of f0 from the record's beginning to its end, zero at its middle.
  double drift = 0.0;
  /// The force acts at x_c + wander · w(t), w the sine of wander_frequency that begins at 0 with the
  /// record; of 0 Hz a slope from −1 at its beginning to 1 at its end [m], [Hz].
  double wander = 0.0, wander_frequency = 0.0;
  /// The end at x = L is a mode of the body: m (ü + 2ζω_r u̇ + ω_r² u) = −T y'(L) + EI y'''(L), with
  /// ω_r and ζ as above; m = 0: it does not move. The string's losses are those of y − u x/L.
  double bridge_mass = 0.0;  ///< m [kg]
};

struct TruthOptions {
  double duration = 1.0;         ///< of the record [s]
  double sample_rate = 51200.0;  ///< of the record [Hz]
  /// The record begins this long after the gesture, or before it: at rest, the filter's own ringing
  /// included [s].
  double start = -2e-3;
  Reactions reactions = Reactions::kTension;
  bool filtered = true;  ///< anti-alias filter (Decimator); otherwise plain samples
  TruthMismatch mismatch;
  double noise_level = 0.0;  ///< white noise of R1 and R2 over their standard deviations [1]
  std::uint64_t seed = 1;    ///< of the noise
  /// Rate of the scheme: the least multiple of 8 sample rates that is not below [Hz].
  double least_rate = 10e6;
  /// Cells; 0: three to a half wave of the highest mode below half the sample rate, at least 128.
  std::size_t intervals = 0;
  std::size_t half_width = 8;  ///< P: order 2P − 2 (see Wave)
  bool audit = false;          ///< checks every step: half again as slow
};

/// Energies [J] and the largest violation of what every step has to satisfy.
struct TruthAudit {
  double stored = 0.0;    ///< at the end less at the beginning, torsion included
  double lost = 0.0;      ///< by the losses of string and torsion
  double bow_work = 0.0;  ///< ∫ f v_bow dt; for a stated force ∫ f v dt
  double heat = 0.0;      ///< by friction, ∫ −f (v − v_bow) dt
  double largest = 0.0;   ///< of all energies met: the scale
  double residual() const { return (stored + lost + heat - bow_work) / largest; }  ///< [1]
  double least_heat_power = 0.0;  ///< [W]; friction never gives: not below 0 but for rounding
  /// Largest distance of the force from the friction set, over the normal force [1]: beyond μ N
  /// while it sticks, from the curve at the velocity that the grid has while it slides.
  double friction_violation = 0.0;
};

struct TruthRecord {
  double rate = 0.0;  ///< [Hz]
  /// Reactions [N], noise included; force on the string [N], displacement [m] and velocity [m/s] of
  /// its centre line at the contact. All filtered alike, all at t_i = start + i/rate.
  std::vector<double> r1, r2, f, y, v;
  double noise[2] = {0.0, 0.0};  ///< standard deviations [N]
  std::vector<WaveMode> modes;   ///< 1 … N − 1, the scheme's own, on the bridge if it moves
  double internal_rate = 0.0;    ///< [Hz]
  std::size_t intervals = 0;
  double stuck = 0.0;     ///< share of the time [1]
  std::size_t slips = 0;  ///< releases
  TruthAudit audit;
};

/// Grid of the options for this string.
WaveGrid grid_of(const TruthString& string, const TruthOptions& options);

/// Simulates the string. Throws std::invalid_argument for numbers out of range, an unstable grid, a
/// contact closer to an end than its stencils reach.
TruthRecord simulate(const TruthString& string, const TruthGesture& gesture,
                     const TruthOptions& options = {});

/// Adds white Gaussian noise of `level` times the standard deviation of each reaction: to a copy of
/// a record without noise, for several draws.
void add_noise(TruthRecord& record, double level, std::uint64_t seed);

}  // namespace modcal::truth
