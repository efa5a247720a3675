#include "libinverse/structure/blind_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "libinverse/structure/blind_likelihood.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

ModalModel moved(const ModalModel& table, const Eigen::VectorXd& theta) {
  ModalModel model = table;
  const std::size_t modes = model.poles.size();
  Index i = 0;
  for (ModalPole& pole : model.poles) {
    pole.omega *= std::exp(theta[i]);
    pole.zeta = std::min(0.9, pole.zeta * std::exp(theta[i + 1]));
    i += 2;
  }
  for (std::size_t j = 0; i < theta.size() && j < modes * model.sensors.size(); ++j, i += 2) {
    const Complex constant =
        Complex(model.constants[j], model.quadrature[j]) * Complex(1.0 + theta[i], theta[i + 1]);
    model.constants[j] = constant.real();
    model.quadrature[j] = constant.imag();
  }
  return model;
}

ModalModel with_quadrature(ModalModel model) {
  model.quadrature.resize(model.constants.size());
  return model;
}

Eigen::VectorXd prior_of(const ModalModel& table, const StructureChange& change) {
  const auto modes = static_cast<Index>(table.poles.size());
  const Index factors =
      change.residue > 0.0 ? 2 * modes * static_cast<Index>(table.sensors.size()) : 0;
  Eigen::VectorXd sd(2 * modes + factors);
  for (Index n = 0; n < modes; ++n) sd.segment<2>(2 * n) << change.frequency, change.damping;
  sd.tail(factors).setConstant(change.residue);
  return sd;
}

// The same with what the table itself does not know of its poles.
Eigen::VectorXd prior_of(const StructureTable& table, const StructureChange& change) {
  Eigen::VectorXd sd = prior_of(table.model, change);
  const auto add = [&sd](std::size_t i, double deviation) {
    double& own = sd[static_cast<Index>(i)];
    own = std::hypot(own, std::min(1.0, deviation));
  };
  for (std::size_t n = 0; n < table.frequency_deviations.size(); ++n) {
    add(2 * n, table.frequency_deviations[n]);
  }
  for (std::size_t n = 0; n < table.damping_deviations.size(); ++n) {
    add(2 * n + 1, table.damping_deviations[n]);
  }
  return sd;
}

BlindFit fit_with(const Eigen::VectorXd& prior, const ModalModel& table,
                  const ContourSpectra& spectra, const BinVariances& variances, bool at_rest,
                  const Eigen::VectorXd& start_at) {
  MODCAL_REQUIRE(table.sensors.size() >= 2,
                 "{}: one response explains any model; modes are refined by two sensors and more",
                 table.sensors.size());
  const BlindLikelihood likelihood(spectra, table.sensors, variances, at_rest);
  const Eigen::VectorXd weight = prior.cwiseAbs2().cwiseInverse();
  const bool factors = prior.size() > 2 * std::ssize(table.poles);
  const double share = 2.0 / likelihood.correlated();
  BlindFit fit{.model = with_quadrature(table), .change = Eigen::VectorXd::Zero(weight.size())};
  const ModalModel start = fit.model;
  if (start_at.size() == fit.change.size()) {
    fit.change = start_at;
    fit.model = moved(start, start_at);
  }
  BlindPoint here = likelihood.at(fit.model);
  double cost = here.cost + weight.dot(fit.change.cwiseAbs2()), damping = 1e-3;
  Eigen::MatrixXd information;
  // As many steps as Levenberg and Marquardt take from a start within the priors, and some more.
  for (int step = 0; step < 30; ++step) {
    const Eigen::MatrixXd jacobian = likelihood.jacobian(start, fit.model, here, factors);
    information = share * (jacobian.transpose() * jacobian);
    information.diagonal() += weight;
    const Eigen::VectorXd slope =
        share * (jacobian.transpose() * here.residual) + weight.cwiseProduct(fit.change);
    bool better = false;
    double gain = 0.0;
    for (int round = 0; round < 8 && !better; ++round, damping *= better ? 1.0 : 10.0) {
      Eigen::MatrixXd matrix = information;
      matrix.diagonal() *= 1.0 + damping;
      const Eigen::VectorXd theta = fit.change - matrix.llt().solve(slope);
      const ModalModel model = moved(start, theta);
      BlindPoint there = likelihood.at(model);
      const double next = there.cost + weight.dot(theta.cwiseAbs2());
      better = next < cost;
      if (!better) continue;
      gain = cost - next;
      cost = next;
      fit.model = model;
      fit.change = theta;
      here = std::move(there);
    }
    damping *= 0.1;
    if (!better || gain < 1e-6) break;
  }
  fit.covariance = information.llt().solve(Eigen::MatrixXd::Identity(weight.size(), weight.size()));
  fit.root = Eigen::LLT<Eigen::MatrixXd>(fit.covariance).matrixL();
  // An unknown that the data do not tell counts for nothing.
  const double told = static_cast<double>(weight.size()) - fit.covariance.diagonal().dot(weight);
  fit.degrees = likelihood.numbers(table.poles.size()) - told;
  fit.misfit = here.cost / fit.degrees;
  fit.force = here.force;
  for (const double one : here.told) fit.force_variance.push_back(1.0 / one);
  return fit;
}

}  // namespace

ModalModel BlindFit::drawn(std::span<const double> normal) const {
  MODCAL_REQUIRE(std::ssize(normal) == change.size(), "{} normal numbers for {} unknowns",
                 normal.size(), change.size());
  const Eigen::Map<const Eigen::VectorXd> numbers(normal.data(), change.size());
  const Eigen::VectorXd step = root * numbers;
  return moved(model, step);
}

BlindFit fit_blindly(const ModalModel& table, const ContourSpectra& spectra,
                     const BinVariances& variances, const StructureChange& change, bool at_rest,
                     const Eigen::VectorXd& start_at) {
  return fit_with(prior_of(table, change), table, spectra, variances, at_rest, start_at);
}

BlindFit fit_ringing(const ModalModel& table, const StructureRecord& record,
                     std::span<const double> noise, double low, double high,
                     const StructureChange& change) {
  MODCAL_REQUIRE(
      noise.size() == table.sensors.size() && record.responses.size() == table.sensors.size(),
      "{} deviations and {} responses for {} sensors", noise.size(), record.responses.size(),
      table.sensors.size());
  BlindFit fit;
  for (const double sigma : {40.0, 20.0, 10.0, 5.0, 0.0}) {
    const auto spectra = ContourSpectra::of(record, sigma, low, high);
    BinVariances variances;
    for (const double sd : noise) {
      variances.of.emplace_back(spectra.count(), sd * sd * spectra.noise_power());
    }
    fit = fit_blindly(table, spectra, variances, change, false, fit.change);
  }
  return fit;
}

BlindFit refined_table(const StructureTable& table, const StructureRecord& record, double sigma,
                       const StructureChange& change, bool at_rest) {
  // What rings on behind the part that is taken has e^−8 of its amplitude.
  constexpr double rung_out = 8.0;
  table.require_modes("a refinement");
  const Eigen::VectorXd prior = prior_of(table, change);
  StructureTable refined = table;
  BlindFit fit;
  for (const double contour : {sigma, 0.5 * sigma, 0.25 * sigma, 0.25 * sigma}) {
    const bool ends = contour * record.duration() >= rung_out;
    if (!ends && contour < sigma) break;
    StructureRecord part{.sample_rate = record.sample_rate};
    const auto count =
        ends ? static_cast<std::ptrdiff_t>(std::floor(rung_out / contour * record.sample_rate))
             : static_cast<std::ptrdiff_t>(record.samples());
    for (const std::vector<double>& response : record.responses) {
      part.responses.emplace_back(response.begin(), response.begin() + count);
    }
    const auto spectra = ContourSpectra::of(part, contour, table.low, table.high);
    const BinVariances variances =
        variances_of(refined, spectra, transfers_of(refined.model, spectra));
    fit = fit_with(prior, table.model, spectra, variances, ends && at_rest, fit.change);
    refined.model = fit.model;
  }
  // The variances are those of what was left before the fit took its share.
  const double left = std::max(1.0, fit.misfit);
  fit.covariance *= left;
  fit.root *= std::sqrt(left);
  return fit;
}

}  // namespace modcal
