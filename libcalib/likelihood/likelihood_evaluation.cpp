#include "libcalib/likelihood/likelihood_evaluation.hpp"

#include <algorithm>
#include <cassert>

#include "libcalib/likelihood/column_products.hpp"
#include "libcalib/likelihood/far_products.hpp"
#include "libcalib/likelihood/projected_likelihood.hpp"
#include "libsim/base/task_loop.hpp"

namespace modcal {
namespace {

constexpr std::size_t kBins = LikelihoodBlock::kBins;
constexpr std::size_t kChunks = 8;
constexpr std::size_t kSmallRecord = 16;  // blocks: below, threads cost more than they save

using Index = Eigen::Index;

Eigen::MatrixXd symmetric(const auto& lower, std::size_t count) {
  const auto n = static_cast<Index>(count);
  return Eigen::MatrixXd(lower.topLeftCorner(n, n)).template selfadjointView<Eigen::Lower>();
}

// Calls give(row, real or imaginary part's place in the block's column) for the bins of a block.
template <typename Give>
void for_rows(std::size_t b, std::size_t bins, Give give) {
  const std::size_t count = std::min(kBins, bins - b * kBins);
  for (std::size_t k = 0; k < count; ++k) {
    give(2 * (b * kBins + k), k);
    give(2 * (b * kBins + k) + 1, kBins + k);
  }
}

PlanarVector sensor_response(const WhitenedRecord& record, const SensorPair& sensors) {
  PlanarVector response(record.root_weight.size());
  for (std::size_t k = 0; k < record.bins; ++k) {
    const Complex s(record.sigma, record.omega[k]);
    response.set(k, sensors.response(s));
  }
  return response;
}

const PlanarVector* given(const std::optional<PlanarVector>& numbers) {
  return numbers ? &*numbers : nullptr;
}

double dot(const double* a, const double* b) {
  using Column = Eigen::Map<const Eigen::VectorXd>;
  const auto size = static_cast<Index>(kColumnLength);
  return Column(a, size).dot(Column(b, size));
}

std::array<std::optional<std::size_t>, 3> sensor_columns(const LikelihoodColumns& columns) {
  return {columns.gain, columns.delay, columns.corner};
}

}  // namespace

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

struct LikelihoodEvaluation::Slopes {
  double cost = 0.0;
  std::array<double, 3> sensors{};
  AlignedVector modes, columns;
};

LikelihoodEvaluation::LikelihoodEvaluation(const WhitenedRecord& record, const ModelPoint& point,
                                           bool interpolate)
    : record_(&record),
      sensors_(point.sensors),
      modes_(likelihood_modes(point, record.sample_rate)),
      splits_(record, modes_, interpolate),
      plain_(plain_transients(record, point.sensors)),
      end_state_(record, modes_, plain_.size()),
      plain_width_(tiled(plain_.size())),
      arrays_(std::move(spare())) {
  if (arrays_.blocks.size() < record.blocks()) arrays_.blocks.resize(record.blocks());
  blocks_ = std::span(arrays_.blocks).first(record.blocks());
  arrays_.first_columns.resize((1 + plain_width_) * kColumnLength * record.blocks());
  for (std::size_t n = 0; n < modes_.size(); ++n) all_modes_.push_back(n);
  if (!sensors_.alike()) sensor_ = sensor_response(record, sensors_);
  std::vector<EndState::Sums> sums(chunks());
  for_blocks([&](std::size_t chunk, std::size_t b) {
    fill_model(b, sums[chunk]);
    fill_data(b, sums[chunk]);
  });
  end_state_.solve(sums);
  apply_end_state();
}

void LikelihoodEvaluation::take(const WhitenedRecord& record) {
  assert(record.bins == record_->bins && record.sigma == record_->sigma);
  record_ = &record;
  std::vector<EndState::Sums> sums(chunks());
  for_blocks([&](std::size_t chunk, std::size_t b) { fill_data(b, sums[chunk]); });
  end_state_.solve_again(sums);
  apply_end_state();
}

LikelihoodEvaluation::~LikelihoodEvaluation() { spare() = std::move(arrays_); }

LikelihoodEvaluation::Arrays& LikelihoodEvaluation::spare() {
  static thread_local Arrays arrays;
  return arrays;
}

std::size_t LikelihoodEvaluation::chunks() const {
  return blocks_.size() < kSmallRecord ? 1 : kChunks;
}

void LikelihoodEvaluation::for_blocks(
    const std::function<void(std::size_t, std::size_t)>& work) const {
  const std::size_t count = chunks();
  const auto chunk = [&](std::size_t c) {
    const std::size_t end = (c + 1) * blocks_.size() / count;
    for (std::size_t b = c * blocks_.size() / count; b < end; ++b) work(c, b);
  };
  if (count == 1) {
    chunk(0);
  } else {
    for_each_task(count, chunk);
  }
}

void LikelihoodEvaluation::fill_model(std::size_t b, EndState::Sums& sums) {
  const ModeSplit split = splits_.of(b);
  fill_block(*record_, b, split, given(sensor_), blocks_[b]);
  for (std::size_t p = 0; p < plain_.size(); ++p) {
    fill_plain_column(*record_, b, blocks_[b], plain_[p].right, plain_[p].numbers,
                      plain_of(b) + p * kColumnLength);
  }
  end_state_.add_gram(*record_, b, split, blocks_[b], sums);
}

void LikelihoodEvaluation::fill_data(std::size_t b, EndState::Sums& sums) {
  fill_residual(*record_, b, blocks_[b], residual_of(b));
  end_state_.add_products(*record_, b, splits_.of(b), blocks_[b], residual_of(b), sums);
}

// What the amplitudes decide beside the residual.
void LikelihoodEvaluation::apply_end_state() {
  const std::span<const Complex> amplitudes = end_state_.amplitudes();
  by_frequency_.clear();
  by_damping_.clear();
  for (std::size_t n = 0; n < amplitudes.size(); ++n) {
    by_frequency_.push_back(amplitudes[n] * modes_[n].pole_by_frequency);
    by_damping_.push_back(amplitudes[n] * modes_[n].pole_by_damping);
  }
  sum_plain();
}

void LikelihoodEvaluation::sum_plain() {
  plain_sums_[0].reset();
  plain_sums_[1].reset();
  by_corner_.reset();
  const auto add = [this](const PlanarVector& numbers, double amplitude,
                          std::optional<PlanarVector>& sum) {
    if (numbers.size() == 0) return;
    if (!sum) sum.emplace(record_->root_weight.size());
    for (std::size_t k = 0; k < record_->bins; ++k) {
      sum->set(k, sum->at(k) + amplitude * numbers.at(k));
    }
  };
  for (std::size_t p = 0; p < plain_.size(); ++p) {
    add(plain_[p].numbers, end_state_.plain_amplitude(p), plain_sums_[plain_[p].right ? 1 : 0]);
    add(plain_[p].by_corner, end_state_.plain_amplitude(p), by_corner_);
  }
}

ColumnTask LikelihoodEvaluation::column_task(const LikelihoodColumns& columns) const {
  return {.by_frequency = by_frequency_,
          .by_damping = by_damping_,
          .shares = columns.shares,
          .share_begin = columns.share_begin,
          .count = columns.count,
          .contact = columns.contact.value_or(columns.count)};
}

// The residual of a block, its force and the sensors' columns.
void LikelihoodEvaluation::finish(std::size_t b, const std::array<double*, 3>& sensors) {
  if (end_state_.decays() > 0) {
    fill_decays(*record_, b, splits_.of(b), end_state_.amplitudes(), blocks_[b]);
  }
  finish_residual(*record_, b,
                  {.decays = end_state_.decays() > 0,
                   .sensor = given(sensor_),
                   .plain = {given(plain_sums_[0]), given(plain_sums_[1])},
                   .plain_by_corner = given(by_corner_),
                   .corner = sensors_.corner,
                   .sensors = sensors,
                   .residual = residual_of(b)},
                  blocks_[b]);
}

LikelihoodPoint LikelihoodEvaluation::slope(const LikelihoodColumns& columns) {
  const auto sensors = sensor_columns(columns);
  std::vector<Slopes> parts(chunks());
  for_blocks([&](std::size_t chunk, std::size_t b) {
    Slopes& part = parts[chunk];
    if (part.modes.empty()) {
      part.modes.resize(modes_.size() * kSlopeSums * kSumLanes);
      part.columns.resize(3 * kColumnLength);
    }
    std::array<double*, 3> places{};
    for (std::size_t i = 0; i < 3; ++i) {
      if (sensors[i]) places[i] = part.columns.data() + i * kColumnLength;
    }
    finish(b, places);
    const double* residual = residual_of(b);
    part.cost += dot(residual, residual);
    for (std::size_t i = 0; i < 3; ++i) {
      if (places[i]) part.sensors[i] += dot(places[i], residual);
    }
    if (columns.count == 0) return;
    add_mode_slopes(*record_, b, splits_.of(b), blocks_[b], end_state_.decays() > 0, residual,
                    part.modes.data());
  });
  Slopes sum = std::move(parts[0]);
  for (std::size_t c = 1; c < parts.size(); ++c) {
    sum.cost += parts[c].cost;
    for (std::size_t i = 0; i < 3; ++i) sum.sensors[i] += parts[c].sensors[i];
    for (std::size_t i = 0; i < sum.modes.size(); ++i) sum.modes[i] += parts[c].modes[i];
  }
  LikelihoodPoint point{.cost = sum.cost,
                        .slope = Eigen::VectorXd::Zero(static_cast<Index>(columns.count))};
  if (columns.count == 0) return point;
  std::vector<ModeSlopes> slopes(modes_.size());
  collect_mode_slopes(sum.modes.data(), modes_, column_task(columns), slopes);
  for (std::size_t n = 0; n < modes_.size(); ++n) {
    for (std::size_t i = columns.share_begin[n]; i < columns.share_begin[n + 1]; ++i) {
      const ColumnShare& share = columns.shares[i];
      point.slope[static_cast<Index>(share.column)] +=
          share.frequency * slopes[n].by_frequency + share.damping * slopes[n].by_damping;
    }
    if (columns.contact) point.slope[static_cast<Index>(*columns.contact)] += slopes[n].by_contact;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    if (sensors[i]) point.slope[static_cast<Index>(*sensors[i])] = sum.sensors[i];
  }
  return point;
}

void LikelihoodEvaluation::fill_columns(std::size_t b, const LikelihoodColumns& columns,
                                        double* jacobian) {
  std::fill_n(jacobian, tiled(columns.count + 1) * kColumnLength, 0.0);
  std::array<double*, 3> sensors{};
  const auto places = sensor_columns(columns);
  for (std::size_t i = 0; i < 3; ++i) {
    if (places[i]) sensors[i] = jacobian + *places[i] * kColumnLength;
  }
  finish(b, sensors);
  std::copy_n(residual_of(b), kColumnLength, jacobian + columns.count * kColumnLength);
  if (columns.shares.empty() && !columns.contact) return;
  ColumnTask task = column_task(columns);
  task.jacobian = jacobian;
  if (columns.count <= kSharedColumns) {
    fill_shared_columns(*record_, b, splits_.of(b), blocks_[b], task);
  } else {
    fill_mode_columns(*record_, b, modes_, blocks_[b], task);
  }
}

// Columns of the end state, of one block: decays of the modes in a list, plain transients.
std::size_t LikelihoodEvaluation::fill_state(std::size_t b, std::span<const std::size_t> list,
                                             AlignedVector& state) {
  const std::size_t decays = end_state_.decays() > 0 ? 2 * list.size() : 0;
  const std::size_t room = tiled(decays + plain_.size()) * kColumnLength;
  if (state.size() < room) state.resize(room);
  if (decays > 0) fill_decay_columns(*record_, b, modes_, list, blocks_[b], state.data());
  std::copy_n(plain_of(b), plain_.size() * kColumnLength,
              state.begin() + static_cast<long>(decays * kColumnLength));
  return decays;
}

// With the columns of the end state, which are rows here: those of near modes and plain transients
// in the bins, those of far modes at the nodes.
void LikelihoodEvaluation::add_state_products(std::size_t b, const LikelihoodColumns& columns,
                                              double* jacobian, Products& sums) {
  const ModeSplit split = splits_.of(b);
  const bool nodes = end_state_.decays() > 0 && split.has_far() && columns.count <= kFarColumns;
  const std::span<const std::size_t> list = nodes ? split.all_near() : all_modes_;
  const std::size_t decays = fill_state(b, list, sums.state);
  const std::size_t rows = decays + plain_.size();
  const std::size_t stride = product_stride(columns.count);
  RowMatrix found = RowMatrix::Zero(static_cast<Index>(tiled(rows)), static_cast<Index>(stride));
  add_products(sums.state.data(), tiled(rows), jacobian, tiled(columns.count), false, found.data(),
               stride);
  for (std::size_t i = 0; i < rows; ++i) {
    const std::size_t row =
        i < decays ? 2 * list[i / 2] + i % 2 : 2 * end_state_.decays() + i - decays;
    for (std::size_t j = 0; j < columns.count; ++j) {
      sums.mixed[row * stride + j] += found(static_cast<Index>(i), static_cast<Index>(j));
    }
  }
  if (!nodes) return;
  ColumnTask task = column_task(columns);
  task.jacobian = jacobian;
  add_far_products(*record_, b, split, blocks_[b], task, sums.mixed.data());
}

// With the columns of the end state.
void LikelihoodEvaluation::add_cross_products(std::size_t b, const LikelihoodColumns& columns,
                                              const Columns& work, double* jacobian,
                                              Products& sums) {
  if (!work.shared()) {
    add_state_products(b, columns, jacobian, sums);
    return;
  }
  if (end_state_.decays() > 0) {
    add_decay_products(*record_, b, splits_.of(b), blocks_[b], jacobian, work.count,
                       sums.decays.data());
  }
  add_products(jacobian, work.width, plain_of(b), plain_width_, false, sums.plain.data(),
               plain_width_);
}

Eigen::MatrixXd LikelihoodEvaluation::cross_products(const Columns& work,
                                                     const Products& sums) const {
  const auto n = static_cast<Index>(work.count);
  const auto size = static_cast<Index>(end_state_.size());
  const auto plain = static_cast<Index>(plain_.size());
  if (!work.shared()) {
    const auto stride = static_cast<Index>(product_stride(work.count));
    return Eigen::Map<const RowMatrix>(sums.mixed.data(), size, stride).leftCols(n);
  }
  RowMatrix cross(size, n);
  if (end_state_.decays() > 0) {
    collect_decay_products(sums.decays.data(), end_state_.decays(), work.count, cross.data());
  }
  cross.bottomRows(plain) = sums.plain.topLeftCorner(n, plain).transpose();
  return cross;
}

LikelihoodPoint LikelihoodEvaluation::differentiate(const LikelihoodColumns& columns,
                                                    const LikelihoodOutputs& outputs) {
  assert(columns.count == 0 || columns.share_begin.size() == modes_.size() + 1);
  const bool keep = outputs.jacobian || outputs.twice_weighted;
  Columns work(columns.count, keep ? blocks_.size() : chunks(), keep, arrays_.columns);
  const auto n = static_cast<Index>(work.count);
  const auto width = static_cast<Index>(work.width);
  std::vector<Products> parts(chunks());
  for (Products& part : parts) {
    part.own = RowMatrix::Zero(width, width);
    if (work.shared()) {
      part.decays.resize(end_state_.decays() * 2 * work.count * kSumLanes);
      part.plain = RowMatrix::Zero(width, static_cast<Index>(plain_width_));
    } else {
      part.mixed.resize(end_state_.size() * product_stride(work.count));
    }
  }
  for_blocks([&](std::size_t chunk, std::size_t b) {
    double* jacobian = work.of(chunk, b);
    fill_columns(b, columns, jacobian);
    add_products(jacobian, work.width, jacobian, work.width, true, parts[chunk].own.data(),
                 work.width);
    if (work.count > 0) add_cross_products(b, columns, work, jacobian, parts[chunk]);
  });
  Products sum = std::move(parts[0]);
  for (std::size_t c = 1; c < parts.size(); ++c) {
    sum.own += parts[c].own;
    sum.plain += parts[c].plain;
    for (std::size_t i = 0; i < sum.mixed.size(); ++i) sum.mixed[i] += parts[c].mixed[i];
    for (std::size_t i = 0; i < sum.decays.size(); ++i) sum.decays[i] += parts[c].decays[i];
  }
  const Eigen::MatrixXd products = symmetric(sum.own, work.count + 1);
  LikelihoodPoint point{.cost = products(n, n), .slope = products.col(n).head(n)};
  give(outputs);
  if (n == 0) return point;
  const Eigen::MatrixXd cross = cross_products(work, sum);
  const Eigen::MatrixXd fit = end_state_.fit(cross);
  point.information = products.topLeftCorner(n, n) - cross.transpose() * fit;
  if (keep) project_columns(work, fit, outputs, point);
  return point;
}

void LikelihoodEvaluation::project_block(std::size_t b, const Eigen::MatrixXd& fit,
                                         const RowMatrix& factors, Columns& work,
                                         AlignedVector& state) {
  double* jacobian = work.of(0, b);
  if (!work.shared()) {
    fill_state(b, all_modes_, state);
    subtract_columns(state.data(), end_state_.size(), factors.data(), work.width, jacobian);
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
  subtract_columns(plain_of(b), plain_.size(),
                   factors.data() + 2 * end_state_.decays() * work.width, work.width, jacobian);
}

void LikelihoodEvaluation::project_columns(Columns& work, const Eigen::MatrixXd& fit,
                                           const LikelihoodOutputs& outputs,
                                           LikelihoodPoint& point) {
  const auto width = static_cast<Index>(work.width);
  RowMatrix factors = RowMatrix::Zero(fit.rows(), width);
  factors.leftCols(fit.cols()) = fit;
  if (outputs.jacobian) outputs.jacobian->resize(static_cast<long>(2 * record_->bins), fit.cols());
  struct Part {
    RowMatrix twice;
    AlignedVector state;
  };
  std::vector<Part> parts(chunks());
  for (Part& part : parts) part.twice = RowMatrix::Zero(width, width);
  for_blocks([&](std::size_t chunk, std::size_t b) {
    double* jacobian = work.of(chunk, b);
    project_block(b, fit, factors, work, parts[chunk].state);
    for (std::size_t i = 0; outputs.jacobian && i < work.count; ++i) {
      for_rows(b, record_->bins, [&](std::size_t row, std::size_t at) {
        (*outputs.jacobian)(static_cast<long>(row), static_cast<long>(i)) =
            jacobian[i * kColumnLength + at];
      });
    }
    if (!outputs.twice_weighted) return;
    scale_columns(record_->root_weight.data() + b * kBins, work.width, jacobian);
    add_products(jacobian, work.width, jacobian, work.width, true, parts[chunk].twice.data(),
                 work.width);
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
    outputs.residuals->resize(2 * record_->bins);
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      for_rows(b, record_->bins, [&](std::size_t row, std::size_t at) {
        (*outputs.residuals)[row] = residual_of(b)[at];
      });
    }
  }
  if (outputs.force) {
    outputs.force->resize(record_->bins);
    for (std::size_t k = 0; k < record_->bins; ++k) {
      const LikelihoodBlock::Planar& force = blocks_[k / kBins].force;
      (*outputs.force)[k] = {force.re[k % kBins], force.im[k % kBins]};
    }
  }
  if (!outputs.gain) return;
  outputs.gain->resize(record_->bins);
  for (std::size_t k = 0; k < record_->bins; ++k) {
    (*outputs.gain)[k] = 1.0 / blocks_[k / kBins].norm[k % kBins];
  }
}

}  // namespace modcal
