// Kind "schelleng": which motion a steady bow stroke settles in, over bow positions and forces.
#pragma once

#include "experiments/kinds/axis_experiment.hpp"
#include "libsim/dynamics/scene/string_regime.hpp"

namespace modcal {

/// Logarithmic axis of a map: `count` cells between two ends.
struct MapAxis {
  double lowest;
  double highest;
  std::int64_t count;
  std::string_view unit;
  void visit(OptionVisitor& visitor);
  /// The count + 1 borders of the cells.
  std::vector<double> edges() const;
  /// Geometric middle of a cell.
  double center(std::size_t index) const;
};

/// Motion at t = 0; in the order of kMapStarts.
enum class MapStart { kHelmholtz, kRest };
inline constexpr std::array<std::string_view, 2> kMapStarts = {"helmholtz", "rest"};

struct SchellengOptions {
  Scene scene;
  Choice<Simulator> simulator{"modal_event"};
  double sample_rate = 51200.0;
  MapAxis positions{0.02, 0.3, 64, "1"};  ///< x_c/L
  MapAxis forces{0.02, 30.0, 64, "N"};    ///< F_N
  std::string start = "helmholtz";
  RegimeCriteria criteria;
  void visit(OptionVisitor& visitor);

  std::size_t cells() const { return static_cast<std::size_t>(positions.count * forces.count); }
  /// Cells stand row by row, the lowest force first.
  std::size_t position_of(std::size_t cell) const {
    return cell % static_cast<std::size_t>(positions.count);
  }
  std::size_t force_of(std::size_t cell) const {
    return cell / static_cast<std::size_t>(positions.count);
  }
  MapStart starts_in() const;  ///< throws InvalidInput for another word
  Scene cell_scene(std::size_t cell) const;
  /// What a cell is judged by.
  OutputRequest outputs() const;
};

/// What one cell came to.
struct CellOutcome {
  StringRegime regime = StringRegime::kSilent;
  RegimeFeatures features;
  std::string failure;  ///< why there is no regime; empty: there is
  void visit(ResultVisitor& visitor);
  void visit_motion(ResultVisitor& visitor);  ///< regime and features
};

CellOutcome judge_cell(const Scene& scene, const Simulation& simulation,
                       const RegimeCriteria& criteria);

using CellOutcomes = std::vector<std::optional<CellOutcome>>;  ///< nullopt: not run yet

/// Adds map, limits, counts and the borders of Helmholtz motion beside Schelleng's to a result that
/// knows how many cells failed and how many are not run yet.
void sum_up_map(const SchellengOptions& options, const CellOutcomes& outcomes, StudyResult& result);
/// One cell with its waveforms.
StudyResult show_cell(const SchellengOptions& options, std::size_t cell,
                      const StudyContext& context);

/// Borders of the Helmholtz cells of one column over Schelleng's limits there; NaN where the border
/// is not on the map. The borders are those of the longest run of Helmholtz cells.
struct BorderRatios {
  double lowest;
  double highest;
};
std::vector<BorderRatios> border_ratios(const SchellengOptions& options,
                                        const CellOutcomes& outcomes);

/// Kind "schelleng": a map of the string's motion over bow positions and forces, a task a cell.
class SchellengExperiment final : public ProductExperiment {
 public:
  using Options = SchellengOptions;
  explicit SchellengExperiment(Options options);
  std::string_view for_structures() const override {
    return "schelleng tells the motions of a bowed string apart; for any other structure state "
           "kind: "
           "simulate with structure: {table: modes.yaml} and sweep: over "
           "structure.bow.normal_force";
  }
  std::vector<Finding> lint() const override;
  std::vector<PlanLine> plan() const override;
  std::optional<PlannedSimulations> planned_simulations() const override;

  std::string fingerprint(std::size_t task, const std::filesystem::path& folder) const override;
  std::string run_task(std::size_t task, const StudyContext& context) const override;
  StudyResult sum_up(const TaskOutcomes& outcomes, const StudyContext& context) const override;
  StudyResult replay(std::size_t task, const StudyContext& context) const override {
    return show_cell(options_, task, context);
  }

 private:
  Options options_;
};

}  // namespace modcal
