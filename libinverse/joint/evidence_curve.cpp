#include "libinverse/joint/evidence_curve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

constexpr std::size_t kCellsPerOctave = 16;
constexpr std::size_t kCells = 64 * kCellsPerOctave;
constexpr double kLowestOctave = -40.0;  // of g
constexpr double kLowestParameterOctave = -64.0;
constexpr std::size_t kParameterOctaves = 80;

// To 2e-5: y = (m − 1)/(m + 1) of the mantissa m, log m = 2 artanh y. The exponent is exact, so
// that powers of two shift cells by whole octaves.
double fast_log2(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const double exponent = static_cast<double>(static_cast<std::int64_t>(bits >> 52) - 1023);
  const auto mantissa =
      std::bit_cast<double>((bits & 0x000fffffffffffffULL) | 0x3ff0000000000000ULL);
  const double y = (mantissa - 1.0) / (mantissa + 1.0);
  const double z = y * y;
  constexpr double kTwoOverLn2 = 2.885390081777927;
  return exponent + kTwoOverLn2 * y * (1.0 + z * (1.0 / 3.0 + z * (0.2 + z / 7.0)));
}

}  // namespace

void EvidenceCurve::Cells::clear() {
  sums.assign(kCells, {0.0, 0.0, 0.0, 0.0});
  unseen = 0.0;
  freedom = 0.0;
}

void EvidenceCurve::Cells::add(double g, double freedom_i, double power, double solution) {
  freedom += freedom_i;
  if (!(g > 0.0)) {
    unseen += power;
    return;
  }
  // What lies beyond the cells counts as the first or last of them: kept or lost at every λ.
  const double place = std::clamp((fast_log2(g) - kLowestOctave) * kCellsPerOctave, 0.0,
                                  static_cast<double>(kCells) - 1.001);
  const auto cell = static_cast<std::size_t>(place);
  const double upper = place - static_cast<double>(cell);
  const double lower = 1.0 - upper;
  std::array<double, 4>& low = sums[cell];
  std::array<double, 4>& high = sums[cell + 1];
  low[0] += lower * freedom_i;
  low[1] += lower * power;
  low[2] += lower * solution;
  high[0] += upper * freedom_i;
  high[1] += upper * power;
  high[2] += upper * solution;
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
  table_.resize(kCells + stride_ * (points - 1));
  // Entry i + stride·(points − 1 − j) belongs to cell i at parameter j.
  const double highest = kLowestParameterOctave + static_cast<double>(stride_ * (points - 1)) /
                                                      static_cast<double>(kCellsPerOctave);
  for (std::size_t e = 0; e < table_.size(); ++e) {
    table_[e] = values_at(kLowestOctave - highest +
                          static_cast<double>(e) / static_cast<double>(kCellsPerOctave));
  }
}

CurvePoint EvidenceCurve::point_of(const Cells& cells, std::size_t first, std::size_t last,
                                   const Values* values, double parameter) {
  double criterion = 0.0, residual = 0.0, solution = 0.0, freedom = 0.0;
  for (std::size_t i = first; i < last; ++i) {
    const std::array<double, 4>& sum = cells.sums[i];
    const Values& value = values[i];
    criterion += value.logarithm * sum[0] - value.kept * sum[1];
    residual += value.lost * value.lost * sum[1];
    solution += value.kept * value.kept * sum[2];
    freedom += value.kept * sum[0];
  }
  return {.parameter = parameter,
          .residual_norm = std::sqrt(residual + cells.unseen),
          .solution_norm = std::sqrt(solution),
          .freedom = freedom,
          .criterion = criterion};
}

void EvidenceCurve::trace(const Cells& cells, ChosenParameter& choice) const {
  std::size_t first = 0, last = kCells;
  while (first < last && cells.sums[first][0] == 0.0) ++first;
  while (last > first && cells.sums[last - 1][0] == 0.0) --last;
  choice.curve.resize(points_);
  const double step = static_cast<double>(stride_) / static_cast<double>(kCellsPerOctave);
  std::size_t best = 0;
  for (std::size_t j = 0; j < points_; ++j) {
    const double octave = kLowestParameterOctave + step * static_cast<double>(j);
    choice.curve[j] = point_of(cells, first, last, table_.data() + stride_ * (points_ - 1 - j),
                               std::exp2(0.5 * octave));
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
  std::array<Values, kCells> values;
  for (std::size_t i = first; i < last; ++i) {
    values[i] = values_at(kLowestOctave +
                          static_cast<double>(i) / static_cast<double>(kCellsPerOctave) - octave);
  }
  choice.point = point_of(cells, first, last, values.data(), std::exp2(0.5 * octave));
  choice.status = ChoiceStatus::kChosen;
  fmt::format_to(text, "largest evidence at {:.4g}", choice.point.parameter);
}

}  // namespace modcal
