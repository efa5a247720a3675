// Modal damping laws: damping ratio ζ_n as a function of the modal frequencies.
#pragma once

#include "libsim/base/registry.hpp"

namespace modcal {

/// What a damping law may need to know of its string; NaN where it was not told.
struct StringConstants {
  double length = std::numeric_limits<double>::quiet_NaN();          ///< L [m]
  double linear_density = std::numeric_limits<double>::quiet_NaN();  ///< ρ_L [kg/m]
  double tension = std::numeric_limits<double>::quiet_NaN();         ///< T [N]
  double inharmonicity = std::numeric_limits<double>::quiet_NaN();   ///< B = π² EI/(T L²) [1]
};

/// A mode as a damping law sees it.
struct DampedMode {
  std::size_t index = 0;  ///< n − 1
  double omega = 0.0;     ///< ω_n [rad/s]
  StringConstants string;
};

class DampingLaw {
 public:
  static constexpr std::string_view kKind = "damping";
  static Registry<DampingLaw> registry();

  virtual ~DampingLaw() = default;
  /// Damping ratios ζ_n [1] for the angular frequencies ω_n [rad/s]. Throws InvalidInput where a
  /// ratio leaves [0, 1): the modal propagators need oscillating modes.
  std::vector<double> ratios(std::span<const double> omega,
                             const StringConstants& string = {}) const;

 private:
  virtual double ratio(const DampedMode& mode) const = 0;
};

// Polynomial through measured damping ratios.

/// ζ_n ≈ Σ_j c_j n^j.
struct DampingFit {
  std::vector<double> coefficients;  ///< c_0, c_1, … [1], as PolynomialDamping takes them
  double rms_residual = std::numeric_limits<double>::quiet_NaN();  ///< [1]

  double ratio(std::size_t n) const;
};

/// Least-squares polynomial of the mode number through damping ratios of some modes, to extrapolate
/// them to all modes (Debut, Delaune and Antunes, 2010, section 7.2: degree 2), by QR.
/// mode_numbers: n ≥ 1, distinct; ratios: as many, finite. Throws InvalidInput for fewer than
/// degree + 1 modes, and for a repeated mode. The polynomial may leave [0, 1) where it
/// extrapolates: DampingLaw::ratios() refuses such a mode by name.
DampingFit fit_damping(std::span<const std::size_t> mode_numbers, std::span<const double> ratios,
                       std::size_t degree = 2);

// The damping laws of a string.

/// One damping ratio for all modes, ζ_n = ζ (Debut, Delaune and Antunes, 2010, section 2.3).
class ConstantDamping final : public DampingLaw {
 public:
  struct Options {
    double ratio = 1e-3;  ///< ζ [1]
    void visit(OptionVisitor& visitor);
  };
  explicit ConstantDamping(const Options& options) : options_(options) {}

 private:
  double ratio(const DampedMode& mode) const override;
  Options options_;
};

/// Damping ratio as a polynomial of the mode number, ζ_n = Σ_j c_j n^j; degree 2 is what Debut,
/// Delaune and Antunes (2010, section 7.2) extrapolate measured ratios with.
class PolynomialDamping final : public DampingLaw {
 public:
  struct Options {
    std::vector<double> coefficients = {1e-3};  ///< c_0, c_1, … [1]
    void visit(OptionVisitor& visitor);
  };
  explicit PolynomialDamping(Options options) : options_(std::move(options)) {}

 private:
  double ratio(const DampedMode& mode) const override;
  Options options_;
};

/// Damping ratio linear in the frequency between tabulated points (f_j [Hz], ζ_j [1]), constant
/// outside them.
class TableDamping final : public DampingLaw {
 public:
  struct Options {
    std::vector<double> frequencies;  ///< f_j [Hz], strictly rising
    std::vector<double> ratios;       ///< ζ_j [1], as many
    void visit(OptionVisitor& visitor);
  };
  /// Throws InvalidInput where the two do not pair up or the frequencies do not rise.
  explicit TableDamping(Options options);

 private:
  double ratio(const DampedMode& mode) const override;
  Options options_;
};

/// Damping ratios measured on some modes and extrapolated to all by a polynomial of the mode
/// number, fitted by least squares (Debut, Delaune and Antunes, 2010, section 7.2: degree 2, 11
/// modes).
class MeasuredDamping final : public DampingLaw {
 public:
  struct Options {
    std::vector<std::int64_t> modes;  ///< mode numbers n ≥ 1
    std::vector<double> ratios;       ///< ζ_n [1], as many
    std::int64_t degree = 2;
    void visit(OptionVisitor& visitor);
  };
  /// Throws InvalidInput where modes and ratios do not pair up or are too few for the degree.
  explicit MeasuredDamping(const Options& options);

 private:
  double ratio(const DampedMode& mode) const override;
  DampingFit fit_;
};

/// Three-term losses of a string,
///   1/Q_n = [T (η_F + η_A/ω_n) + EI η_B (nπ/L)²]/[T + EI (nπ/L)²],   ζ_n = 1/(2 Q_n)
/// (Woodhouse, 2004, "On the synthesis of guitar plucks"): internal friction η_F [1], air
/// η_A [1/s], bending η_B [1]. With B = π² EI/(T L²) the ratio of the two stiffnesses is B n².
class WoodhouseDamping final : public DampingLaw {
 public:
  struct Options {
    double friction = std::numeric_limits<double>::quiet_NaN();  ///< η_F [1]
    double air = std::numeric_limits<double>::quiet_NaN();       ///< η_A [1/s]
    double bending = std::numeric_limits<double>::quiet_NaN();   ///< η_B [1]
    void visit(OptionVisitor& visitor);
  };
  explicit WoodhouseDamping(const Options& options) : options_(options) {}

 private:
  double ratio(const DampedMode& mode) const override;
  Options options_;
};

/// Losses of a metal string, 1/Q_n = 1/Q_air + 1/Q_ve + 1/Q_d, ζ_n = 1/(2 Q_n) (Valette and Cuesta,
/// 1993; in the form of Pâté, Le Carrou and Fabre, 2014):
///   air           1/Q_air = R/(2π ρ_L f_n),  R = 2πη + 2πd √(π η ρ f_n)
///   viscoelastic  1/Q_ve = 4π² ρ_L EI δ f_n²/T²,  EI = B T L²/π²
///   dislocations and thermoelasticity  1/Q_d, the same for all modes
/// with the diameter d [m], viscosity η [Pa s] and density ρ [kg/m³] of the air, loss angle δ [1].
class ValetteCuestaDamping final : public DampingLaw {
 public:
  struct Options {
    double diameter = std::numeric_limits<double>::quiet_NaN();    ///< d [m]
    double loss_angle = std::numeric_limits<double>::quiet_NaN();  ///< δ [1]
    double constant = std::numeric_limits<double>::quiet_NaN();    ///< 1/Q_d [1]
    double air_viscosity = 1.8e-5;                                 ///< η [Pa s]
    double air_density = 1.2;                                      ///< ρ [kg/m³]
    void visit(OptionVisitor& visitor);
  };
  explicit ValetteCuestaDamping(const Options& options) : options_(options) {}

 private:
  double ratio(const DampedMode& mode) const override;
  Options options_;
};

}  // namespace modcal
