// Free parameters in their order and what they move: derivative columns follow.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "libcalib/parameters/parameter_table.hpp"
#include "libsim/base/aligned_vector.hpp"

namespace modcal {

/// Share of one mode in one column of the Jacobian: ∂ln ω_n/∂θ, ∂ln ζ_n/∂θ and ∂B/∂θ as far as it
/// moves the residue.
struct ColumnShare {
  std::size_t column = 0;
  double frequency = 0.0;
  double damping = 0.0;
  double residue = 0.0;
};

/// What changes both records by an amplitude that is no parameter of the model: the change of y_1
/// and y_2 (WhitenedRecord) for 1, by bins; empty: none.
struct SignalColumn {
  PlanarVector left, right;
};

/// How the columns of a Jacobian are made of ∂/∂ln ω_n and ∂/∂ln ζ_n, and which ones are those of
/// x_c and of the sensor at x = L (its coordinates: ln gain, delay [s], corner [rad/s]). Last stand
/// those of its smooth response, which few bins have: real and imaginary part of knot after knot.
/// Before them stand those of `signals`, which must outlive this.
struct LikelihoodColumns {
  std::size_t count = 0;
  std::vector<ColumnShare> shares;       ///< by mode
  std::vector<std::size_t> share_begin;  ///< N + 1 numbers: where those of mode n begin
  std::optional<std::size_t> contact = {};
  std::array<std::optional<std::size_t>, Sensor::kCount> sensors = {};
  std::span<const SignalColumn> signals = {};
  std::size_t knots = 0;

  /// The same with `further` beside them, which must outlive the result; there are no others yet.
  LikelihoodColumns with(std::span<const SignalColumn> further) const {
    LikelihoodColumns more = *this;
    more.signals = further;
    more.count += further.size();
    return more;
  }
  /// Columns before those of the response.
  std::size_t common() const { return count - 2 * knots; }
  LikelihoodColumns without_response() const {
    LikelihoodColumns others = *this;
    others.count = common();
    others.knots = 0;
    return others;
  }
};

/// θ: the coordinates (ParameterType) of named parameters of one record. A mode whose frequency or
/// damping is a parameter of its own, or is fixed, does not follow that of the law.
class FreeParameters {
 public:
  FreeParameters() = default;
  explicit FreeParameters(std::size_t modes)
      : poles_{std::vector<Pole>(modes), std::vector<Pole>(modes)} {}

  void add(const ParameterName& name);
  /// Nothing moves this frequency or damping ratio.
  void fix(const ParameterName& name) { pole(name).state = State::kFixed; }

  std::size_t size() const { return names_.size(); }
  const ParameterName& operator[](std::size_t i) const { return names_[i]; }
  const ParameterType& type(std::size_t i) const { return type_of(names_[i]); }
  std::optional<std::size_t> find(ParameterKind kind, std::size_t index = 0) const;
  bool has(ParameterKind kind) const;
  bool follows_law(Moves what, std::size_t mode) const {
    return poles_[place(what)][mode].state == State::kOfLaw;
  }
  /// The parameters that move the frequency or the damping of a mode.
  std::span<const std::size_t> movers(Moves what, std::size_t mode) const;
  /// ∂ ln ω_n or ∂ ln ζ_n, whichever it moves, by parameter i of movers().
  double share(std::size_t i, std::size_t mode, double inharmonicity) const {
    return type(i).share(inharmonicity, static_cast<double>(mode + 1));
  }
  /// Columns by the coordinates at B, of the modes and of the higher ones behind them; `without`:
  /// none for these parameters.
  LikelihoodColumns columns(double inharmonicity, const std::optional<HigherModeLaw>& higher,
                            const std::vector<bool>& without = {}) const;

 private:
  void add_higher(double inharmonicity, const HigherModeLaw& higher,
                  const std::vector<bool>& without, LikelihoodColumns& columns) const;
  enum class State { kOfLaw, kOwn, kFixed };
  struct Pole {
    State state = State::kOfLaw;
    std::size_t own = 0;  // the parameter that it is
  };
  static std::size_t place(Moves what) { return what == Moves::kDamping ? 1 : 0; }
  Pole& pole(const ParameterName& name) { return poles_[place(type_of(name).moves)][name.index]; }

  std::vector<ParameterName> names_;
  std::array<std::vector<Pole>, 2> poles_;        // frequencies, damping ratios
  std::array<std::vector<std::size_t>, 2> laws_;  // parameters of their laws
};

}  // namespace modcal
