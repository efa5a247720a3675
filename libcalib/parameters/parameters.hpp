// The parameters of a search and their binding to the modal model.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libcalib/parameters/free_parameters.hpp"
#include "libcalib/problem/variable.hpp"
#include "libsim/base/options.hpp"

namespace modcal {

struct Parameter : ParameterName {
  Variable variable;
};

/// A number of the model that is held at a value, in the unit of its name.
struct HeldParameter : ParameterName {
  double value = 0.0;
};

/// dω_n/dx of one mode for one parameter, in rad/s per unit of the parameter; or dζ_n/dx.
struct FrequencySlope {
  std::size_t mode = 0;
  double slope = 0.0;
};

/// Subset of {f_1 … f_N}, {f0, B}, x_c, {zeta_1 … zeta_N}, {damping, damping_power}, {gain, delay,
/// corner} (see parse_parameter()) with bounds and scales, bound to an initial model. Where f0 or B
/// is free, the modes without a free frequency of their own follow f_n = n f0 √(1 + B n²), started
/// from the law fitted to the initial frequencies. Modes without a free ζ_n of their own have the
/// initial one times damping·n^damping_power. The sensor at x = L has gain, delay and corner. The
/// tension is left alone: it scales H_r of both ends alike and cannot be told from the force.
///
/// Of several records of one string each has for itself what is named with its number ("x_c 2") and
/// shares the rest with the first.
class ParameterSet {
 public:
  /// Names in any order, without repetition. Throws InvalidInput for an unknown or repeated name, a
  /// mode or record that is not there, an empty set, a range that is not positive, a contact at an
  /// end. held: none of the names.
  ParameterSet(ModelPoint initial, std::span<const std::string> names,
               const ParameterRanges& ranges = {}, std::size_t records = 1,
               std::span<const HeldParameter> held = {});

  std::size_t size() const { return parameters_.size(); }
  std::size_t records() const { return records_.size(); }
  const Parameter& operator[](std::size_t i) const { return parameters_[i]; }
  std::vector<Variable> variables() const;
  const ModelPoint& initial() const { return initial_; }
  bool has(ParameterKind kind) const { return records_.front().free.has(kind); }
  bool law_is_free() const {
    return has(ParameterKind::kFundamental) || has(ParameterKind::kInharmonicity);
  }
  /// Initial values.
  std::vector<double> start() const;

  /// The model of a record at the parameters x (`size()` values in user units).
  ModelPoint model(std::span<const double> x, std::size_t record = 0) const;
  /// Where the columns of a record stand among all.
  std::span<const std::size_t> places(std::size_t record) const { return records_[record].places; }
  /// The modes of the first record whose ω_n depends on parameter i, with dω_n/dx_i at x; empty for
  /// what moves none.
  std::vector<FrequencySlope> frequency_slopes(std::span<const double> x, std::size_t i) const {
    return slopes(x, i, Moves::kFrequencies);
  }
  /// The modes whose ζ_n depends on parameter i, with dζ_n/dx_i at x; empty for what moves none.
  std::vector<FrequencySlope> damping_slopes(std::span<const double> x, std::size_t i) const {
    return slopes(x, i, Moves::kDamping);
  }
  /// Columns of a record's Jacobian by the coordinates (ParameterType) of what it depends on.
  LikelihoodColumns columns(std::span<const double> x, std::size_t record = 0) const {
    return records_[record].free.columns(law_at(x, record).inharmonicity, initial_.higher);
  }

 private:
  struct OfRecord {
    FreeParameters free;
    std::vector<std::size_t> places;  // of these among all
    std::optional<double> contact;    // held [m], other than that of the first
  };
  void take_law(const ParameterRanges& ranges, std::span<const HeldParameter> held);
  OfRecord of_record(std::size_t record, std::span<const ParameterName> names,
                     std::span<const HeldParameter> held) const;
  struct Law {
    double fundamental = 0.0, inharmonicity = 0.0;
    double factor = 1.0, power = 0.0;  ///< of the damping
    double frequency(std::size_t mode) const;
    double damping(std::size_t mode) const;
  };
  Variable variable(const ParameterName& name, const ParameterRanges& ranges) const;
  /// Least and largest value of what has any, whatever its range.
  Range limits(ParameterKind kind, const ParameterRanges& ranges) const;
  Law law_at(std::span<const double> x, std::size_t record) const;
  std::vector<FrequencySlope> slopes(std::span<const double> x, std::size_t i, Moves what) const;

  ModelPoint initial_;
  std::vector<Parameter> parameters_;
  std::vector<OfRecord> records_;
  Law law_;              // initial law; its frequencies where f0 or B is free or held
  bool of_law_ = false;  // they are
};

}  // namespace modcal
