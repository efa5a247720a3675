// What the table's errors and the choice of the sensors do to the force.
#include <algorithm>
#include <optional>

#include "libinverse/structure/force/force_band.hpp"
#include "libinverse/structure/force/force_search.hpp"
#include "libsim/base/random.hpp"
#include "libsim/base/task_loop.hpp"

namespace modcal {

Eigen::VectorXd ForceSearch::by_models(const Eigen::VectorXd& best) const {
  std::vector<Eigen::VectorXd> forces(options_.draws);
  for_each_task(options_.draws, [&](std::size_t draw) {
    const DrawnModels models{table_, result_.refined, contradiction(), options_.seed};
    forces[draw] = force_by(models, draw);
  });
  Eigen::VectorXd variance = Eigen::VectorXd::Zero(best.size());
  for (const Eigen::VectorXd& force : forces) {
    variance += (force - best).cwiseAbs2() / static_cast<double>(options_.draws);
  }
  return variance;
}

double ForceSearch::contradiction() const {
  return std::isnan(variances_.misfit) ? 1.0 : std::max(1.0, variances_.misfit);
}

Eigen::VectorXd ForceSearch::by_sensors() const {
  const std::size_t sensors = transfers_.size();
  if (sensors < 3 + others_.size()) return {};
  std::vector<Eigen::VectorXd> forces(sensors);
  for_each_task(sensors, [&](std::size_t k) {
    forces[k] = force_of(evidence_of(spectra_, transfers_, variances_, k));
  });
  return jackknife(forces);
}

BinVariances ForceSearch::with_drawn_contacts(std::size_t draw) const {
  BinVariances result = variances_;
  const std::optional<BlindFit> none;
  for (std::size_t q = 0; q < contacts_.size(); ++q) {
    // Each table has errors of its own.
    const DrawnModels models{contacts_[q].table, none, contradiction(), options_.seed + q + 1};
    result.others[q].transfers = models.at(draw, spectra_);
  }
  return result;
}

Eigen::VectorXd ForceSearch::force_by(const DrawnModels& models, std::size_t draw) const {
  const Transfers transfers = models.at(draw, spectra_);
  const BinVariances drawn = contacts_.empty() ? BinVariances() : with_drawn_contacts(draw);
  const BinVariances& variances = contacts_.empty() ? variances_ : drawn;
  if (recorded_.empty()) return force_of(evidence_of(spectra_, transfers, variances, kNoSensor));
  ContourSpectra own = spectra_;
  own.responses = recorded_;
  const InitialState state(models.modes(draw), own);
  const InitialState::Fit fit = state.fit(transfers, variances, power_, state_widths(state));
  std::vector<double> normal(static_cast<std::size_t>(fit.state.size()));
  fill_standard_normal(StreamKey(options_.seed).with("state").with(draw), normal);
  own.responses = state.without(
      fit.state + fit.root * Eigen::Map<const Eigen::VectorXd>(normal.data(), fit.state.size()));
  return force_of(evidence_of(own, transfers, variances, kNoSensor));
}

}  // namespace modcal
