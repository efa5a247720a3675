#include "libinverse/joint/evidence_curve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "libinverse/joint/joint_kernels.hpp"
#include "libinverse/joint/tuning.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

constexpr std::size_t kCells = 64 * kCellsPerOctave;

// Adds {m, power, solution, 0} to the two cells nearest to g > 0. What lies beyond the cells counts
// as the first or last of them: kept or lost at every λ.
void spread(double g, const std::array<double, 4>& terms, std::array<double, 4>* cells) {
  const double place = std::clamp((std::log2(g) - kLowestOctave) * kCellsPerOctave, 0.0,
                                  static_cast<double>(kCells) - 1.001);
  const auto cell = static_cast<std::size_t>(place);
  const double upper = place - static_cast<double>(cell);
  const double lower = 1.0 - upper;
  std::array<double, 4>& low = cells[cell];
  std::array<double, 4>& high = cells[cell + 1];
  for (std::size_t c = 0; c < 4; ++c) low[c] += lower * terms[c];
  for (std::size_t c = 0; c < 4; ++c) high[c] += upper * terms[c];
}

template <class Column>
CellColumns columns_from(const Column (&columns)[3], std::size_t begin) {
  return {columns[0].data() + begin, columns[1].data() + begin, columns[2].data() + begin};
}

CurvePoint point_of(const CellColumns& cells, const CellColumns& values, std::size_t count,
                    double unseen, double parameter) {
  const std::array<double, 4> sums = joint_kernels().sum_cells(cells, values, count);
  return {.parameter = parameter,
          .residual_norm = std::sqrt(sums[1] + unseen),
          .solution_norm = std::sqrt(sums[2]),
          .freedom = sums[3],
          .criterion = sums[0]};
}

}  // namespace

void EvidenceCurve::Cells::clear() {
  sums.assign(2 * kCells, {0.0, 0.0, 0.0, 0.0});
  unseen = 0.0;
  freedom = 0.0;
}

void EvidenceCurve::Cells::add(double g, double freedom_i, double power, double solution) {
  freedom += freedom_i;
  if (g > 0.0) {
    spread(g, {freedom_i, power, solution, 0.0}, sums.data());
  } else {
    unseen += power;
  }
}

void EvidenceCurve::Cells::add_pairs(std::span<const double> g, std::span<const double> power,
                                     std::span<const double> solution) {
  freedom += 2.0 * static_cast<double>(g.size());
  unseen += joint_kernels().spread_pairs(g, power, solution, kLowestOctave, kCellsPerOctave, sums);
}

EvidenceCurve::Values EvidenceCurve::values_at(double octaves) {
  const double ratio = std::exp2(octaves);  // g/λ²
  return {
      .logarithm = std::log1p(ratio), .kept = ratio / (1.0 + ratio), .lost = 1.0 / (1.0 + ratio)};
}

EvidenceCurve::EvidenceCurve(std::size_t points) : points_(points) {
  MODCAL_REQUIRE(points >= 3 && points <= kParameterOctaves * kCellsPerOctave,
                 "{} points on the curve of evidence: 3 to {} are possible", points,
                 kParameterOctaves * kCellsPerOctave);
  stride_ = kParameterOctaves * kCellsPerOctave / (points - 1);
  const std::size_t entries = kCells + stride_ * (points - 1);
  for (auto& column : table_) column.resize(entries);
  // Entry i + stride·(points − 1 − j) belongs to cell i at parameter j.
  const double highest = kLowestParameterOctave + static_cast<double>(stride_ * (points - 1)) /
                                                      static_cast<double>(kCellsPerOctave);
  for (std::size_t e = 0; e < entries; ++e) {
    const Values values = values_at(kLowestOctave - highest +
                                    static_cast<double>(e) / static_cast<double>(kCellsPerOctave));
    table_[0][e] = values.logarithm;
    table_[1][e] = values.kept;
    table_[2][e] = values.lost;
  }
}

CurvePoint EvidenceCurve::point_between(const Cells& cells, std::size_t first, std::size_t count,
                                        double octave) {
  std::array<double, kCells> column[3];
  for (std::size_t i = first; i < first + count; ++i) {
    const Values values = values_at(
        kLowestOctave + static_cast<double>(i) / static_cast<double>(kCellsPerOctave) - octave);
    column[0][i] = values.logarithm;
    column[1][i] = values.kept;
    column[2][i] = values.lost;
  }
  return point_of(columns_from(cells.column, first), columns_from(column, first), count,
                  cells.unseen, std::exp2(0.5 * octave));
}

void EvidenceCurve::trace(Cells& cells, ChosenParameter& choice) const {
  for (std::size_t c = 0; c < 3; ++c) {
    cells.column[c].resize(kCells);
    for (std::size_t i = 0; i < kCells; ++i) {
      cells.column[c][i] = cells.sums[i][c] + cells.sums[kCells + i][c];
    }
  }
  const std::vector<double>& freedoms = cells.column[0];
  std::size_t first = 0, last = kCells;
  while (first < last && freedoms[first] == 0.0) ++first;
  while (last > first && freedoms[last - 1] == 0.0) --last;
  first -= first % kCellBlock;
  const std::size_t count = (last - first + kCellBlock - 1) / kCellBlock * kCellBlock;
  choice.curve.resize(points_);
  const double step = static_cast<double>(stride_) / static_cast<double>(kCellsPerOctave);
  std::size_t best = 0;
  for (std::size_t j = 0; j < points_; ++j) {
    const double octave = kLowestParameterOctave + step * static_cast<double>(j);
    choice.curve[j] = point_of(columns_from(cells.column, first),
                               columns_from(table_, first + stride_ * (points_ - 1 - j)), count,
                               cells.unseen, std::exp2(0.5 * octave));
    if (choice.curve[j].criterion < choice.curve[best].criterion) best = j;
  }
  choice.explanation.clear();
  auto text = std::back_inserter(choice.explanation);
  choice.point = choice.curve[best];
  if (best == 0 || best + 1 == points_) {
    choice.status = ChoiceStatus::kEdgeOfRange;
    fmt::format_to(text, "largest evidence at the {} edge {:.4g} of the searched range",
                   best == 0 ? "lower" : "upper", choice.point.parameter);
    return;
  }
  const double left = choice.curve[best - 1].criterion, middle = choice.curve[best].criterion;
  const double right = choice.curve[best + 1].criterion;
  const double bend = left - 2.0 * middle + right;
  const double shift = bend > 0.0 ? std::clamp(0.5 * (left - right) / bend, -0.5, 0.5) : 0.0;
  const double octave = kLowestParameterOctave + step * (static_cast<double>(best) + shift);
  choice.point = point_between(cells, first, count, octave);
  choice.status = ChoiceStatus::kChosen;
  fmt::format_to(text, "largest evidence at {:.4g}", choice.point.parameter);
}

}  // namespace modcal
