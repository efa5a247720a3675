// One evaluation of the likelihood of a pluck: passes over the blocks of bins.
#pragma once

#include <vector>

#include "libcalib/likelihood/likelihood_outputs.hpp"
#include "libcalib/likelihood/plain_transients.hpp"
#include "libsim/base/dense_solvers.hpp"

namespace modcal {

/// First pass: products of the decays' columns with each other and the data, and the amplitudes
/// that fit best. Second pass: columns of the Jacobian.
class PluckEvaluation {
 public:
  /// `record` must outlive this.
  PluckEvaluation(const WhitenedRecord& record, const ModelPoint& point);

  double cost() const { return cost_; }
  std::size_t linear_unknowns() const { return 2 * modes_.size() + plain_.size(); }
  LikelihoodPoint differentiate(const LikelihoodColumns& columns,
                                const LikelihoodOutputs& outputs) const;

 private:
  using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  static constexpr std::size_t kBins = WhitenedRecord::kBlock;

  /// U and U' of one mode in one block, zero in the padding; W = U² − U = z^−1 E ∂U/∂E.
  struct Decay {
    alignas(64) double re[4][kBins], im[4][kBins];  // U, U', W, W'
  };
  enum Part { kLevel = 0, kSlope = 2 };
  struct Mode {
    Complex pole;
    Complex by_frequency, by_damping;  ///< ∂ln E/∂ln ω_n, ∂ln E/∂ln ζ_n
    /// Factor of c_n at x = L, and its derivatives by ln ω_n, ln ζ_n and the sensor's numbers.
    Complex right, right_by_frequency, right_by_damping, right_by_sensor[Sensor::kCount];
    SmoothResponse::Place knots;  ///< of the sensor's smooth response at the mode's frequency
  };

  static Mode mode_of(const LikelihoodMode& mode, const Sensor& sensors, double sample_rate,
                      double scale);
  void fill(std::size_t block, std::size_t mode, bool slopes, Decay& decay) const;
  /// column += a part + conj(a) part'.
  static void add(const Decay& decay, Part part, Complex a, double* column);
  void fill_linear(std::size_t block, double* left, double* right) const;
  void fill_plain(std::size_t block, const PlanarVector& numbers, double factor,
                  double* column) const;
  void solve(const RowMatrix& products);
  /// Residuals and Jacobian as far as they are asked for; taken: what the linear unknowns take of
  /// each column.
  void write_rows(const LikelihoodColumns& columns, const Eigen::MatrixXd& taken,
                  const LikelihoodOutputs& outputs) const;
  void fill_jacobian(std::size_t block, const LikelihoodColumns& columns, double* left,
                     double* right) const;
  void add_knots(const LikelihoodColumns& columns, std::size_t mode, const Decay& decay,
                 double* right) const;
  void add_mode(const LikelihoodColumns& columns, std::size_t mode, const Decay& decay,
                double* left, double* right) const;

  const WhitenedRecord& record_;
  std::vector<Mode> modes_;
  std::vector<PlainTransient> plain_;
  Eigen::VectorXd scale_;  // 1 over the norms of the linear columns
  PositiveSolver normal_;
  Eigen::VectorXd linear_;  // their factors
  std::vector<Complex> amplitudes_;
  double cost_ = 0.0;
};

}  // namespace modcal
