// Estimators: from the reactions of one record to the force and motion at the contact.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libinverse/estimate.hpp"
#include "libinverse/record.hpp"
#include "libsim/base/registry.hpp"
#include "libsim/model.hpp"

namespace modcal {

class Regularizer;
class ParameterChoice;

/// How to invert. The plug-ins must outlive the call.
struct InversionMethod {
  const Regularizer& regularizer;
  const ParameterChoice& choice;
  InversionOutputs outputs = {};
  /// Standard deviation of the noise of one sample [N], where a parameter choice asks for it.
  double noise_rms = std::numeric_limits<double>::quiet_NaN();
  bool variances = false;  ///< of every bin too (Estimate::force_variance)
};

/// The modal model that inverts.
struct EstimationModel {
  const ModalBasis& basis;
  double contact = 0.0;  ///< x_c [m]
  std::size_t samples = 0;
  double sample_rate = 0.0;  ///< [Hz]
  bool recorded = false;     ///< a real string has modes above the last one stated
  /// Whether the ends feel the bending of the string, where an estimator is not told
  /// (StringSupport).
  std::optional<bool> bending = {};
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
  virtual SensorPair sensors() const { return {}; }
  /// Whether it takes the ends to feel the bending of the string (StringSupport); nothing: as the
  /// model says.
  virtual std::optional<bool> feels_bending() const { return false; }
  /// Whether the regularizer and the parameter choice of the method play a part.
  virtual bool filters() const { return false; }
  /// Sides of its estimates; none: one, which has the estimator's name.
  virtual std::vector<std::string> sides() const { return {}; }
  /// Numbers a sample of the record that the work on one holds at a time, about.
  virtual double numbers_per_sample() const { return 30.0; }

 private:
  virtual std::shared_ptr<const PreparedEstimator> do_prepare(
      const EstimationModel& model) const = 0;
};

}  // namespace modcal
