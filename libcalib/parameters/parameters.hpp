// The unknowns of a calibration and their binding to the modal model.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "libcalib/parameters/unknown_name.hpp"
#include "libcalib/problem/variable.hpp"
#include "libsim/base/options.hpp"
#include "libsim/model/modal_basis.hpp"

namespace modcal {

/// How the sensor at x = L reads for one at x = 0 that reads the reaction itself. What both have in
/// common cannot be told from the force.
struct SensorPair {
  double gain = 1.0;    ///< > 0 [1]
  double delay = 0.0;   ///< [s]
  double corner = 0.0;  ///< of a high-pass of first order, >= 0 [rad/s]
  bool free = false;    ///< one of the three is an unknown

  bool alike() const { return gain == 1.0 && delay == 0.0 && corner == 0.0; }
  /// What comes with a difference (see plain_transients()) is there where there may be one, so that
  /// a search that starts from equal sensors meets no step.
  bool may_differ() const { return free || !alike(); }
  /// gain exp(−s delay) s/(s + corner) at s != 0 [1/s].
  std::complex<double> response(std::complex<double> s) const {
    return gain * std::exp(-s * delay) * s / (s + corner);
  }
};

/// The model as far as a calibration changes it.
struct ModelPoint {
  ModalBasis basis;
  double contact = std::numeric_limits<double>::quiet_NaN();  ///< x_c [m]
  SensorPair sensors = {};  ///< known to the joint likelihood and the innovation misfit
};

using ParameterKind = UnknownKind;

struct Parameter {
  Variable variable;
  ParameterKind kind = ParameterKind::kFrequency;
  std::size_t mode = 0;  ///< index of the mode, for kFrequency and kDampingRatio
};

/// How far parameters may go from their initial values.
struct ParameterRanges {
  double frequency = 0.04;      ///< f_n and f0: share of the initial value [1]
  double inharmonicity = 1e-3;  ///< B: distance [1], kept above lowest_inharmonicity
  /// B: smallest value, ≤ 0; NaN: −1/(2N²), where the highest of N modes is at 0.7 of its harmonic
  /// and the law ends at −1/N² [1]. A string has B ≥ 0, its estimate scatters about it: a bound at
  /// 0 would bias it.
  double lowest_inharmonicity = std::numeric_limits<double>::quiet_NaN();
  double contact = 5e-3;  ///< x_c: distance [m], kept inside the string
  double damping = 0.5;   ///< ζ_n and their factor: share of the initial value [1]
  double power = 1.0;     ///< exponent of n in ζ_n: distance [1]
  double gain = 0.1;      ///< share of the initial value [1]
  double delay = 5e-5;    ///< distance [s]
  double corner = 20.0;   ///< from 0 to the initial value plus this [Hz]
  void visit(OptionVisitor& visitor);
};

/// dω_n/dx of one mode for one parameter, in rad/s per unit of the parameter; or dζ_n/dx.
struct FrequencySlope {
  std::size_t mode = 0;
  double slope = 0.0;
};

/// Subset of {f_1 … f_N}, {f0, B}, x_c, {zeta_1 … zeta_N}, {damping, damping_power}, {gain, delay,
/// corner} (see parse_unknown()) with bounds and scales, bound to an initial model. Where f0 or B
/// is free, the modes without a free frequency of their own follow f_n = n f0 √(1 + B n²), started
/// from the law fitted to the initial frequencies. Modes without a free ζ_n of their own have the
/// initial one times damping·n^damping_power. The sensor at x = L has gain, delay and corner. The
/// tension is left alone: it scales H_r of both ends alike and cannot be told from the force.
class ParameterSet {
 public:
  /// Names in any order, without repetition. Throws InvalidInput for an unknown or repeated name, a
  /// mode outside the model, an empty set, a range that is not positive, a contact at an end.
  ParameterSet(ModelPoint initial, std::span<const std::string> names,
               const ParameterRanges& ranges = {});

  std::size_t size() const { return parameters_.size(); }
  const Parameter& operator[](std::size_t i) const { return parameters_[i]; }
  std::vector<Variable> variables() const;
  const ModelPoint& initial() const { return initial_; }
  bool has(ParameterKind kind) const;
  bool law_is_free() const {
    return has(ParameterKind::kFundamental) || has(ParameterKind::kInharmonicity);
  }
  /// Initial values.
  std::vector<double> start() const;

  /// The model at the parameters x (`size()` values in user units).
  ModelPoint model(std::span<const double> x) const;
  /// The modes whose ω_n depends on parameter i, with dω_n/dx_i at x; empty for what moves none.
  std::vector<FrequencySlope> frequency_slopes(std::span<const double> x, std::size_t i) const;
  /// The modes whose ζ_n depends on parameter i, with dζ_n/dx_i at x; empty for what moves none.
  std::vector<FrequencySlope> damping_slopes(std::span<const double> x, std::size_t i) const;

 private:
  struct Law {
    double fundamental = 0.0;
    double inharmonicity = 0.0;
  };
  Parameter parameter(const std::string& name, const ParameterRanges& ranges) const;
  Parameter damping_parameter(const std::string& name, const UnknownName& of,
                              const ParameterRanges& ranges) const;
  Parameter sensor_parameter(const std::string& name, const UnknownName& of,
                             const ParameterRanges& ranges) const;
  Law law_at(std::span<const double> x) const;
  /// ζ_n over the initial one where it has no unknown of its own.
  double damping_at(std::span<const double> x, std::size_t mode) const;
  void set_damping_and_sensors(std::span<const double> x, ModelPoint& point) const;

  ModelPoint initial_;
  std::vector<Parameter> parameters_;
  Law law_;                    // initial law; used where f0 or B is free
  std::vector<bool> follows_;  // per mode: ω_n comes from the law
  std::vector<bool> damped_;   // per mode: ζ_n is an unknown of its own
};

}  // namespace modcal
