// What the observer has to find out, as numbers of the size of a step.
#pragma once

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "libinverse/observer/observer_kernel.hpp"
#include "libsim/base/options.hpp"

namespace modcal::observer {

/// Friction products, bow, adherence, offsets and, where freed, what else the observer can fit.
/// Only the products F_D = μ_D F_N and F_S = μ_S F_N are identifiable.
struct ObserverParameters {
  BlendedSliding sliding;
  double bow_velocity = 0.0;  ///< mean v_bow > 0 [m/s]
  double stiffness = 0.0;     ///< K_a [N/m]
  /// C_a over 2√(K_a m_eff) [1].
  double damping_ratio = 1.0;
  double offset[2] = {};               ///< b [N]
  std::vector<double> force_knots;     ///< ln F_N(t)/F_N at equally spaced times; empty: constant
  std::vector<double> velocity_knots;  ///< v_bow(t)/v_bow − 1; empty: constant
  double delay = 0.0;                  ///< of the reaction at x = 0 behind the other [s]
  double gain = 1.0;                   ///< of the reaction at x = 0 over the other [1]
  double contact = 0.0;                ///< x_c [m]
  std::vector<double> detuning;        ///< ω_n over the model's, minus 1; empty: the model's
  /// Growth of the level of the reaction at x = L, b (1 + growth t) [1/s]: a high-pass of that
  /// corner has been undone, which integrates a level along with the reaction.
  double level_growth = 0.0;
};

/// What one coordinate moves.
enum class Coordinate {
  kDynamicForce,
  kForceDrop,
  kDecay,
  kBowVelocity,
  kStiffness,
  kLeftOffset,
  kRightOffset,
  kDamping,
  kWeight,
  kRatio,
  kViscous,
  kHeating,
  kCooling,
  kCarried,
  kWidth,
  kForceKnot,
  kVelocityKnot,
  kDelay,
  kGain,
  kContact,
  kDetuning,
};

struct FreeParameter {
  Coordinate coordinate;
  std::size_t index = 0;  ///< of a knot or a mode
  double step = 0.0;      ///< change per unit: relative (logarithmic) for positive quantities
  /// Prior standard deviation about `center`, in steps; infinite: none.
  double prior = std::numeric_limits<double>::infinity();
  double center = 0.0;
};

/// θ(x): the start moved by x_i steps of every free parameter.
class ParameterSpace {
 public:
  ParameterSpace(ObserverParameters start, std::vector<FreeParameter> free)
      : start_(std::move(start)), free_(std::move(free)) {}
  std::size_t size() const { return free_.size(); }
  const std::vector<FreeParameter>& free() const { return free_; }
  ObserverParameters at(std::span<const double> x) const;
  /// Σ ((x_i − center_i)/prior_i)²/2.
  double penalty(std::span<const double> x) const;
  /// The same parameters, counted from θ(x): what is free and how far it may move stays.
  ParameterSpace restarted_at(std::span<const double> x) const;
  void free_also(const FreeParameter& parameter) { free_.push_back(parameter); }
  /// Fixes what one coordinate moves.
  void hold(Coordinate coordinate) {
    std::erase_if(free_,
                  [coordinate](const FreeParameter& f) { return f.coordinate == coordinate; });
  }
  ObserverParameters& start() { return start_; }

 private:
  ObserverParameters start_;
  std::vector<FreeParameter> free_;
};

struct ModelBasedOptions {
  /// Friction laws fitted; with several, the one with the least BIC is taken.
  std::vector<std::string> laws = {"exponential", "hyperbolic", "thermal", "two_exponential"};
  std::int64_t substeps = 5;        ///< steps of the observer per sample while it is fitted
  std::int64_t rounds = 3;          ///< of gain search and fit
  bool adherence_damping = false;   ///< frees C_a, else 2√(K_a m_eff)
  std::int64_t force_knots = 0;     ///< of ln F_N(t); 0: constant
  std::int64_t velocity_knots = 0;  ///< of v_bow(t); 0: constant
  bool delay = false;               ///< frees the delay between the two sensors
  bool gain = false;                ///< frees the gain ratio of the two sensors
  bool contact = false;             ///< frees x_c
  bool frequencies = false;         ///< frees every ω_n
  /// Steady J above which the result warns; NaN: four standard deviations above what a right model
  /// leaves.
  double misfit_limit = std::numeric_limits<double>::quiet_NaN();
  /// Standard deviations of the noise of one sample [N]; NaN: from the record.
  double noise_rms[2] = {std::numeric_limits<double>::quiet_NaN(),
                         std::numeric_limits<double>::quiet_NaN()};
  void visit(OptionVisitor& visitor);
  /// Beyond friction products, decay, bow velocity, adherence stiffness and offsets.
  bool frees_more() const {
    return adherence_damping || force_knots > 0 || velocity_knots > 0 || delay || gain || contact ||
           frequencies;
  }
};

/// ln F_D, ln ΔF, ln C, v_bow, ln K_a and the offsets. `force_scale` [N], the prior of the offsets
/// `offset_deviation` [N].
std::vector<FreeParameter> basic_parameters(double force_scale,
                                            const double (&offset_deviation)[2]);

/// Frees what is asked for; `modes`: numbers of the modes that the contact reaches.
void free_more(const ModelBasedOptions& options, std::span<const std::size_t> modes,
               ParameterSpace& space);

}  // namespace modcal::observer
