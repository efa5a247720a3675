// What the passes of an evaluation with columns have in hand.
#pragma once

#include "libcalib/likelihood/likelihood_evaluation.hpp"
#include "libsim/base/kernels/column_products.hpp"

namespace modcal {

// The columns that one block has: of the response those of the knots that reach into it.
struct LikelihoodEvaluation::BlockColumns {
  std::size_t common = 0, first_knot = 0, knots = 0;
  std::size_t count() const { return common + 2 * knots; }
  std::size_t width() const { return tiled(count() + 1); }
  // Among all columns; the residual stands behind them.
  std::size_t place(std::size_t i, std::size_t all) const {
    return i < common ? i : i < count() ? i + 2 * first_knot : all;
  }
};

// The Jacobian's columns, the residual behind them; where they are not kept, one block a chunk.
struct LikelihoodEvaluation::Columns {
  // most: of one block.
  Columns(const LikelihoodColumns& columns, std::size_t most, std::size_t pieces, bool keep,
          AlignedVector& room)
      : count(columns.count), common(columns.common()), width(tiled(most + 1)), kept(keep) {
    if (room.size() < width * kColumnLength * pieces) room.resize(width * kColumnLength * pieces);
    numbers = room.data();
  }
  double* of(std::size_t chunk, std::size_t b) {
    return numbers + (kept ? b : chunk) * width * kColumnLength;
  }
  bool shared() const { return common <= kSharedColumns; }
  bool has_response() const { return common < count; }

  std::size_t count, common, width;
  bool kept;
  double* numbers;
};

// Sums over the blocks of a chunk.
struct LikelihoodEvaluation::Products {
  RowMatrix own, plain;
  AlignedVector mixed, decays, state;
  AlignedVector block;  // of one block's columns, before they are added to those of all
};

inline Eigen::MatrixXd symmetric(const auto& lower, std::size_t count) {
  const auto n = static_cast<Eigen::Index>(count);
  return Eigen::MatrixXd(lower.topLeftCorner(n, n)).template selfadjointView<Eigen::Lower>();
}

}  // namespace modcal
