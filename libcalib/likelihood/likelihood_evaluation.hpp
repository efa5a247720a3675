// One evaluation of the joint likelihood: passes over the blocks of bins.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "libcalib/likelihood/end_state.hpp"
#include "libcalib/likelihood/kernels/likelihood_kernel.hpp"
#include "libcalib/likelihood/kernels/mode_columns.hpp"
#include "libcalib/likelihood/likelihood_outputs.hpp"

namespace modcal {

/// First pass: transfer functions, data residual and the end state that fits best. Second pass:
/// residual and, as asked for, its products with the columns of the Jacobian, or the columns and
/// their products with each other and with those of the end state. Third pass, where asked for: the
/// columns with the end state projected out.
///
/// Blocks are spread over the threads that oneTBB is allowed, in chunks whose number depends on the
/// record alone; their sums are added up in one order: the same bits for any number of threads.
class LikelihoodEvaluation {
 public:
  /// `record` must outlive this. interpolate: far modes at nodes alone (mode_split.hpp).
  LikelihoodEvaluation(const WhitenedRecord& record, const ModelPoint& point,
                       bool interpolate = true);
  ~LikelihoodEvaluation();
  LikelihoodEvaluation(const LikelihoodEvaluation&) = delete;
  LikelihoodEvaluation& operator=(const LikelihoodEvaluation&) = delete;

  /// The same model with other data of the same bins and weights, whose transfer functions, decays
  /// and Gram matrix serve again. `record` must outlive this.
  void take(const WhitenedRecord& record);

  /// Call one of these, once for each record.
  LikelihoodPoint differentiate(const LikelihoodColumns& columns, const LikelihoodOutputs& outputs);
  /// Cost and slope alone; no column is formed.
  LikelihoodPoint slope(const LikelihoodColumns& columns);
  /// Cost, slope and, as rows of `information`, those of the information of the unknowns `wanted`:
  /// some, and few enough for that to be worth while (may_give_rows()).
  LikelihoodPoint rows(const LikelihoodColumns& columns, std::span<const std::size_t> wanted);
  static bool may_give_rows(const LikelihoodColumns& columns, std::span<const std::size_t> wanted);

 private:
  using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  /// Large arrays, which a thread keeps from one evaluation to the next: pages that are new to a
  /// process cost as much as what is computed in them.
  struct Arrays {
    std::vector<LikelihoodBlock> blocks;
    AlignedVector first_columns, columns;
  };
  static Arrays& spare();
  struct BlockColumns;
  struct Columns;
  struct Products;
  struct Slopes;
  /// Residual and columns of the plain transients: a block's, one after the other.
  double* residual_of(std::size_t b) {
    return arrays_.first_columns.data() + b * (1 + plain_width_) * kColumnLength;
  }
  double* plain_of(std::size_t b) { return residual_of(b) + kColumnLength; }
  std::size_t chunks() const;
  /// Calls work(chunk, block) for every block, chunks side by side.
  void for_blocks(const std::function<void(std::size_t, std::size_t)>& work) const;
  void fill_model(std::size_t b, EndState::Sums& sums);
  void fill_data(std::size_t b, EndState::Sums& sums);
  void apply_end_state();
  void sum_plain();
  ColumnTask column_task(const LikelihoodColumns& columns) const;
  using SensorPlaces = std::array<double*, Sensor::kCount>;
  void prepare_sensor(const LikelihoodColumns& columns);
  void finish(std::size_t b, const SensorPlaces& sensors);
  BlockColumns columns_of(std::size_t b, const LikelihoodColumns& columns) const;
  std::size_t most_columns(const LikelihoodColumns& columns) const;
  void fill_columns(std::size_t b, const LikelihoodColumns& columns, const BlockColumns& own,
                    double* jacobian);
  void add_knot_slopes(std::size_t b, const double* by_gain, std::vector<Complex>& knots);
  void fill_response(std::size_t b, const BlockColumns& own, const double* by_gain,
                     double* jacobian) const;
  Products multiply_columns(const LikelihoodColumns& columns, Columns& work,
                            const std::function<void(std::size_t, std::size_t)>& also);
  Eigen::MatrixXd project_rows(Columns& work, const Eigen::MatrixXd& fit, std::size_t count,
                               const LikelihoodColumns& columns);
  /// Products with what every unknown's column is made of, from the sums of add_mode_slopes().
  Eigen::VectorXd mode_products(const double* sums, const LikelihoodColumns& columns) const;
  Eigen::VectorXd end_state_slope(const LikelihoodColumns& columns) const;
  void add_end_state(const LikelihoodColumns& columns, LikelihoodPoint& point) const;
  void add_own_products(const BlockColumns& own, std::size_t all, const double* jacobian,
                        Products& sums) const;
  void add_cross_products(std::size_t b, const LikelihoodColumns& columns, const BlockColumns& own,
                          double* jacobian, Products& sums);
  void add_state_products(std::size_t b, const LikelihoodColumns& columns, const BlockColumns& own,
                          double* jacobian, Products& sums);
  void add_decays_of_response(std::size_t b, const BlockColumns& own, std::size_t all,
                              const double* jacobian, Products& sums);
  Eigen::MatrixXd cross_products(const Columns& work, const Products& sums) const;
  static double* spread(const BlockColumns& own, std::size_t all, const double* jacobian,
                        AlignedVector& columns);
  void project_columns(const LikelihoodColumns& columns, Columns& work, const Eigen::MatrixXd& fit,
                       const LikelihoodOutputs& outputs, LikelihoodPoint& point);
  void project_block(std::size_t b, const Eigen::MatrixXd& fit, const RowMatrix& factors,
                     bool shared, double* jacobian, AlignedVector& state);
  std::size_t fill_state(std::size_t b, std::span<const std::size_t> list, AlignedVector& state);
  void give(const LikelihoodOutputs& outputs);

  const WhitenedRecord* record_;
  Sensor sensors_;
  std::vector<LikelihoodMode> modes_;
  ModeSplits splits_;
  std::vector<PlainTransient> plain_;
  EndState end_state_;
  std::size_t plain_width_;
  std::vector<std::size_t> decaying_;  // modes of the end state
  Arrays arrays_;
  std::span<LikelihoodBlock> blocks_;
  std::optional<PlanarVector> sensor_;         // where the sensors differ
  std::optional<PlanarVector> plain_sums_[2];  // plain transients with their amplitudes
  // By the numbers of the sensor: their derivative, and that of ln S where it is asked for.
  std::array<std::optional<PlanarVector>, Sensor::kCount> plain_slopes_, sensor_slopes_;
  std::vector<Complex> by_frequency_, by_damping_;  // c_n times the derivatives of E_n
};

}  // namespace modcal
