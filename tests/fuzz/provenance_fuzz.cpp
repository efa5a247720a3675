// provenance.json of a folder of results.
#include "experiments/cli/runner.hpp"
#include "experiments/runs/run_store.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace modcal::fuzz {
namespace {

// With a run of one list, whose provenance.json is replaced.
const std::filesystem::path& run_folder() {
  static const std::filesystem::path kFolder = [] {
    std::string name = (std::filesystem::temp_directory_path() / "modcal-fuzz-XXXXXX").string();
    std::filesystem::path folder = mkdtemp(name.data());
    std::ofstream(folder / kResolvedFile) << R"(kind: simulate
scene:
  string: {length: 0.33 m, linear_density: 3.1e-3 kg/m, fundamental: 196 Hz, modes: 10}
  bow: {position: 30 mm, velocity: 0.1 m/s, normal_force: 1 N}
  friction: {type: coulomb_exponential, static: 0.4, dynamic: 0.2, decay: 5 s/m}
  duration: 0.1 s
simulator: {type: modal_event}
measurement: {sample_rate: 12.5 kHz, noise_level: 1 %}
sweep: {product: {seed: [1, 2]}}
)";
    std::filesystem::create_directories(journal_folder(folder));
    std::atexit([] { std::filesystem::remove_all(run_folder()); });
    return folder;
  }();
  return kFolder;
}

}  // namespace
}  // namespace modcal::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace modcal;
  std::ofstream(fuzz::run_folder() / kProvenanceFile, std::ios::binary)
      << fuzz::text_of(data, size);
  fuzz::accepted([] {
    const StoredRun run(fuzz::run_folder());
    fuzz::require(run.tasks() == 2 && run.damages().empty(), "another list");
  });
  return 0;
}
