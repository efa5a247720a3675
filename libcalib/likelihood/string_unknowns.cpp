#include "libcalib/likelihood/string_unknowns.hpp"

#include <cmath>
#include <numbers>

namespace modcal {
namespace {

using Index = Eigen::Index;
using std::numbers::pi;

}  // namespace

StringUnknowns StringUnknowns::law(const ModelPoint& reference, double fundamental,
                                   double inharmonicity, const UnknownsOptions& options,
                                   const StatedPriors& priors) {
  StringUnknowns unknowns = frequencies(reference, options, priors);
  unknowns.fundamental_ = fundamental;
  unknowns.inharmonicity_ = inharmonicity;
  unknowns.law_ = true;
  return unknowns;
}

StringUnknowns StringUnknowns::frequencies(const ModelPoint& reference,
                                           const UnknownsOptions& options,
                                           const StatedPriors& priors) {
  StringUnknowns unknowns;
  unknowns.reference_ = reference;
  unknowns.options_ = options;
  unknowns.priors_ = priors;
  return unknowns;
}

StringUnknowns StringUnknowns::without_damping_and_sensors() const {
  StringUnknowns unknowns = *this;
  unknowns.options_.damping = "fixed";
  for (UnknownOption* sensor :
       {&unknowns.options_.gain, &unknowns.options_.delay, &unknowns.options_.corner}) {
    sensor->free = false;
  }
  return unknowns;
}

StringUnknowns::Damping StringUnknowns::damping_kind() const {
  if (options_.damping == "fixed") return Damping::kFixed;
  if (options_.damping == "power") return Damping::kPower;
  return options_.damping == "each" && !law_ ? Damping::kEach : Damping::kFactor;
}

Index StringUnknowns::damping_count() const {
  switch (damping_kind()) {
    case Damping::kFixed:
      return 0;
    case Damping::kFactor:
      return 1;
    case Damping::kPower:
      return 2;
    case Damping::kEach:
      return static_cast<Index>(modes());
  }
  return 0;
}

const UnknownOption& StringUnknowns::sensor_option(std::size_t which) const {
  return which == 0 ? options_.gain : which == 1 ? options_.delay : options_.corner;
}

Index StringUnknowns::sensor_count() const {
  Index count = 0;
  for (std::size_t i = 0; i < 3; ++i) count += sensor_option(i).free ? 1 : 0;
  return count;
}

Index StringUnknowns::sensor(std::size_t which) const {
  if (!sensor_option(which).free) return -1;
  Index place = sensor_begin();
  for (std::size_t i = 0; i < which; ++i) place += sensor_option(i).free ? 1 : 0;
  return place;
}

double StringUnknowns::sensor_change(std::size_t which, const Eigen::VectorXd& theta) const {
  const Index place = sensor(which);
  return place < 0 ? 0.0 : theta[place];
}

Eigen::VectorXd StringUnknowns::start() const {
  Eigen::VectorXd theta = Eigen::VectorXd::Zero(size());
  if (law_) theta[1] = inharmonicity_;
  return theta;
}

double StringUnknowns::fundamental(const Eigen::VectorXd& theta) const {
  return fundamental_ * std::exp(theta[0]);
}

// ln ζ_n/ζ_n(reference).
double StringUnknowns::damping_change(std::size_t mode, const Eigen::VectorXd& theta) const {
  if (priors_.held().ratio(mode)) return 0.0;
  switch (damping_kind()) {
    case Damping::kFixed:
      return 0.0;
    case Damping::kFactor:
      return theta[damping()];
    case Damping::kPower:
      return theta[damping()] + theta[damping() + 1] * std::log(static_cast<double>(mode + 1));
    case Damping::kEach:
      return theta[damping() + static_cast<Index>(mode)];
  }
  return 0.0;
}

double StringUnknowns::damping_factor(const Eigen::VectorXd& theta) const {
  if (damping_kind() == Damping::kPower) return std::exp(theta[damping()]);
  double sum = 0.0, count = 0.0;
  for (std::size_t n = 0; n < modes(); ++n) {
    sum += damping_change(n, theta);
    count += priors_.held().ratio(n) ? 0.0 : 1.0;
  }
  return std::exp(sum / std::max(count, 1.0));
}

double StringUnknowns::damping_power(const Eigen::VectorXd& theta) const {
  return damping_kind() == Damping::kPower ? theta[damping() + 1] : 0.0;
}

double StringUnknowns::damping_power_deviation(const Eigen::MatrixXd& covariance) const {
  if (damping_kind() != Damping::kPower) return 0.0;
  return std::sqrt(std::max(covariance(damping() + 1, damping() + 1), 0.0));
}

std::vector<double> StringUnknowns::ratio_deviations(const Eigen::MatrixXd& covariance) const {
  std::vector<double> result;
  for (Index i = 0; damping_kind() == Damping::kEach && i < damping_count(); ++i) {
    const double variance = covariance(damping() + i, damping() + i);
    const bool known = priors_.held().ratio(static_cast<std::size_t>(i));
    result.push_back(known ? 0.0 : std::sqrt(std::max(variance, 0.0)));
  }
  return result;
}

bool StringUnknowns::all_ratios_held() const {
  for (std::size_t n = 0; n < modes(); ++n) {
    if (!priors_.held().ratio(n)) return false;
  }
  return true;
}

bool StringUnknowns::held(Index i, std::size_t record) const {
  const HeldParameters& held = priors_.held();
  if (i == contact()) return held.contact(record);
  if (i < contact()) {
    if (!law_) return held.frequency(static_cast<std::size_t>(i));
    return i == 0 ? held.fundamental.has_value() : held.inharmonicity.has_value();
  }
  if (i >= sensor_begin()) return false;
  return damping_kind() == Damping::kEach ? held.ratio(static_cast<std::size_t>(i - damping()))
                                          : all_ratios_held();
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

double StringUnknowns::damping_deviation(const Eigen::MatrixXd& covariance) const {
  const Index count = damping_count();
  if (count == 0) return 0.0;
  // The mean of all changes is linear in the unknowns.
  Eigen::VectorXd slope(count);
  for (Index i = 0; i < count; ++i) {
    Eigen::VectorXd theta = Eigen::VectorXd::Zero(size());
    theta[damping() + i] = 1.0;
    slope[i] = std::log(damping_factor(theta));
  }
  const double variance = slope.dot(covariance.block(damping(), damping(), count, count) * slope);
  return std::sqrt(std::max(variance, 0.0));
}

std::array<double, 3> StringUnknowns::sensor_deviation(const ModelPoint& model,
                                                       const Eigen::MatrixXd& covariance) const {
  const double unit[] = {model.sensors.gain, 1.0, 0.5 / pi};
  std::array<double, 3> result{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Index at = sensor(i);
    if (at >= 0) result[i] = unit[i] * std::sqrt(std::max(covariance(at, at), 0.0));
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
  // Sensors: half the gain, 10 ms, 50 Hz. A corner below 0 is no filter, but a fit may pass there.
  const SensorPair sensors = model(theta).sensors;
  return std::abs(std::log(sensors.gain)) < 0.7 && std::abs(sensors.delay) < 1e-2 &&
         std::abs(sensors.corner) < 2.0 * pi * 50.0;
}

ModelPoint StringUnknowns::model(const Eigen::VectorXd& theta) const {
  ModelPoint point = reference_;
  for (std::size_t i = 0; i < modes(); ++i) {
    const double n = static_cast<double>(i + 1);
    if (!priors_.held().frequency(i)) {
      point.basis.omega[i] =
          law_ ? 2.0 * pi * n * fundamental(theta) * std::sqrt(1.0 + theta[1] * n * n)
               : reference_.basis.omega[i] * std::exp(theta[static_cast<Index>(i)]);
    }
    point.basis.zeta[i] = reference_.basis.zeta[i] * std::exp(damping_change(i, theta));
  }
  point.contact += theta[contact()];
  point.sensors.gain *= std::exp(sensor_change(0, theta));
  point.sensors.delay += sensor_change(1, theta);
  point.sensors.corner += sensor_change(2, theta);
  return point;
}

// Shares of one mode in the columns of frequencies and damping.
void StringUnknowns::add_shares(std::size_t mode, const Eigen::VectorXd& theta,
                                LikelihoodColumns& columns) const {
  const double n = static_cast<double>(mode + 1);
  const auto first = static_cast<std::size_t>(damping());
  const HeldParameters& held = priors_.held();
  if (!held.frequency(mode)) {
    if (!law_) columns.shares.push_back({mode, 1.0, 0.0});
    if (law_ && !held.fundamental) columns.shares.push_back({0, 1.0, 0.0});
    if (law_ && !held.inharmonicity) {
      columns.shares.push_back({1, 0.5 * n * n / (1.0 + theta[1] * n * n), 0.0});
    }
  }
  if (held.ratio(mode)) return;
  const Damping kind = damping_kind();
  if (kind == Damping::kEach) columns.shares.push_back({first + mode, 0.0, 1.0});
  if (kind == Damping::kFactor || kind == Damping::kPower) {
    columns.shares.push_back({first, 0.0, 1.0});
  }
  if (kind == Damping::kPower) columns.shares.push_back({first + 1, 0.0, std::log(n)});
}

LikelihoodColumns StringUnknowns::columns(const Eigen::VectorXd& theta, std::size_t record) const {
  LikelihoodColumns columns{.count = static_cast<std::size_t>(size()), .share_begin = {0}};
  if (!held(contact(), record)) columns.contact = static_cast<std::size_t>(contact());
  for (std::size_t i = 0; i < modes(); ++i) {
    add_shares(i, theta, columns);
    columns.share_begin.push_back(columns.shares.size());
  }
  const auto place = [this](std::size_t which) {
    const Index at = sensor(which);
    return at < 0 ? std::optional<std::size_t>() : static_cast<std::size_t>(at);
  };
  columns.gain = place(0);
  columns.delay = place(1);
  columns.corner = place(2);
  return columns;
}

}  // namespace modcal
