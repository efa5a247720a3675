#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "libinverse/spectral/choices/rules.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

struct Slope {
  double residual = 0.0;
  double solution = 0.0;
};

// d log‖r‖/d log λ and d log‖x‖/d log λ over ± stride points. Quotients, not differences of
// logarithms: scaling the data by a power of two then changes no bit.
std::vector<Slope> slopes_of(std::span<const CurvePoint> curve, std::size_t stride) {
  std::vector<Slope> slopes(curve.size());
  for (std::size_t j = stride; j + stride < curve.size(); ++j) {
    const CurvePoint& low = curve[j - stride];
    const CurvePoint& high = curve[j + stride];
    const double width = std::log(high.parameter / low.parameter);
    slopes[j] = {std::log(high.residual_norm / low.residual_norm) / width,
                 std::log(high.solution_norm / low.solution_norm) / width};
  }
  return slopes;
}

std::size_t stride_of(std::span<const CurvePoint> curve, double span) {
  if (curve.size() < 2) return 1;
  const double decades = std::log10(curve.back().parameter / curve.front().parameter);
  const double step = decades / static_cast<double>(curve.size() - 1);
  return std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(span / step)));
}

struct Vertex {
  double residual = 0.0;  // log ‖r‖
  double solution = 0.0;  // log ‖x‖
  std::size_t index = 0;  // on the curve
};

struct Segment {
  double residual = 0.0, solution = 0.0;  // unit vector to the next vertex
  std::size_t from = 0;                   // vertex
};

double turn(const Segment& first, const Segment& second) {
  return first.residual * second.solution - first.solution * second.residual;
}

// From much to little regularization, norms relative to the first vertex: scaling the data changes
// nothing. Vertices that coincide are one.
std::vector<Vertex> vertices_of(std::span<const CurvePoint> curve) {
  std::vector<Vertex> vertices;
  double residual = 0.0, solution = 0.0;
  for (std::size_t j = curve.size(); j-- > 0;) {
    if (!(curve[j].residual_norm > 0.0) || !(curve[j].solution_norm > 0.0)) continue;
    if (vertices.empty()) {
      residual = curve[j].residual_norm;
      solution = curve[j].solution_norm;
    }
    const Vertex vertex{std::log(curve[j].residual_norm / residual),
                        std::log(curve[j].solution_norm / solution), j};
    if (!vertices.empty() && vertex.residual == vertices.back().residual &&
        vertex.solution == vertices.back().solution) {
      continue;
    }
    vertices.push_back(vertex);
  }
  return vertices;
}

std::vector<Segment> segments_of(std::span<const Vertex> vertices, std::vector<double>& length) {
  std::vector<Segment> segments;
  for (std::size_t i = 0; i + 1 < vertices.size(); ++i) {
    const double residual = vertices[i + 1].residual - vertices[i].residual;
    const double solution = vertices[i + 1].solution - vertices[i].solution;
    length.push_back(std::hypot(residual, solution));
    segments.push_back({residual / length.back(), solution / length.back(), i});
  }
  return segments;
}

// The vertex before the sharpest turn from flat to steep.
std::optional<std::size_t> sharpest(std::span<const Segment> kept) {
  std::optional<std::size_t> best;
  double least = 0.0;
  for (std::size_t i = 0; i + 1 < kept.size(); ++i) {
    const double value = turn(kept[i], kept[i + 1]);
    if (value < least) {
      least = value;
      best = kept[i + 1].from;
    }
  }
  return best;
}

// The vertex nearest to where the flattest segment, prolonged, meets a steepest one behind it.
std::optional<std::size_t> nearest_to_meeting(std::span<const Segment> kept,
                                              std::span<const Vertex> vertices) {
  const auto flatter = [](const Segment& a, const Segment& b) {
    return std::abs(a.solution) < std::abs(b.solution);
  };
  const auto flat = std::min_element(kept.begin(), kept.end(), flatter);
  const auto steep = std::max_element(flat, kept.end(), flatter);
  if (steep == flat || steep->solution == 0.0) return std::nullopt;
  const double level = vertices[flat->from].solution;
  const Vertex& on_steep = vertices[steep->from];
  const double meeting =
      on_steep.residual + (level - on_steep.solution) * steep->residual / steep->solution;
  const auto distance = [&](const Vertex& v) {
    return std::hypot(v.residual - meeting, v.solution - level);
  };
  const auto nearest =
      std::min_element(vertices.begin(), vertices.end(),
                       [&](const Vertex& a, const Vertex& b) { return distance(a) < distance(b); });
  return static_cast<std::size_t>(nearest - vertices.begin());
}

struct Candidates {
  std::vector<std::size_t> vertices;  // rising: from much to little regularization
  bool convex = false;                // the curve has a corner at all
};

Candidates candidates_of(std::span<const Vertex> vertices) {
  std::vector<double> length;
  const std::vector<Segment> segments = segments_of(vertices, length);
  std::vector<std::size_t> longest(segments.size());
  std::iota(longest.begin(), longest.end(), std::size_t{0});
  std::stable_sort(longest.begin(), longest.end(),
                   [&](std::size_t a, std::size_t b) { return length[a] > length[b]; });
  Candidates found;
  for (std::size_t count = 5; count < 2 * segments.size() || count == 5; count *= 2) {
    std::vector<std::size_t> chosen(
        longest.begin(),
        longest.begin() + static_cast<std::ptrdiff_t>(std::min(count, longest.size())));
    std::sort(chosen.begin(), chosen.end());
    std::vector<Segment> kept;
    for (const std::size_t i : chosen) kept.push_back(segments[i]);
    if (const auto corner = sharpest(kept)) {
      found.convex = true;
      found.vertices.push_back(*corner);
    }
    if (const auto corner = nearest_to_meeting(kept, vertices)) found.vertices.push_back(*corner);
  }
  // The end of the curve is where the first candidate is compared from.
  found.vertices.push_back(0);
  std::sort(found.vertices.begin(), found.vertices.end());
  found.vertices.erase(std::unique(found.vertices.begin(), found.vertices.end()),
                       found.vertices.end());
  return found;
}

std::size_t corner_among(const Candidates& found, std::span<const Vertex> vertices) {
  const auto step = [&](std::size_t i) {
    const Vertex &from = vertices[found.vertices[i]], &to = vertices[found.vertices[i + 1]];
    return Segment{to.residual - from.residual, to.solution - from.solution, 0};
  };
  std::size_t last_costly = found.vertices.back();
  for (std::size_t i = 1; i + 1 < found.vertices.size(); ++i) {
    const Segment before = step(i - 1), after = step(i);
    if (after.solution < std::abs(after.residual)) continue;
    if (turn(before, after) <= 0.0) return found.vertices[i];
    last_costly = found.vertices[i];
  }
  return last_costly;
}

}  // namespace

void LCurveOptions::visit(OptionVisitor& visitor) {
  curve.visit(visitor);
  visitor("span",
          "half span of the differences behind the curvature, in decades of the "
          "parameter; 0: neighboring points",
          {.range = Range::closed(0.0, 10.0)}, span);
}

void LCurveOptions::require() const {
  MODCAL_REQUIRE(span >= 0.0 && std::isfinite(span), "span of {:g} decades must be >= 0", span);
}

Pick pick_l_curve(const LCurveOptions& options, const TracedCurve& traced) {
  const std::span<CurvePoint> curve = traced.curve;
  const std::size_t stride = stride_of(curve, options.span);
  const std::vector<Slope> slopes = slopes_of(curve, stride);
  const CurvePoint* best = nullptr;
  for (std::size_t j = 2 * stride; j + 2 * stride < curve.size(); ++j) {
    const Slope& low = slopes[j - stride];
    const Slope& high = slopes[j + stride];
    const double width = std::log(curve[j + stride].parameter / curve[j - stride].parameter);
    const Slope slope = slopes[j];
    const double turn = slope.residual * (high.solution - low.solution) -
                        slope.solution * (high.residual - low.residual);
    const double speed = std::hypot(slope.residual, slope.solution);
    const double curvature = turn / (width * speed * speed * speed);
    if (!std::isfinite(curvature)) continue;  // a norm is 0 there, or the curve stands still
    curve[j].criterion = curvature;
    if (!best || curvature > best->criterion) best = &curve[j];
  }
  if (!best || !(best->criterion > 0.0)) {
    return {curve.front().parameter, ChoiceStatus::kNotReached,
            "the L-curve has no corner (no positive curvature); the lowest parameter stands in"};
  }
  return {best->parameter, ChoiceStatus::kChosen,
          fmt::format("largest curvature {:.4g} at {:.4g}", best->criterion, best->parameter)};
}

Pick pick_l_curve_adaptive(const CurveRuleOptions& /*options*/, const TracedCurve& traced) {
  const std::span<CurvePoint> curve = traced.curve;
  const std::vector<Vertex> vertices = vertices_of(curve);
  const Candidates found = vertices.size() > 2 ? candidates_of(vertices) : Candidates{};
  if (!found.convex) {
    return {curve.front().parameter, ChoiceStatus::kNotReached,
            "the L-curve has no corner (it turns nowhere from flat to steep); the lowest parameter "
            "stands in"};
  }
  const Vertex& corner = vertices[corner_among(found, vertices)];
  for (const Vertex& vertex : vertices) {
    curve[vertex.index].criterion =
        std::hypot(vertex.residual - corner.residual, vertex.solution - corner.solution) /
        std::log(10.0);
  }
  const double parameter = curve[corner.index].parameter;
  if (corner.index == 0 || corner.index + 1 == curve.size()) {
    return {parameter, ChoiceStatus::kEdgeOfRange,
            fmt::format("corner of the L-curve at the {} edge {:.4g} of the searched range",
                        corner.index == 0 ? "lower" : "upper", parameter)};
  }
  return {parameter, ChoiceStatus::kChosen,
          fmt::format("corner of the L-curve at {:.4g}, one of {} candidates", parameter,
                      found.vertices.size() - 1)};
}

}  // namespace modcal
