// Estimators: from the reactions of one record to the force and motion at the contact.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libinverse/joint/sensor_noise.hpp"
#include "libinverse/spectral/one_sided/one_sided_inversion.hpp"
#include "libsim/base/registry.hpp"

namespace modcal {

/// One record as an estimator sees it. Spans are empty where a signal is not known.
struct EstimationRecord {
  ReactionPair reactions;  ///< by End, K samples each [N]
  /// Standard deviations of the noise of one sample as stated by a simulated measurement [N]; NaN:
  /// not known. Only rules that ask for a known noise level may use them.
  std::array<double, 2> stated_noise = {std::numeric_limits<double>::quiet_NaN(),
                                        std::numeric_limits<double>::quiet_NaN()};
  /// True force [N]: for limits that nobody can beat, never for an estimate.
  std::span<const double> true_force;
};

/// Where an estimate comes from and what it is.
struct Estimate {
  std::string side;   ///< "1", "2", "joint", …: the key of tables
  std::string label;  ///< "from R1 (x = 0)", "from both reactions": for figures and warnings
  InversionResult result;
  /// f_c averaged over a sample period about every sample, undone below half the rate [N]: what
  /// sampling the force does not fold back. Empty: the force has nothing above the highest mode.
  std::vector<double> unaliased_force;
  double largest_transfer = 0.0;  ///< max |H| that the parameter is relative to [N/N]
  /// Standard deviations given the record: force [N], displacement [m], velocity [m/s]; NaN: none.
  double force_deviation = std::numeric_limits<double>::quiet_NaN();
  double displacement_deviation = std::numeric_limits<double>::quiet_NaN();
  double velocity_deviation = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::pair<std::string, double>> figures;  ///< "sigma_T" and the like, for reports
  std::vector<std::string> warnings;
};

/// The modal model that inverts.
struct EstimationModel {
  const ModalBasis& basis;
  double contact = 0.0;  ///< x_c [m]
  std::size_t samples = 0;
  double sample_rate = 0.0;  ///< [Hz]
  bool recorded = false;     ///< a real string has modes above the last one stated
};

/// An estimator with its transfer functions; const and safe to use from several threads.
class PreparedEstimator {
 public:
  virtual ~PreparedEstimator() = default;
  /// One estimate or, where sides are inverted on their own, one a side.
  /// Throws InvalidInput where the record does not fit the model or holds what is not finite.
  virtual std::vector<Estimate> estimate(const EstimationRecord& record,
                                         const InversionMethod& method) const = 0;
};

class Estimator {
 public:
  static constexpr std::string_view kKind = "estimator";
  static Registry<Estimator> registry();

  virtual ~Estimator() = default;
  std::shared_ptr<const PreparedEstimator> prepare(const EstimationModel& model) const {
    return do_prepare(model);
  }
  /// How the sensors read, as far as the estimator is told.
  virtual SensorOptions sensors() const { return {}; }

 private:
  virtual std::shared_ptr<const PreparedEstimator> do_prepare(
      const EstimationModel& model) const = 0;
};

}  // namespace modcal
