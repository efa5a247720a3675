// The table of named parameters: what a calibration may find or be told of a string and its
// sensors. All that is known of a kind of parameter stands here and is read by searches, fits,
// priors, limits and reports; a new one is one row and what it moves in the model.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libsim/base/options.hpp"
#include "libsim/model/higher_modes.hpp"
#include "libsim/model/modal_basis.hpp"
#include "libsim/model/sensor.hpp"

namespace modcal {

/// The model as far as a calibration changes it.
struct ModelPoint {
  ModalBasis basis;
  double contact = std::numeric_limits<double>::quiet_NaN();  ///< x_c [m]
  /// Of x = L against that of x = 0; known to the joint likelihood and the innovation misfit.
  Sensor sensors = {};
  /// What stands for the modes above; none: there are none, as in a simulation of these alone.
  std::optional<HigherModeLaw> higher = {};
};

enum class ParameterKind {
  kFundamental,    ///< f0 [Hz]
  kInharmonicity,  ///< B [1]
  kContact,        ///< x_c [m]
  kFrequency,      ///< f_n [Hz]
  kDampingRatio,   ///< zeta_n [1]
  kDampingFactor,  ///< damping: factor of all stated ζ_n [1], that of ζ_1 where there is a power
  kDampingPower,   ///< damping_power: exponent p of n in ζ_n = factor nᵖ ζ_n(stated) [1]
  kSensor          ///< gain [1], delay [s], corner [Hz]: number `index` of the sensor
};

struct ParameterName {
  ParameterKind kind = ParameterKind::kFundamental;
  std::size_t index = 0;   ///< of the mode, of f_n and zeta_n; of the sensor's number
  std::size_t record = 0;  ///< index: "x_c" and "x_c 1" are the first record's, "x_c 2" the next
  bool operator==(const ParameterName&) const = default;
};

/// What a parameter changes in the model.
enum class Moves { kFrequencies, kDamping, kContact, kSensor };

/// How a range bounds a parameter about its start.
enum class RangeKind {
  kShare,     ///< start (1 ± range)
  kDistance,  ///< start ± range
  kRise       ///< 0 … start + range
};

struct ParameterRanges;

/// A row of the table.
struct ParameterType {
  ParameterKind kind = ParameterKind::kFundamental;
  std::size_t index = 0;       ///< of the sensor's number
  std::string_view name = {};  ///< "f0"; "f_" where the number of a mode follows
  std::string_view unit = "1";
  std::string_view meaning = {};
  Moves moves = Moves::kFrequencies;
  bool of_mode = false;      ///< f_n and zeta_n
  bool logarithmic = false;  ///< its values are > 0; fits and priors act on the logarithm
  bool may_be_own = false;   ///< each record may have its own
  double per_unit = 1.0;     ///< what the model has for one unit of its values: 2π rad/s for 1 Hz
  Range stated = {};         ///< values that may be stated, of a sensor
  double farthest = 0.0;     ///< beyond this coordinate no sensor is
  int digits = 5;            ///< of its value in a text
  RangeKind range_kind = RangeKind::kDistance;
  double scale = 0.0;  ///< sensible step of a search; 0: as far as it may go
  /// Option of its range; empty: another row has it.
  OptionInfo range_option = {};
  double& (*range)(ParameterRanges&) = nullptr;
  /// ∂ ln ω_n or ∂ ln ζ_n by its coordinate; null: it moves no pole.
  double (*share)(double inharmonicity, double n) = nullptr;
  /// The number of the model that it is; null: a law of all modes, which has none.
  double* (*at)(ModelPoint&, std::size_t index) = nullptr;
  /// Its initial value, where it is no number of the model.
  double (*initial)(const ModelPoint&) = nullptr;

  /// Fits and priors act on the coordinate of a value: its logarithm, or what the model has for it.
  double coordinate(double value) const;
  /// Derivative of a value by its coordinate.
  double slope(double value) const { return logarithmic ? value : 1.0 / per_unit; }
  /// A number of the model after a change of the coordinate, and the change between two of them.
  double moved(double from, double change) const;
  double change(double from, double to) const;
};

std::span<const ParameterType> parameter_table();
const ParameterType& type_of(const ParameterName& name);

/// "f0", "B", "x_c", "f_3", "zeta_3", "damping", "damping_power", "gain", "delay", "corner", with
/// the number of a record behind where that is not the first; none for other text.
std::optional<ParameterName> parse_parameter(std::string_view text);
/// The same for a string of so many modes. Throws InvalidInput for other text and other modes.
ParameterName require_parameter(std::string_view text, std::size_t modes);
std::string text_of(const ParameterName& name);
/// Value in a model, in the unit of the name; of the law that its frequencies follow best, of a
/// factor 1 and a power 0 of its damping.
double value_of(const ParameterName& name, const ModelPoint& model);
/// SI unit of its values; "1" for other text.
std::string_view unit_of_parameter(std::string_view text);
/// What it is, in words; empty for other text.
std::string_view meaning_of_parameter(std::string_view text);
const ParameterType& sensor_type(std::size_t index);
/// A number of the sensor in the unit of its name.
double sensor_value(std::size_t index, const Sensor& sensor);
/// Names of the sensor's numbers.
std::vector<std::string_view> sensor_names();

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
  /// Gain: share of the initial value [1]; delay: distance [s]; corner: from 0 to the initial value
  /// plus this [Hz].
  double sensors[Sensor::kCount] = {0.1, 5e-5, 20.0};
  void visit(OptionVisitor& visitor);
  void require_valid() const;  ///< throws InvalidInput
  /// Smallest B of a string of so many modes. Throws InvalidInput where the law has no such modes.
  double lowest_of(std::size_t modes) const;
};

}  // namespace modcal
