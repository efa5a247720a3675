#include "libinverse/spectral/one_sided/one_sided_estimator.hpp"

#include <memory>

#include "libinverse/spectral/one_sided/one_sided_inversion.hpp"
#include "libsim/model/transfer.hpp"

namespace modcal {
namespace {

class PreparedOneSided final : public PreparedEstimator {
 public:
  explicit PreparedOneSided(const EstimationModel& model) {
    const FrequencyGrid grid = FrequencyGrid::of_record(model.samples, model.sample_rate);
    const auto transfer = string_model(model.basis, model.contact).transfer(grid);
    for (std::size_t r = 0; r < 2; ++r) {
      sides_.emplace_back(transfer[r], transfer[2], model.samples, model.sample_rate);
    }
  }

  std::vector<Estimate> estimate(const EstimationRecord& record,
                                 const InversionMethod& method) const override {
    static constexpr const char* kNames[] = {"1", "2"};
    static constexpr const char* kLabels[] = {"from R1 (x = 0)", "from R2 (x = L)"};
    std::vector<Estimate> estimates;
    for (std::size_t r = 0; r < 2; ++r) {
      if (record.reactions[r].empty()) continue;
      InversionMethod of_side = method;
      of_side.noise_rms = record.stated_noise[r];
      Estimate estimate;
      estimate.side = kNames[r];
      estimate.label = kLabels[r];
      estimate.result = sides_[r].invert(record.reactions[r], of_side);
      const auto sigma = sides_[r].problem().sigma();
      estimate.largest_transfer = sigma.empty() ? 0.0 : sigma[0];
      estimate.warnings = estimate.result.choice.warnings;
      estimates.push_back(std::move(estimate));
    }
    return estimates;
  }

 private:
  std::vector<OneSidedInversion> sides_;
};

}  // namespace

std::shared_ptr<const PreparedEstimator> OneSidedEstimator::do_prepare(
    const EstimationModel& model) const {
  return std::make_shared<const PreparedOneSided>(model);
}

}  // namespace modcal
