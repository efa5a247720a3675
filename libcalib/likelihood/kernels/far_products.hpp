// Kernel of the products between the Jacobian's columns and the decays of modes far from a block.
#pragma once

#include <cstddef>

#include "libcalib/likelihood/kernels/mode_columns.hpp"

namespace modcal {

/// Most columns that add_far_products() takes.
/// Fixed by: length of the kernel's arrays; more columns go without it.
inline constexpr std::size_t kFarColumns = 256;

/// From one row of products to the next: whole vectors.
constexpr std::size_t product_stride(std::size_t columns) {
  return (columns + kVectorPadding - 1) / kVectorPadding * kVectorPadding;
}

/// Adds Σ x_n J_i to products[2n·stride + i] and Σ x'_n J_i to products[(2n + 1)·stride + i] for
/// the far modes n of a block, in its nodes: columns that far modes alone share are products of
/// smooth functions and of few weights there; the others, filled in task.jacobian, go through their
/// own weights. stride: product_stride(task.count).
void add_far_products(const WhitenedRecord& record, std::size_t block_index, const ModeSplit& split,
                      const LikelihoodBlock& block, const ColumnTask& task, double* products);

}  // namespace modcal
