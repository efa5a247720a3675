#include "libcalib/parameters/string_unknowns.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcalib/parameters/damping_choice.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;
using Kind = ParameterKind;
using Complex = std::complex<double>;
using std::numbers::pi;

}  // namespace

StringUnknowns StringUnknowns::law(const ModelPoint& reference, double fundamental,
                                   double inharmonicity, const UnknownsOptions& options,
                                   const StatedPriors& priors) {
  StringUnknowns unknowns;
  unknowns.reference_ = reference;
  unknowns.options_ = options;
  unknowns.priors_ = priors;
  unknowns.fundamental_ = fundamental;
  unknowns.inharmonicity_ = inharmonicity;
  unknowns.law_ = true;
  unknowns.list();
  return unknowns;
}

StringUnknowns StringUnknowns::frequencies(const ModelPoint& reference,
                                           const UnknownsOptions& options,
                                           const StatedPriors& priors) {
  StringUnknowns unknowns;
  unknowns.reference_ = reference;
  unknowns.options_ = options;
  unknowns.priors_ = priors;
  unknowns.list();
  return unknowns;
}

StringUnknowns StringUnknowns::without_damping_and_sensors() const {
  StringUnknowns unknowns = *this;
  unknowns.options_.damping = "fixed";
  for (UnknownOption& sensor : unknowns.options_.sensor) sensor.free = false;
  unknowns.options_.response.free = false;
  unknowns.list();
  return unknowns;
}

StringUnknowns StringUnknowns::under(StatedPriors priors) const {
  StringUnknowns result = *this;
  result.priors_ = std::move(priors);
  result.list();
  return result;
}

void StringUnknowns::list() {
  free_ = FreeParameters(modes());
  knots_ = 0;
  for (std::size_t n = 0; n < modes(); ++n) {
    for (const Kind kind : {Kind::kFrequency, Kind::kDampingRatio}) {
      if (priors_.fixed({kind, n})) free_.fix({kind, n});
    }
  }
  const auto add_modes = [this](Kind kind) {
    for (std::size_t n = 0; n < modes(); ++n) free_.add({kind, n});
  };
  if (law_) {
    free_.add({Kind::kFundamental});
    free_.add({Kind::kInharmonicity});
  } else {
    add_modes(Kind::kFrequency);
  }
  free_.add({Kind::kContact});
  const DampingChoice choice = damping_choice(options_.damping);
  const bool each = choice == DampingChoice::kEach && !law_;
  if (each) {
    add_modes(Kind::kDampingRatio);
  } else if (choice > DampingChoice::kFixed) {
    free_.add({Kind::kDampingFactor});
  }
  if (choice == DampingChoice::kPower) free_.add({Kind::kDampingPower});
  damping_count_ = size() - damping();
  for (std::size_t i = 0; i < Sensor::kCount; ++i) {
    if (options_.sensor[i].free) free_.add({Kind::kSensor, i});
  }
  if (options_.response.free) knots_ = reference_.sensors.smooth.knots.size();
}

std::vector<Index> StringUnknowns::own_places(bool stroke) const {
  std::vector<Index> places;
  for (std::size_t i = 0; i < free_.size(); ++i) {
    const bool there = stroke || free_[i].kind != Kind::kContact;
    if (there && options_.own(free_[i])) places.push_back(static_cast<Index>(i));
  }
  return places;
}

Eigen::VectorXd StringUnknowns::theta_of(const ModelPoint& model) const {
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(size());
  ModelPoint from = reference_, to = model;
  for (std::size_t i = 0; i < free_.size(); ++i) {
    const ParameterName& name = free_[i];
    const ParameterType& type = type_of(name);
    double& coordinate = theta[static_cast<Index>(i)];
    if (type.at) coordinate = type.change(*type.at(from, name.index), *type.at(to, name.index));
    if (name.kind == Kind::kFundamental) {
      coordinate = type.change(fundamental_, value_of(name, model));
    }
    if (name.kind == Kind::kInharmonicity) coordinate = value_of(name, model);
    if (name.kind == Kind::kDampingFactor) {
      // Beside a power of n the factor is that of ζ_1.
      coordinate = free_.has(Kind::kDampingPower)
                       ? std::log(model.basis.zeta[0] / reference_.basis.zeta[0])
                       : mean_damping_change(reference_, model);
    }
  }
  for (std::size_t k = 0; k < knots_; ++k) {
    const Complex change = model.sensors.smooth.knots[k] - reference_.sensors.smooth.knots[k];
    theta[knot(k)] = change.real();
    theta[knot(k) + 1] = change.imag();
  }
  return theta;
}

Eigen::VectorXd StringUnknowns::own_start(const ModelPoint& found) const {
  Eigen::VectorXd theta = start();
  const Eigen::VectorXd there = theta_of(found);
  for (const Index i : own_places(true)) theta[i] = there[i];
  return theta;
}

Eigen::VectorXd StringUnknowns::start() const {
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(size());
  if (law_) theta[1] = inharmonicity_;
  return theta;
}

double StringUnknowns::fundamental(const Eigen::VectorXd& theta) const {
  return fundamental_ * std::exp(theta[0]);
}

bool StringUnknowns::held(Index i, std::size_t record) const {
  if (i >= named()) return false;
  ParameterName name = free_[static_cast<std::size_t>(i)];
  if (type_of(name).moves == Moves::kDamping && !type_of(name).of_mode) {
    for (std::size_t n = 0; n < modes(); ++n) {
      if (!priors_.fixes_ratio(n)) return false;
    }
    return true;
  }
  name.record = record;
  return priors_.fixed(name).has_value();
}

Index StringUnknowns::held_count() const {
  Index count = 0;
  for (Index i = 0; i < size(); ++i) count += held(i) ? 1 : 0;
  return count;
}

void StringUnknowns::clear_held(Eigen::MatrixXd& covariance) const {
  for (Index i = 0; i < size(); ++i) {
    if (!held(i)) continue;
    covariance.row(i).setZero();
    covariance.col(i).setZero();
  }
}

std::array<double, Sensor::kCount> StringUnknowns::sensor_deviation(
    const ModelPoint& model, const Eigen::MatrixXd& covariance) const {
  std::array<double, Sensor::kCount> result{};
  for (std::size_t i = 0; i < free_.size(); ++i) {
    if (free_[i].kind != Kind::kSensor) continue;
    const double unit = free_.type(i).slope(value_of(free_[i], model));
    const auto at = static_cast<Index>(i);
    result[free_[i].index] = unit * std::sqrt(covariance(at, at));
  }
  return result;
}

std::vector<Complex> StringUnknowns::response_deviations(const Eigen::MatrixXd& covariance) const {
  std::vector<Complex> result;
  for (std::size_t k = 0; k < knots_; ++k) {
    const Index i = knot(k);
    result.emplace_back(std::sqrt(covariance(i, i)), std::sqrt(covariance(i + 1, i + 1)));
  }
  return result;
}

bool StringUnknowns::admits(const Eigen::VectorXd& theta) const {
  if (!theta.allFinite()) return false;
  const double x = reference_.contact + theta[contact()];
  const double top = static_cast<double>(modes());
  if (x <= 1e-4 * reference_.basis.length || x >= (1.0 - 1e-4) * reference_.basis.length) {
    return false;
  }
  // The damping may change fiftyfold, f_0 by a third: beyond that it is another string.
  for (std::size_t n = 0; n < modes(); ++n) {
    if (std::abs(damping_change(n, theta)) >= 4.0) return false;
  }
  if (law_ && (1.0 + theta[1] * top * top <= 0.25 || std::abs(theta[0]) >= 0.3)) return false;
  const ModelPoint point = model(theta);
  for (std::size_t i = 0; i < Sensor::kCount; ++i) {
    const double coordinate = sensor_type(i).coordinate(sensor_value(i, point.sensors));
    if (!(std::abs(coordinate) < sensor_type(i).farthest)) return false;
  }
  const std::vector<Complex>& knots = point.sensors.smooth.knots;
  return std::all_of(knots.begin(), knots.end(), [](Complex knot) {
    return std::abs(knot) < sensor_type(Sensor::kGain).farthest;
  });
}

ModelPoint StringUnknowns::model(const Eigen::VectorXd& theta) const {
  ModelPoint point = reference_;
  if (point.higher && law_) {
    point.higher->fundamental = fundamental(theta);
    point.higher->inharmonicity = theta[1];
  }
  for (std::size_t i = 0; i < modes(); ++i) {
    const double n = static_cast<double>(i + 1);
    if (law_ && free_.follows_law(Moves::kFrequencies, i)) {
      point.basis.omega[i] = 2.0 * pi * n * fundamental(theta) * std::sqrt(1.0 + theta[1] * n * n);
    }
    point.basis.zeta[i] *= std::exp(damping_change(i, theta));
  }
  for (std::size_t i = 0; i < free_.size(); ++i) {
    const ParameterType& type = free_.type(i);
    const bool apart = type.at && type.moves != Moves::kDamping;
    const bool fixed = type.of_mode && free_.movers(type.moves, free_[i].index).empty();
    if (!apart || fixed) continue;
    double& number = *type.at(point, free_[i].index);
    number = type.moved(number, theta[static_cast<Index>(i)]);
  }
  for (std::size_t k = 0; k < knots_; ++k) {
    point.sensors.smooth.knots[k] += Complex(theta[knot(k)], theta[knot(k) + 1]);
  }
  return point;
}

LikelihoodColumns StringUnknowns::columns(const Eigen::VectorXd& theta, std::size_t record) const {
  std::vector<bool> known;
  for (Index i = 0; i < size(); ++i) known.push_back(held(i, record));
  LikelihoodColumns columns = free_.columns(law_ ? theta[1] : 0.0, reference_.higher, known);
  columns.knots = knots_;
  columns.count += 2 * knots_;
  return columns;
}

}  // namespace modcal
