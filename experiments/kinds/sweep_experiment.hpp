#pragma once

#include "experiments/experiment.hpp"
#include "experiments/kinds/sweep_study.hpp"

namespace modcal {

/// Options of kind "sweep": those of an inversion, the axes, the table.
struct SweepExperimentOptions final : public SweepSlot {
  InvertOptions base;
  SweepOptions sweep;
  std::vector<SweepAxis> sweep_axes;
  std::vector<InvertOptions> cell_options;

  void visit(OptionVisitor& visitor);
  const std::vector<SweepAxis>& axes() const override { return sweep_axes; }
  void set_axes(std::vector<SweepAxis> axes) override;
  std::size_t cells() const override { return cell_options.size(); }
  void visit_cell(std::size_t index, OptionVisitor& visitor) override {
    cell_options[index].visit(visitor);
  }
};

/// Kind "sweep": the same inversion over axes of settings, summed up in a table.
class SweepExperiment final : public Experiment {
 public:
  using Options = SweepExperimentOptions;
  explicit SweepExperiment(Options options) : options_(std::move(options)) {}
  std::vector<Finding> lint() const override;
  std::vector<std::string> plan() const override;
  StudyResult run(const StudyContext& context) const override;

 private:
  std::vector<SweepCell> cells() const;
  Options options_;
};

}  // namespace modcal
