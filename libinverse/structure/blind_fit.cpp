#include "libinverse/structure/blind_fit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "libinverse/structure/blind_likelihood.hpp"
#include "libinverse/structure/tuning.hpp"
#include "libsim/base/dense_solvers.hpp"
#include "libsim/base/error.hpp"
#include "libsim/base/task_loop.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

// With what the table itself does not know of its poles.
Eigen::VectorXd prior_of(const StructureTable& table, const StructureChange& change) {
  Eigen::VectorXd sd = deviations_of(change, table.model);
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

// C J of columns J of a BlindLikelihood, C the correlation of a sensor's bins.
Eigen::MatrixXd times_correlation(const ContourSpectra& spectra, const Eigen::MatrixXd& columns) {
  const BinCorrelation correlation(spectra);
  const auto sensors = static_cast<Index>(spectra.responses.size());
  const Index padded = columns.rows() / (2 * sensors);
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(columns.rows(), columns.cols());
  for_each_task(static_cast<std::size_t>(columns.cols()), [&](std::size_t c) {
    const auto column = static_cast<Index>(c);
    std::vector<Complex> own(spectra.count());
    for (Index re = 0; re < sensors * padded; re += padded) {
      const Index im = re + sensors * padded;
      Index i = 0;
      for (Complex& bin : own) bin = {columns(re + i, column), columns(im + i, column)}, ++i;
      correlation.multiply(own);
      i = 0;
      for (const Complex& bin : own) {
        result(re + i, column) = bin.real();
        result(im + i++, column) = bin.imag();
      }
    }
  });
  return result;
}

// A⁻¹ (B + Π) A⁻¹, how far θ scatters: A = (2/κ) JᵀJ + Π is the curvature of what is minimized, in
// which of κ bins one counts; B = (2/κ²) JᵀCJ the variance of its slope, by how the bins of the
// contour are correlated (Huber, 1967). A⁻¹ alone is half of it where a response dies out faster
// than the weights. With M = A − Π, what θ takes of 2|e|²/κ is 2 tr A⁻¹B − tr A⁻¹M A⁻¹(B + Π), and
// θ itself has the variance A⁻¹ (B + M Π⁻¹ M) A⁻¹ where the prior is right. Without correlation
// B = M: tr A⁻¹M and M A⁻¹ Π⁻¹. What c takes is tr QᵀCQ/κ of a basis Q of its columns.
void tell_deviations(const ContourSpectra& spectra, const Eigen::MatrixXd& jacobian,
                     const Eigen::MatrixXd& ends, BlindFit& fit) {
  const double correlated = spectra.correlated();
  // Of θ over its prior's deviations: Π = 1, whatever the deviations of constants near nodes are.
  const Eigen::MatrixXd slopes = jacobian * fit.prior.asDiagonal();
  MODCAL_REQUIRE(
      slopes.allFinite(),
      "the modes cannot be refined: a response is not finite, or a sensor does not move; "
      "leave that one out");
  const bool is_white = spectra.grid.sigma == 0.0;
  const auto correlate = [&](const Eigen::MatrixXd& columns) {
    return is_white ? columns : times_correlation(spectra, columns);
  };
  const auto one = Eigen::MatrixXd::Identity(slopes.cols(), slopes.cols());
  const Eigen::MatrixXd made = 2.0 / correlated * square_of(slopes);  // M
  const Eigen::MatrixXd scatter =
      2.0 / (correlated * correlated) * (slopes.transpose() * correlate(slopes));  // B
  const PositiveSolver curvature(made + one);
  const Eigen::MatrixXd inverse = curvature.solve(one);
  fit.told = 1.0 - inverse.diagonal().array();
  const Eigen::MatrixXd pull = inverse * made;  // of θ towards its true value
  const Eigen::VectorXd moves = (inverse * scatter * inverse + pull * pull.transpose()).diagonal();
  fit.expected = fit.prior.cwiseProduct(moves.cwiseMax(0.0).cwiseSqrt());
  fit.degrees = fit.numbers - (inverse * scatter * (2.0 * one - inverse * made)).trace() +
                (pull * inverse).trace();
  if (ends.cols() > 0) fit.degrees -= ends.cwiseProduct(correlate(ends)).sum() / correlated;
  const Eigen::MatrixXd root = PositiveSolver(scatter + one).factor().matrixL();
  fit.root = fit.prior.asDiagonal() * curvature.solve(root);
  fit.covariance = fit.root * fit.root.transpose();
}

// Variances by the model so far. What a table that is off contradicts, and what rings at the ends,
// count as noise until the same contour has been fitted once: then the ends are taken out, and of
// the numbers that the data are worth so many are left as the fit had degrees of freedom.
BinVariances variances_beside(const StructureTable& table, const ContourSpectra& spectra,
                              const BlindFit& fit, bool is_fitted) {
  const Transfers transfers = transfers_of(table.model, spectra);
  // Of a tenth and less of the numbers nothing follows for the others.
  if (!is_fitted || fit.degrees < 0.1 * fit.numbers) return variances_of(table, spectra, transfers);
  ContourSpectra between = spectra;
  between.responses = fit.between;
  BinVariances variances = variances_of(table, between, transfers);
  for (std::vector<double>& of : variances.of) {
    for (double& one : of) one *= fit.numbers / fit.degrees;
  }
  return variances;
}

double mean_logarithm(const BinVariances& variances) {
  double sum = 0.0, count = 0.0;
  for (const std::vector<double>& of : variances.of) {
    for (const double one : of) sum += std::log(one);
    count += static_cast<double>(of.size());
  }
  return sum / count;
}

// Of the sum of squares, by which a step is the last one: a thousandth of a deviation; a third
// where what is fitted with changes anyway.
constexpr double kLeastGain = 1e-6, kLeastGainOnTheWay = 0.1;

// Sizes by what the fit has found with them; whether they were right to a tenth.
bool resize(const BlindFit& fit, StructureChange& change) {
  const auto modes = static_cast<Index>(fit.model.poles.size());
  bool is_settled = true;
  const auto update = [&](double StructureChange::*size, Index first, Index end, Index step) {
    double squares = 0.0, told = 0.0;
    for (Index i = first; i < end; i += step) {
      squares += std::pow(fit.change[i] / fit.prior[i], 2);
      told += fit.told[i];
    }
    if (!(told > 0.0)) return;
    // The mean of a variance that is told by so many numbers (Jeffreys' prior), twice at most.
    const double ratio = std::sqrt(squares / std::max(told - 2.0, 0.5 * told));
    const double usual = StructureChange().*size, before = change.*size;
    change.*size =
        std::clamp(before * std::clamp(ratio, 0.3, 3.0), kLeastChange * usual, kMostChange * usual);
    is_settled = is_settled && std::abs(change.*size / before - 1.0) < 0.1;
  };
  update(&StructureChange::frequency, 0, 2 * modes, 2);
  update(&StructureChange::damping, 1, 2 * modes, 2);
  update(&StructureChange::residue, 2 * modes, fit.change.size(), 1);
  return is_settled;
}

BlindFit fit_with(const Eigen::VectorXd& prior, const ModalModel& table,
                  const ContourSpectra& spectra, const BinVariances& variances, bool at_rest,
                  const Eigen::VectorXd& start_at, double least_gain = kLeastGain) {
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
    fit.model = moved_by(start, start_at);
  }
  BlindPoint here = likelihood.at(fit.model);
  double cost = here.cost + weight.dot(fit.change.cwiseAbs2()), damping = 1e-3;
  Eigen::MatrixXd jacobian;
  // As many steps as Levenberg and Marquardt take from a start within the priors, and some more.
  for (int step = 0; step < 30; ++step) {
    jacobian = likelihood.jacobian(start, fit.model, here, factors);
    Eigen::MatrixXd information = share * square_of(jacobian);
    information.diagonal() += weight;
    const Eigen::VectorXd slope =
        share * (jacobian.transpose() * here.residual) + weight.cwiseProduct(fit.change);
    bool better = false;
    double gain = 0.0;
    for (int round = 0; round < 8 && !better; ++round, damping *= better ? 1.0 : 10.0) {
      Eigen::MatrixXd matrix = information;
      matrix.diagonal() *= 1.0 + damping;
      const Eigen::VectorXd theta = fit.change - PositiveSolver(matrix).solve(slope);
      const ModalModel model = moved_by(start, theta);
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
    if (!better || gain < least_gain) break;
  }
  fit.prior = prior;
  fit.numbers = likelihood.numbers();
  tell_deviations(spectra, jacobian, here.span.basis(), fit);
  if (fit.degrees >= 1.0) fit.misfit = here.cost / fit.degrees;
  fit.between = likelihood.without_ends(fit.model, here);
  fit.force = here.force;
  for (const double one : here.told) fit.force_variance.push_back(1.0 / one);
  return fit;
}

}  // namespace

BlindFit fit_blindly(const ModalModel& table, const ContourSpectra& spectra,
                     const BinVariances& variances, const StructureChange& change, bool at_rest,
                     const Eigen::VectorXd& start_at) {
  return fit_with(deviations_of(change, table), table, spectra, variances, at_rest, start_at);
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
  StructureChange allowed = change;
  StructureTable refined = table;
  BlindFit fit;
  double contour = 0.0, level = 0.0;
  bool is_settled = false;
  // Four as a rule; more where the table was so far off that the variances have not settled, to 2
  // %, a hundredth of the deviations.
  for (int pass = 0; pass < 16; ++pass) {
    const double share = pass < 2 ? 1.0 / (1.0 + pass) : 0.25, before = contour;
    if (before == 0.0 || share * sigma * record.duration() >= rung_out) contour = share * sigma;
    const bool ends = contour * record.duration() >= rung_out;
    StructureRecord part{.sample_rate = record.sample_rate};
    const auto count =
        ends ? static_cast<std::ptrdiff_t>(std::floor(rung_out / contour * record.sample_rate))
             : static_cast<std::ptrdiff_t>(record.samples());
    for (const std::vector<double>& response : record.responses) {
      part.responses.emplace_back(response.begin(), response.begin() + count);
    }
    const auto spectra = ContourSpectra::of(part, contour, table.low, table.high);
    const BinVariances variances = variances_beside(refined, spectra, fit, contour == before);
    const double least_gain = is_settled || pass == 15 ? kLeastGain : kLeastGainOnTheWay;
    fit = fit_with(prior_of(table, allowed), table.model, spectra, variances, ends && at_rest,
                   fit.change, least_gain);
    fit.allowed = allowed;
    refined.model = fit.model;
    const double last = std::exchange(level, mean_logarithm(variances));
    const bool is_last = is_settled;
    is_settled =
        (!change.is_found || resize(fit, allowed)) && pass >= 2 && std::abs(level - last) < 0.02;
    if (is_last && is_settled) break;
  }
  const double left = std::max(1.0, fit.misfit);
  fit.covariance *= left;
  fit.root *= std::sqrt(left);
  return fit;
}

}  // namespace modcal
