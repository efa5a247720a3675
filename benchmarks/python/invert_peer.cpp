// The inversion of benchmarks/python/overhead.py in C++: invert_peer RECORD REPEATS, a file with
// the doubles of R1 and R2 at 51.2 kHz. Writes the force to RECORD.force and prints the processor
// time of each inversion in seconds.
#include <fmt/format.h>

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <vector>

#include "libinverse/invert.hpp"

using namespace modcal;

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const std::string path = argv[1];
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const auto samples = static_cast<std::size_t>(file.tellg()) / (2 * sizeof(double));
  std::vector<double> left(samples), right(samples);
  const auto bytes = static_cast<std::streamsize>(samples * sizeof(double));
  file.seekg(0).read(reinterpret_cast<char*>(left.data()), bytes);
  file.read(reinterpret_cast<char*>(right.data()), bytes);

  StringModel string;
  string.length = 0.33;
  string.linear_density = 3.1e-3;
  string.fundamental = 196.0;
  string.modes = 50;
  const ModalBasis basis = make_modal_basis(string);
  const InversionRecipe recipe{InversionOptions{}};
  const auto prepared = recipe.estimator().prepare({.basis = basis,
                                                    .contact = 0.03,
                                                    .samples = samples,
                                                    .sample_rate = 51200.0,
                                                    .recorded = true});
  std::vector<Estimate> found;
  for (int i = 0; i < std::atoi(argv[2]); ++i) {
    EstimationRecord record;
    record.reactions = {left, right};
    const std::clock_t begin = std::clock();
    found = prepared->estimate(
        record, recipe.method({.force = true, .displacement = false, .velocity = false}));
    fmt::print("{:.6f}\n", static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  }
  const std::vector<double>& force = found.front().result.force;
  std::ofstream(path + ".force", std::ios::binary)
      .write(reinterpret_cast<const char*>(force.data()),
             static_cast<std::streamsize>(force.size() * sizeof(double)));
}
