#include "libcalib/likelihood/likelihood_evaluation.hpp"

#include <algorithm>
#include <cassert>

#include "libcalib/likelihood/projected_likelihood.hpp"
#include "libcalib/likelihood/tuning.hpp"
#include "libsim/base/kernels/column_products.hpp"
#include "libsim/base/task_loop.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

// A function of s in every bin.
template <typename Function>
PlanarVector in_bins(const WhitenedRecord& record, const Function& function) {
  PlanarVector numbers(record.root_weight.size());
  for (std::size_t k = 0; k < record.bins; ++k) {
    numbers.set(k, function(Complex(record.sigma, record.omega[k])));
  }
  return numbers;
}

const PlanarVector* given(const std::optional<PlanarVector>& numbers) {
  return numbers ? &*numbers : nullptr;
}

double dot(const double* a, const double* b) {
  using Column = Eigen::Map<const Eigen::VectorXd>;
  const auto size = static_cast<Index>(kColumnLength);
  return Column(a, size).dot(Column(b, size));
}

}  // namespace

struct LikelihoodEvaluation::Slopes {
  double cost = 0.0;
  std::array<double, Sensor::kCount> sensors{};
  AlignedVector modes, columns;
  std::vector<Complex> knots;
};

LikelihoodEvaluation::LikelihoodEvaluation(const WhitenedRecord& record, const ModelPoint& point,
                                           bool interpolate)
    : record_(&record),
      sensors_(point.sensors),
      modes_(likelihood_modes(point, record.sample_rate)),
      splits_(record, modes_, interpolate),
      plain_(plain_transients(record, point)),
      end_state_(record, modes_, plain_),
      plain_width_(tiled(plain_.size())),
      arrays_(std::move(spare())) {
  if (arrays_.blocks.size() < record.blocks()) arrays_.blocks.resize(record.blocks());
  blocks_ = std::span(arrays_.blocks).first(record.blocks());
  arrays_.first_columns.resize((1 + plain_width_) * kColumnLength * record.blocks());
  for (std::size_t n = 0; n < end_state_.decays(); ++n) decaying_.push_back(n);
  if (!sensors_.alike()) {
    sensor_ = in_bins(record, [this](Complex s) { return sensors_.response(s); });
  }
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
  return blocks_.size() < kSmallRecordBlocks ? 1 : kEvaluationChunks;
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
    double* column = plain_of(b) + p * kColumnLength;
    fill_plain_column(*record_, b, blocks_[b], plain_[p].right, plain_[p].numbers, column);
    if (plain_[p].left.size() == 0) continue;
    alignas(64) double left[kColumnLength];
    fill_plain_column(*record_, b, blocks_[b], false, plain_[p].left, left);
    for (std::size_t i = 0; i < kColumnLength; ++i) column[i] += left[i];
  }
  end_state_.add_gram(*record_, b, split, blocks_[b], plain_of(b), sums);
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
  if (!amplitudes.empty()) by_frequency_.resize(modes_.size()), by_damping_.resize(modes_.size());
  sum_plain();
}

void LikelihoodEvaluation::sum_plain() {
  plain_sums_[0].reset();
  plain_sums_[1].reset();
  plain_slopes_ = {};
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
    add(plain_[p].left, end_state_.plain_amplitude(p), plain_sums_[0]);
    for (std::size_t i = 0; i < Sensor::kCount; ++i) {
      add(plain_[p].by_sensor[i], end_state_.plain_amplitude(p), plain_slopes_[i]);
    }
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

void LikelihoodEvaluation::prepare_sensor(const LikelihoodColumns& columns) {
  for (std::size_t i = 0; i < Sensor::kCount; ++i) {
    const bool of_response = i == Sensor::kGain && columns.knots > 0;
    if (!(columns.sensors[i] || of_response) || sensor_slopes_[i]) continue;
    sensor_slopes_[i] = in_bins(*record_, [&](Complex s) { return sensors_.slope(i, s); });
  }
}

// The residual of a block, its force and the sensor's columns.
void LikelihoodEvaluation::finish(std::size_t b, const SensorPlaces& sensors) {
  std::array<SensorColumn, Sensor::kCount> columns;
  for (std::size_t i = 0; i < Sensor::kCount; ++i) {
    columns[i] = {given(sensor_slopes_[i]), given(plain_slopes_[i]), sensors[i]};
  }
  if (end_state_.decays() > 0) {
    fill_decays(*record_, b, splits_.of(b), end_state_.amplitudes(), blocks_[b]);
  }
  finish_residual(*record_, b,
                  {.decays = end_state_.decays() > 0,
                   .sensor = given(sensor_),
                   .plain = {given(plain_sums_[0]), given(plain_sums_[1])},
                   .columns = columns,
                   .residual = residual_of(b)},
                  blocks_[b]);
}

Eigen::VectorXd LikelihoodEvaluation::mode_products(const double* sums,
                                                    const LikelihoodColumns& columns) const {
  Eigen::VectorXd products = Eigen::VectorXd::Zero(static_cast<Index>(columns.count));
  if (columns.count == 0) return products;
  std::vector<ModeSlopes> slopes(modes_.size());
  collect_mode_slopes(sums, modes_, column_task(columns), slopes);
  for (std::size_t n = 0; n < modes_.size(); ++n) {
    for (std::size_t i = columns.share_begin[n]; i < columns.share_begin[n + 1]; ++i) {
      const ColumnShare& share = columns.shares[i];
      products[static_cast<Index>(share.column)] += share.frequency * slopes[n].by_frequency +
                                                    share.damping * slopes[n].by_damping +
                                                    share.residue * slopes[n].by_residue;
    }
    if (columns.contact) products[static_cast<Index>(*columns.contact)] += slopes[n].by_contact;
  }
  return products;
}

// Products of the residual with the columns of the response, which are those of ln gain by shares:
// Re e conj(v) for the real part of a knot, Re e conj(i v) = Im e conj(v) for its imaginary part.
void LikelihoodEvaluation::add_knot_slopes(std::size_t b, const double* by_gain,
                                           std::vector<Complex>& knots) {
  const double* residual = residual_of(b);
  for (std::size_t k = 0; k < LikelihoodBlock::kBins; ++k) {
    const Complex product = Complex(residual[k], residual[LikelihoodBlock::kBins + k]) *
                            Complex(by_gain[k], -by_gain[LikelihoodBlock::kBins + k]);
    const auto [knot, next] = sensors_.smooth.place(record_->omega[b * LikelihoodBlock::kBins + k]);
    knots[knot] += (1.0 - next) * product;
    if (next > 0.0) knots[knot + 1] += next * product;
  }
}

// Half of what the cost of the end state changes by, its amplitudes held.
Eigen::VectorXd LikelihoodEvaluation::end_state_slope(const LikelihoodColumns& columns) const {
  Eigen::VectorXd slope = Eigen::VectorXd::Zero(static_cast<Index>(columns.count));
  for (std::size_t n = 0; columns.count > 0 && n < end_state_.decays(); ++n) {
    for (std::size_t i = columns.share_begin[n]; i < columns.share_begin[n + 1]; ++i) {
      const ColumnShare& share = columns.shares[i];
      slope[static_cast<Index>(share.column)] +=
          (share.frequency + share.damping) * end_state_.slope(n);
    }
  }
  return slope;
}

void LikelihoodEvaluation::add_end_state(const LikelihoodColumns& columns,
                                         LikelihoodPoint& point) const {
  point.cost += end_state_.cost();
  point.slope += end_state_slope(columns);
}

LikelihoodPoint LikelihoodEvaluation::slope(const LikelihoodColumns& columns) {
  prepare_sensor(columns);
  const auto& sensors = columns.sensors;
  std::vector<Slopes> parts(chunks());
  for_blocks([&](std::size_t chunk, std::size_t b) {
    Slopes& part = parts[chunk];
    if (part.modes.empty()) {
      part.modes.resize(modes_.size() * kSlopeSums * kSumLanes);
      part.columns.resize(Sensor::kCount * kColumnLength);
      part.knots.resize(columns.knots);
    }
    SensorPlaces places{};
    for (std::size_t i = 0; i < Sensor::kCount; ++i) {
      const bool of_response = i == Sensor::kGain && columns.knots > 0;
      if (sensors[i] || of_response) places[i] = part.columns.data() + i * kColumnLength;
    }
    finish(b, places);
    const double* residual = residual_of(b);
    part.cost += dot(residual, residual);
    for (std::size_t i = 0; i < Sensor::kCount; ++i) {
      if (places[i]) part.sensors[i] += dot(places[i], residual);
    }
    if (columns.knots > 0) add_knot_slopes(b, places[Sensor::kGain], part.knots);
    if (columns.count == 0) return;
    add_mode_slopes(*record_, b, splits_.of(b), blocks_[b], end_state_.decays() > 0, residual,
                    part.modes.data());
  });
  Slopes sum = std::move(parts[0]);
  for (std::size_t c = 1; c < parts.size(); ++c) {
    sum.cost += parts[c].cost;
    for (std::size_t i = 0; i < Sensor::kCount; ++i) sum.sensors[i] += parts[c].sensors[i];
    for (std::size_t i = 0; i < sum.modes.size(); ++i) sum.modes[i] += parts[c].modes[i];
    for (std::size_t k = 0; k < columns.knots; ++k) sum.knots[k] += parts[c].knots[k];
  }
  LikelihoodPoint point{.cost = sum.cost, .slope = mode_products(sum.modes.data(), columns)};
  for (std::size_t i = 0; i < Sensor::kCount; ++i) {
    if (sensors[i]) point.slope[static_cast<Index>(*sensors[i])] = sum.sensors[i];
  }
  for (std::size_t k = 0; k < columns.knots; ++k) {
    const auto at = static_cast<Index>(columns.common() + 2 * k);
    point.slope[at] = sum.knots[k].real();
    point.slope[at + 1] = sum.knots[k].imag();
  }
  add_end_state(columns, point);
  return point;
}

}  // namespace modcal
