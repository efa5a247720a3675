// Simulates one second of a bow stroke on a violin's G string and writes what two force sensors at
// the ends of the string would record: simulate_stroke stroke.wav
#include <array>
#include <cstdio>

#include "libsim/io.hpp"
#include "libsim/simulate.hpp"

using namespace modcal;

int main(int argc, char** argv) {
  if (argc != 2) return std::puts("usage: simulate_stroke FILE.wav"), 2;
  Scene scene;
  scene.string.length = 0.33;            // [m]
  scene.string.linear_density = 3.1e-3;  // [kg/m]
  scene.string.fundamental = 196.0;      // [Hz]
  scene.bow.position = 0.03;             // x_c [m]
  scene.bow.velocity = 0.1;              // [m/s]
  scene.bow.normal_force = 1.0;          // [N]

  const Simulation run = simulate(scene);
  if (run.diverged_at) return std::puts(run.explanation.c_str()), 1;
  write_wav(argv[1], std::array{run.left_reaction, run.right_reaction},
            {.samples = WavSamples::kDouble});
  std::printf("%zu samples, the string slipped %zu times\n", run.force.size(), run.releases);
}
