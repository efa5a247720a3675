// The model-based estimate as one of the estimators.

#include "libinverse/observer/model_check.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

class PreparedObserverEstimate final : public PreparedEstimator {
 public:
  PreparedObserverEstimate(const EstimationModel& model, const ModelBasedEstimator& estimator)
      : basis_(model.basis),
        contact_(model.contact),
        sample_rate_(model.sample_rate),
        samples_(model.samples),
        recorded_(model.recorded),
        bending_(model.bending),
        estimator_(estimator) {}

  std::vector<Estimate> estimate(const EstimationRecord& record,
                                 const InversionMethod& method) const override {
    for (std::size_t r = 0; r < 2; ++r) {
      MODCAL_REQUIRE(record.reactions[r].size() == samples_,
                     "the reaction at {} has {} samples: the model-based estimate needs both, {} "
                     "samples each; use estimator joint where one is missing",
                     r == 0 ? "x = 0" : "x = L", record.reactions[r].size(), samples_);
    }
    ModelBasedResult result =
        estimator_.estimate(basis_, contact_, sample_rate_, record.reactions[0],
                            record.reactions[1], {}, recorded_, bending_);
    Estimate estimate;
    estimate.side = "model";
    estimate.label = "model-based";
    estimate.result.choice.status = ChoiceStatus::kNoParameter;
    estimate.result.choice.kept_share = 1.0;
    if (method.outputs.force) estimate.result.force = std::move(result.force);
    if (method.outputs.displacement) {
      estimate.result.displacement = std::move(result.displacement);
    }
    if (method.outputs.velocity) estimate.result.velocity = std::move(result.velocity);
    estimate.unaliased_force = std::move(result.unaliased_force);
    estimate.misfit = result.misfit;
    estimate.figures = {{"steady_misfit", result.steady_misfit},
                        {"misfit_deviation", result.misfit_deviation},
                        {"static_level", result.static_part.level},
                        {"static_deviation", result.static_part.deviation}};
    if (method.outputs.force) estimate.force_deviations = std::move(result.deviation.force);
    if (method.outputs.velocity) {
      estimate.velocity_deviations = std::move(result.deviation.velocity);
    }
    estimate.notes = {observer::law_note(result)};
    estimate.warnings = std::move(result.warnings);
    return {std::move(estimate)};
  }

 private:
  ModalBasis basis_;
  double contact_, sample_rate_;
  std::size_t samples_;
  bool recorded_;
  std::optional<bool> bending_;
  ModelBasedEstimator estimator_;
};

}  // namespace

std::shared_ptr<const PreparedEstimator> ModelBasedEstimator::do_prepare(
    const EstimationModel& model) const {
  return std::make_shared<const PreparedObserverEstimate>(model, *this);
}

}  // namespace modcal
