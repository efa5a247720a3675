// Calibration to the bound on one second of the paper's string with 1 % noise, from ±2 % in every
// frequency and 1.5 mm in x_c: the law alone, and every frequency. Prints medians; with
// --write_case=FILE data, starts, results and times go to a file for
// peers/joint_likelihood_fit.py.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "benchmarks/noisy_stroke.hpp"

namespace modcal {
namespace {

struct Timed {
  ContinuationResult found;
  double seconds = 0.0;  // median
};

Timed calibrate_case(const NoisyStroke& the, bool frequencies, std::size_t repetitions) {
  ContinuationOptions options = the.options;
  options.law_width = 2e-3;  // every frequency on its own data
  options.frequencies = frequencies;
  Timed result;
  std::vector<double> seconds;
  for (std::size_t i = 0; i < repetitions; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    result.found = calibrate_by_continuation(the.start, the.data, options);
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
    seconds.push_back(taken.count());
  }
  result.seconds = quantile(seconds, 0.5);
  return result;
}

// Raw doubles: K, f_s, N, x_c, L, T, m, zeta, s_1, s_2; seconds of law and of all, f0, B and x_c of
// the law, x_c of all; initial and found f (N each); R1, R2 (K each).
void write_case(const char* path, const NoisyStroke& the, const Timed& law, const Timed& all) {
  const ModalBasis& basis = the.start.basis;
  std::vector<double> numbers = {static_cast<double>(the.left.size()),
                                 kRate,
                                 static_cast<double>(basis.size()),
                                 the.start.contact,
                                 basis.length,
                                 basis.tension,
                                 basis.mass[0],
                                 basis.zeta[0],
                                 the.options.left_noise,
                                 the.options.right_noise,
                                 law.seconds,
                                 all.seconds,
                                 law.found.law.fundamental,
                                 law.found.law.inharmonicity,
                                 law.found.model.contact,
                                 all.found.model.contact};
  for (std::size_t n = 0; n < basis.size(); ++n) numbers.push_back(basis.frequency(n));
  for (const ModeVerdict& mode : all.found.modes) numbers.push_back(mode.frequency);
  for (const ModeVerdict& mode : all.found.modes) numbers.push_back(mode.deviation);
  numbers.insert(numbers.end(), the.left.begin(), the.left.end());
  numbers.insert(numbers.end(), the.right.begin(), the.right.end());
  std::FILE* file = std::fopen(path, "wb");
  const bool ok = file != nullptr && std::fwrite(numbers.data(), sizeof(double), numbers.size(),
                                                 file) == numbers.size();
  if (file == nullptr || std::fclose(file) != 0 || !ok) {
    std::perror(path);
    std::exit(1);
  }
}

void print(std::string_view what, const Timed& timed, const NoisyStroke& the) {
  fmt::print("{:<18} median {:7.1f} ms, {} evaluations, {}, x_c off by {:.2g} m\n", what,
             1e3 * timed.seconds, timed.found.evaluations, timed.found.right ? "right" : "WRONG",
             timed.found.model.contact - the.truth.contact);
}

}  // namespace
}  // namespace modcal

int main(int argc, char** argv) {
  using namespace modcal;
  constexpr std::string_view kWrite = "--write_case=";
  const NoisyStroke the = make_noisy_stroke();
  const Timed law = calibrate_case(the, false, 5);
  const Timed all = calibrate_case(the, true, 5);
  print("law", law, the);
  print("all frequencies", all, the);
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]).starts_with(kWrite)) {
      write_case(argv[i] + kWrite.size(), the, law, all);
    }
  }
}
