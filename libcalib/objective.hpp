// Objectives: what a calibration minimizes.
#pragma once

#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "libcalib/parameters/parameters.hpp"
#include "libcalib/problem/calibration_data.hpp"
#include "libcalib/problem/objective_function.hpp"
#include "libsim/base/registry.hpp"

namespace modcal {

struct Problem;

/// What a parameter does to an objective.
enum class Response {
  kMoves,   ///< it changes the value, and slopes are known where there are any
  kNone,    ///< the value does not depend on it
  kRefused  ///< it changes the value in a way the objective does not follow
};

class Objective {
 public:
  static constexpr std::string_view kKind = "objective";
  static Registry<Objective> registry();
  /// One of the program's own, which experiments choose by its name from now on; it has no options.
  /// Throws InvalidInput for a name that is taken.
  static void add(std::string name, std::string summary, std::shared_ptr<const Objective> product);

  virtual ~Objective() = default;
  /// The objective as a function of the parameters; keeps copies of what it needs. Throws
  /// InvalidInput for invalid data, an undamped mode, modes above the Nyquist frequency, data or
  /// parameters the objective cannot work with.
  std::unique_ptr<const ObjectiveFunction> bind(const CalibrationData& data,
                                                const ParameterSet& parameters) const;
  /// The same for the records of a problem and what is known beforehand. Throws InvalidInput for
  /// several records where the objective compares one alone.
  std::unique_ptr<const ObjectiveFunction> bind(const Problem& problem,
                                                const ParameterSet& parameters) const;
  /// The same for one term of a sum: another term may see what this one does not depend on.
  std::unique_ptr<const ObjectiveFunction> bind_term(const CalibrationData& data,
                                                     const ParameterSet& parameters) const;
  /// Throws InvalidInput for a parameter (see parse_parameter()) that the objective cannot find.
  void require_moved_by(std::span<const std::string> names) const;
  virtual Response response(Moves what) const;
  /// What its functions can compute, known before there are data. Most have slopes and residuals.
  virtual Capabilities capabilities() const { return {.gradient = true, .least_squares = true}; }
  /// Whether its residuals are independent and of variance 1 for a right model, so that (JᵀJ)⁻¹ at
  /// the optimum is the covariance of the parameters.
  virtual bool whitened() const { return false; }
  /// Highest frequency it compares [Hz]; NaN: what follows from the modes.
  virtual double highest_frequency() const { return std::numeric_limits<double>::quiet_NaN(); }
  /// Throws InvalidInput where it cannot work with a record of `samples` at f_s [Hz] of this
  /// string.
  virtual void require_record(const ModalBasis& basis, double sample_rate,
                              std::size_t samples) const;

 private:
  virtual std::unique_ptr<const ObjectiveFunction> bind_problem(
      const Problem& problem, const ParameterSet& parameters) const;
  virtual std::unique_ptr<const ObjectiveFunction> do_bind(
      const CalibrationData& data, const ParameterSet& parameters) const = 0;
};

}  // namespace modcal
