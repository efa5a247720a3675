// What the passes of an evaluation with columns have in hand.
#pragma once

#include "libcalib/likelihood/column_products.hpp"
#include "libcalib/likelihood/likelihood_evaluation.hpp"

namespace modcal {

// The Jacobian's columns, the residual behind them; where they are not kept, one block a chunk.
struct LikelihoodEvaluation::Columns {
  Columns(std::size_t column_count, std::size_t pieces, bool keep, AlignedVector& room)
      : count(column_count), width(tiled(column_count + 1)), kept(keep) {
    if (room.size() < width * kColumnLength * pieces) room.resize(width * kColumnLength * pieces);
    numbers = room.data();
  }
  double* of(std::size_t chunk, std::size_t b) {
    return numbers + (kept ? b : chunk) * width * kColumnLength;
  }
  bool shared() const { return count <= kSharedColumns; }

  std::size_t count, width;
  bool kept;
  double* numbers;
};

// Sums over the blocks of a chunk.
struct LikelihoodEvaluation::Products {
  RowMatrix own, plain;
  AlignedVector mixed, decays, state;
};

inline Eigen::MatrixXd symmetric(const auto& lower, std::size_t count) {
  const auto n = static_cast<Eigen::Index>(count);
  return Eigen::MatrixXd(lower.topLeftCorner(n, n)).template selfadjointView<Eigen::Lower>();
}

}  // namespace modcal
