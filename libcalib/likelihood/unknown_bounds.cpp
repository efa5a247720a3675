#include "libcalib/likelihood/unknown_bounds.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcalib/parameters/stiff_string_fit.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

class BoundsOf {
 public:
  BoundsOf(const StringUnknowns& unknowns, const ModelPoint& initial, const ParameterRanges& ranges)
      : unknowns_(unknowns),
        initial_(initial),
        ranges_(ranges),
        start_(unknowns.start()),
        reference_(unknowns.model(start_)) {
    bounds_.lower = Eigen::VectorXd::Constant(unknowns.size(), -1e9);
    bounds_.upper = Eigen::VectorXd::Constant(unknowns.size(), 1e9);
  }

  UnknownBounds all() {
    frequencies();
    const double contact = initial_.contact - reference_.contact;
    place(unknowns_.contact(), contact - ranges_.contact, contact + ranges_.contact);
    damping();
    sensors();
    return bounds_;
  }

 private:
  void place(Index i, double lower, double upper) {
    bounds_.lower[i] = std::min(lower, start_[i]);
    bounds_.upper[i] = std::max(upper, start_[i]);
  }
  // Of a logarithm: within a share of the value that θ_i = offset stands for.
  void share(Index i, double offset, double range) {
    place(i, offset + std::log1p(-range), offset + std::log1p(range));
  }

  void frequencies() {
    const ModalBasis& basis = initial_.basis;
    if (unknowns_.is_law()) {
      std::vector<double> frequencies;
      for (std::size_t n = 0; n < basis.size(); ++n) frequencies.push_back(basis.frequency(n));
      const StiffStringFit law = fit_stiff_string(frequencies);
      share(0, std::log(law.fundamental / unknowns_.fundamental(start_)), ranges_.frequency);
      place(1, lowest_inharmonicity(law.inharmonicity), law.inharmonicity + ranges_.inharmonicity);
      return;
    }
    for (std::size_t n = 0; n < basis.size(); ++n) {
      share(static_cast<Index>(n), std::log(basis.omega[n] / reference_.basis.omega[n]),
            ranges_.frequency);
    }
  }
  double lowest_inharmonicity(double initial) const {
    const auto top = static_cast<double>(initial_.basis.size());
    const double lowest = std::isnan(ranges_.lowest_inharmonicity) ? -0.5 / (top * top)
                                                                   : ranges_.lowest_inharmonicity;
    return std::max(initial - ranges_.inharmonicity, lowest);
  }

  void damping() {
    for (Index i = 0; i < unknowns_.damping_count(); ++i) {
      const Index at = unknowns_.damping() + i;
      const bool each = unknowns_.damping_count() > 2;
      const auto n = static_cast<std::size_t>(each ? i : 0);
      const double offset = std::log(initial_.basis.zeta[n] / reference_.basis.zeta[n]);
      if (!each && i == 1) {
        place(at, -ranges_.power, ranges_.power);
      } else {
        share(at, offset, ranges_.damping);
      }
    }
  }

  void sensors() {
    const SensorPair& from = initial_.sensors;
    const SensorPair& at = reference_.sensors;
    if (unknowns_.sensor(0) >= 0) {
      share(unknowns_.sensor(0), std::log(from.gain / at.gain), ranges_.gain);
    }
    if (unknowns_.sensor(1) >= 0) {
      place(unknowns_.sensor(1), from.delay - ranges_.delay - at.delay,
            from.delay + ranges_.delay - at.delay);
    }
    if (unknowns_.sensor(2) >= 0) {
      place(unknowns_.sensor(2), -at.corner,
            from.corner + 2.0 * std::numbers::pi * ranges_.corner - at.corner);
    }
  }

  const StringUnknowns& unknowns_;
  const ModelPoint& initial_;
  const ParameterRanges& ranges_;
  Eigen::VectorXd start_;
  ModelPoint reference_;
  UnknownBounds bounds_;
};

}  // namespace

UnknownBounds unknown_bounds(const StringUnknowns& unknowns, const ModelPoint& initial,
                             const ParameterRanges& ranges) {
  return BoundsOf(unknowns, initial, ranges).all();
}

UnknownBounds unknown_bounds(const AllRecords& all, const ModelPoint& initial,
                             const ParameterRanges& ranges) {
  const UnknownBounds one = unknown_bounds(all.unknowns(), initial, ranges);
  UnknownBounds bounds{all.start(), all.start()};
  for (std::size_t r = 0; r < all.records(); ++r) {
    for (Index i = 0; i < all.unknowns().size(); ++i) {
      double& lower = bounds.lower[all.place(i, r)];
      double& upper = bounds.upper[all.place(i, r)];
      lower = std::min(lower, one.lower[i]);
      upper = std::max(upper, one.upper[i]);
    }
  }
  return bounds;
}

}  // namespace modcal
