// Reconstructions from the waves of both reactions, beside the modal estimates.
#include "experiments/kinds/invert/invert.hpp"
#include "experiments/report/result.hpp"
#include "libinverse/waves/wave_reconstruction.hpp"

namespace modcal {
namespace {

struct Method {
  const char* name;
  decltype(&reconstruct_from_waves) reconstruct;
  OutgoingWave outgoing;
};

constexpr Method kMethods[] = {
    {"ideal string, wave to x = 0", reconstruct_from_waves, OutgoingWave::kLeft},
    {"ideal string, wave to x = L", reconstruct_from_waves, OutgoingWave::kRight},
    {"loss and dispersion, wave to x = 0", reconstruct_with_loss, OutgoingWave::kLeft},
    {"loss and dispersion, wave to x = L", reconstruct_with_loss, OutgoingWave::kRight},
};

}  // namespace

void add_wave_based(const Observation& observation, const AssumedModel& model,
                    const ScoreOptions& score, StudyResult& result) {
  require_both_reactions(observation, "the wave-based reconstruction", "wave_based");
  if (!observation.reference) return;
  report::Table table{.id = "wave_based",
                      .title = "Wave-based reconstruction",
                      .caption = "f = 2 Z0 (v1o - v2i) and its mirror, from the two reactions."};
  for (const Method& method : kMethods) {
    const WaveReconstruction wave =
        method.reconstruct(model.basis, model.contact, observation.sample_rate,
                           observation.reaction(End::kLeft)->samples,
                           observation.reaction(End::kRight)->samples, method.outgoing);
    for (const WindowScore& window :
         scores_of(observation, ScoredForce(wave.force), &score).scores) {
      report::add_row(table, [&](ResultVisitor& row) {
        row({.key = "method"}, method.name);
        row({}, window);
      });
      result.summary += fmt::format("waves, {}  {}\n", method.name, window.text());
    }
  }
  result.add({std::move(table)});
}

}  // namespace modcal
