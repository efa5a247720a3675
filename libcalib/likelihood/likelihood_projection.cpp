// The columns of one evaluation with the end state projected out, and what is given of the blocks.
#include <algorithm>
#include <cmath>

#include "libcalib/likelihood/likelihood_work.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

// Calls give(row, real or imaginary part's place in the block's column) for the bins of a block.
template <typename Give>
void for_rows(std::size_t b, std::size_t bins, Give give) {
  const std::size_t count = std::min(LikelihoodBlock::kBins, bins - b * LikelihoodBlock::kBins);
  for (std::size_t k = 0; k < count; ++k) {
    give(2 * (b * LikelihoodBlock::kBins + k), k);
    give(2 * (b * LikelihoodBlock::kBins + k) + 1, LikelihoodBlock::kBins + k);
  }
}

}  // namespace

// A block's own columns among all of them; what it has not is 0.
double* LikelihoodEvaluation::spread(const BlockColumns& own, std::size_t all,
                                     const double* jacobian, AlignedVector& columns) {
  columns.assign(tiled(all + 1) * kColumnLength, 0.0);
  for (std::size_t i = 0; i < own.count(); ++i) {
    std::copy_n(jacobian + i * kColumnLength, kColumnLength,
                columns.begin() + static_cast<long>(own.place(i, all) * kColumnLength));
  }
  return columns.data();
}

// All columns of a block; shared: few enough to take the decays from each by itself.
void LikelihoodEvaluation::project_block(std::size_t b, const Eigen::MatrixXd& fit,
                                         const RowMatrix& factors, bool shared, double* jacobian,
                                         AlignedVector& state) {
  const auto width = static_cast<std::size_t>(factors.cols());
  if (!shared) {
    fill_state(b, decaying_, state);
    subtract_columns(state.data(), end_state_.size(), factors.data(), width, jacobian);
    return;
  }
  const auto decays = static_cast<Index>(end_state_.decays());
  std::vector<Complex> amplitudes(end_state_.decays());
  for (Index i = 0; decays > 0 && i < fit.cols(); ++i) {
    for (Index m = 0; m < decays; ++m) {
      amplitudes[static_cast<std::size_t>(m)] = Complex(fit(2 * m, i), fit(2 * m + 1, i));
    }
    subtract_decays(*record_, b, splits_.of(b), amplitudes, blocks_[b],
                    jacobian + i * static_cast<Index>(kColumnLength));
  }
  subtract_columns(plain_of(b), plain_.size(), factors.data() + 2 * end_state_.decays() * width,
                   width, jacobian);
}

void LikelihoodEvaluation::project_columns(const LikelihoodColumns& columns, Columns& work,
                                           const Eigen::MatrixXd& fit,
                                           const LikelihoodOutputs& outputs,
                                           LikelihoodPoint& point) {
  const std::size_t full = tiled(work.count + 1);
  const auto width = static_cast<Index>(full);
  RowMatrix factors = RowMatrix::Zero(fit.rows(), width);
  factors.leftCols(fit.cols()) = fit;
  if (outputs.jacobian) {
    outputs.jacobian->resize(static_cast<Index>(2 * record_->bins + 1), fit.cols());
    outputs.jacobian->bottomRows(1) =
        end_state_.root_slope(end_state_slope(columns), fit).transpose();
  }
  struct Part {
    RowMatrix twice;
    AlignedVector state, columns;
  };
  std::vector<Part> parts(chunks());
  for (Part& part : parts) part.twice = RowMatrix::Zero(width, width);
  for_blocks([&](std::size_t chunk, std::size_t b) {
    double* jacobian = work.of(chunk, b);
    if (work.has_response()) {
      jacobian = spread(columns_of(b, columns), work.count, jacobian, parts[chunk].columns);
    }
    const bool shared = work.shared() && !work.has_response();
    project_block(b, fit, factors, shared, jacobian, parts[chunk].state);
    for (std::size_t i = 0; outputs.jacobian && i < work.count; ++i) {
      for_rows(b, record_->bins, [&](std::size_t row, std::size_t at) {
        (*outputs.jacobian)(static_cast<long>(row), static_cast<long>(i)) =
            jacobian[i * kColumnLength + at];
      });
    }
    if (!outputs.twice_weighted) return;
    scale_columns(record_->root_weight.data() + b * LikelihoodBlock::kBins, full, jacobian);
    add_products(jacobian, full, jacobian, full, true, parts[chunk].twice.data(), full);
  });
  if (!outputs.twice_weighted) return;
  RowMatrix twice = parts[0].twice;
  for (std::size_t c = 1; c < parts.size(); ++c) twice += parts[c].twice;
  point.twice_weighted = symmetric(twice, work.count);
}

// What the passes leave in the blocks.
void LikelihoodEvaluation::give(const LikelihoodOutputs& outputs) {
  if (outputs.amplitudes) {
    outputs.amplitudes->assign(end_state_.amplitudes().begin(), end_state_.amplitudes().end());
  }
  if (outputs.residuals) {
    outputs.residuals->resize(2 * record_->bins + 1);
    outputs.residuals->back() = std::sqrt(end_state_.cost());
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      for_rows(b, record_->bins, [&](std::size_t row, std::size_t at) {
        (*outputs.residuals)[row] = residual_of(b)[at];
      });
    }
  }
  const auto give_bins = [this](std::vector<Complex>* numbers,
                                LikelihoodBlock::Planar LikelihoodBlock::*member) {
    if (!numbers) return;
    numbers->resize(record_->bins);
    for (std::size_t k = 0; k < record_->bins; ++k) {
      const LikelihoodBlock::Planar& of_block = blocks_[k / LikelihoodBlock::kBins].*member;
      (*numbers)[k] = {of_block.re[k % LikelihoodBlock::kBins],
                       of_block.im[k % LikelihoodBlock::kBins]};
    }
  };
  give_bins(outputs.force, &LikelihoodBlock::force);
  give_bins(outputs.left, &LikelihoodBlock::left);
  give_bins(outputs.right, &LikelihoodBlock::right);
  if (!outputs.gain) return;
  outputs.gain->resize(record_->bins);
  for (std::size_t k = 0; k < record_->bins; ++k) {
    (*outputs.gain)[k] =
        1.0 / (blocks_[k / LikelihoodBlock::kBins].norm[k % LikelihoodBlock::kBins] *
               record_->noise_at(k).determinant());
  }
}

}  // namespace modcal
