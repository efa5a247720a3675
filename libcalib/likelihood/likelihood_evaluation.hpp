// One evaluation of the joint likelihood: passes over the blocks of bins.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "libcalib/likelihood/end_state.hpp"
#include "libcalib/likelihood/likelihood_kernel.hpp"
#include "libcalib/likelihood/likelihood_outputs.hpp"

namespace modcal {

/// First pass: transfer functions, data residual and the end state that fits best. Second pass:
/// columns of the Jacobian and their products with each other and with those of the end state.
/// Third pass, where asked for: the columns with the end state projected out.
class LikelihoodEvaluation {
 public:
  /// `record` must outlive this.
  LikelihoodEvaluation(const WhitenedRecord& record, const ModelPoint& point);

  LikelihoodPoint differentiate(const LikelihoodColumns& columns, const LikelihoodOutputs& outputs);

 private:
  using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  struct Columns;
  double* residual_of(std::size_t b) { return residual_.data() + b * kColumnLength; }
  double* plain_of(std::size_t b) {
    return plain_columns_.data() + b * plain_.size() * kColumnLength;
  }
  const double* state_columns(std::size_t b, bool wanted);
  void fill_columns(std::size_t b, const LikelihoodColumns& columns, double* jacobian,
                    std::complex<double>* force);
  void project_columns(Columns& work, const Eigen::MatrixXd& fit, const LikelihoodOutputs& outputs,
                       LikelihoodPoint& point);
  void give(const LikelihoodOutputs& outputs) const;

  void sum_plain();

  const WhitenedRecord& record_;
  SensorPair sensors_;
  std::vector<LikelihoodMode> modes_;
  std::vector<PlainTransient> plain_;
  EndState end_state_;
  std::size_t state_width_;
  std::vector<LikelihoodBlock> blocks_;
  std::optional<PlanarVector> sensor_;         // where the sensors differ
  std::optional<PlanarVector> plain_sums_[2];  // plain transients with their amplitudes
  std::optional<PlanarVector> by_corner_;      // and their derivative by the sensor's corner
  AlignedVector residual_;                     // one column a block
  AlignedVector plain_columns_;                // of the plain transients, every block
  AlignedVector state_;                        // all columns of the end state, of one block
};

}  // namespace modcal
