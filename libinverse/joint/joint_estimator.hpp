#pragma once

#include <limits>
#include <string>

#include "libinverse/estimator.hpp"
#include "libinverse/joint/joint_inversion.hpp"

namespace modcal {

/// What all estimators on both reactions have to be told.
struct JointOptions {
  std::string truncation = "shifted_contour";
  double sigma = std::numeric_limits<double>::quiet_NaN();  ///< [1/s]; NaN: see contour_of
  std::string offset = "arrival";
  /// Standard deviations of the noise of one sample [N]; NaN: from the record.
  double noise_rms[2] = {std::numeric_limits<double>::quiet_NaN(),
                         std::numeric_limits<double>::quiet_NaN()};
  double band_limit = std::numeric_limits<double>::quiet_NaN();  ///< [Hz]; NaN: none
  bool limit_to_top_mode = false;
  std::int64_t points = 100;
  TransferOptions transfer = {};
  SensorOptions sensors = {};

  void visit(OptionVisitor& visitor);
};

/// One force from both reactions (JointInversion); from one where the record has but one.
class JointEstimator final : public Estimator {
 public:
  struct Options {
    JointOptions joint = {};
    Choice<ForcePrior> prior{"learned"};
    void visit(OptionVisitor& visitor);
  };
  /// Throws InvalidInput for options out of range.
  explicit JointEstimator(const Options& options);

 private:
  std::shared_ptr<const PreparedEstimator> do_prepare(const EstimationModel& model) const override;
  JointOptions joint_;
  std::shared_ptr<const ForcePrior> prior_;
};

/// The linear limit: the joint estimate with the true spectrum of the force for a prior and the
/// true noise levels, an oracle. No linear estimate that knows spectra alone does better on average
/// (Wiener, 1949). For simulated records.
class LinearLimitEstimator final : public Estimator {
 public:
  struct Options {
    JointOptions joint = {};
    double bandwidth = 20.0;  ///< over which the true spectrum is smoothed [Hz]
    void visit(OptionVisitor& visitor);
  };
  /// Throws InvalidInput for options out of range.
  explicit LinearLimitEstimator(const Options& options);

 private:
  std::shared_ptr<const PreparedEstimator> do_prepare(const EstimationModel& model) const override;
  JointOptions joint_;
  double bandwidth_;
};

}  // namespace modcal
