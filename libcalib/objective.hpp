// Objectives: what a calibration minimizes.
#pragma once

#include <memory>
#include <string_view>

#include "libcalib/calibration_data.hpp"
#include "libcalib/objective_function.hpp"
#include "libcalib/parameters.hpp"
#include "libsim/base/registry.hpp"

namespace modcal {

class Objective {
 public:
  static constexpr std::string_view kKind = "objective";
  static Registry<Objective> registry();

  virtual ~Objective() = default;
  /// The objective as a function of the parameters; keeps copies of what it needs. Throws
  /// InvalidInput for invalid data, an undamped mode, modes above the Nyquist frequency, data or
  /// parameters the objective cannot work with.
  std::unique_ptr<const ObjectiveFunction> bind(const CalibrationData& data,
                                                const ParameterSet& parameters) const;

 private:
  virtual std::unique_ptr<const ObjectiveFunction> do_bind(
      const CalibrationData& data, const ParameterSet& parameters) const = 0;
};

}  // namespace modcal
