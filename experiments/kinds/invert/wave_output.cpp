#include "experiments/kinds/invert/wave_output.hpp"

#include "libinverse/waves/wave_reconstruction.hpp"
#include "libsim/base/error.hpp"

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
                    const ScoreOptions& score, const std::string& command, StudyResult& result) {
  for (const End end : kEnds) {
    MODCAL_REQUIRE(observation.reaction(end).has_value(),
                   "the wave-based reconstruction needs both reactions: the one at {} is missing; "
                   "leave out wave_based or record it",
                   label_of(end));
  }
  if (!observation.reference) return;
  report::Table table{.id = "wave_based",
                      .title = "Wave-based reconstruction",
                      .caption = "f = 2 Z0 (v1o - v2i) and its mirror, from the two reactions.",
                      .columns = {{.key = "method"},
                                  {.key = "window_start", .name = "window from", .unit = "s"},
                                  {.key = "R", .name = "correlation R", .format = "{:.4f}"},
                                  {.key = "rms", .name = "relative rms error"}},
                      .command = command};
  const ScoreReference reference{.truth = *observation.reference,
                                 .anti_aliased = observation.anti_aliased,
                                 .anti_alias_cut = observation.anti_alias_cut,
                                 .fundamental = observation.fundamental};
  for (const Method& method : kMethods) {
    const WaveReconstruction wave =
        method.reconstruct(model.basis, model.contact, observation.sample_rate,
                           observation.reaction(End::kLeft)->samples,
                           observation.reaction(End::kRight)->samples, method.outgoing);
    const Signal force{"f_c", "N", observation.sample_rate, wave.force};
    for (const WindowScore& window : score_windows(force, reference, score)) {
      table.rows.push_back(
          {method.name, window.start, window.correlation, window.relative_rms_error});
      result.summary +=
          fmt::format("waves, {}  window from {:g} s: R = {:.4f}, relative rms error {:.4f}\n",
                      method.name, window.start, window.correlation, window.relative_rms_error);
    }
  }
  result.blocks.emplace_back(std::move(table));
}

}  // namespace modcal
