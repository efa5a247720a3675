// Friction force and motion at the bow from the reactions at both ends of the string:
// invert_record stroke.wav
#include <cstdio>

#include "libinverse/invert.hpp"
#include "libsim/io.hpp"

using namespace modcal;

int main(int argc, char** argv) {
  if (argc != 2) return std::puts("usage: invert_record FILE.wav"), 2;
  RecordOptions channels{.file = argv[1], .has_left = true, .has_right = true};
  channels.left.channel = "R1";
  channels.right.channel = "R2";
  const RecordedSignals record = load_record(channels, ".");

  const StringModel string{.length = 0.33, .linear_density = 3.1e-3, .fundamental = 196.0};
  const ModalBasis basis = make_modal_basis(string);
  const InversionRecipe recipe({.estimator = Choice<Estimator>("joint")});
  const auto estimator = recipe.estimator().prepare({.basis = basis,
                                                     .contact = 0.03,
                                                     .samples = record.size(),
                                                     .sample_rate = record.sample_rate});
  const ReactionPair reactions = {record.left->samples, record.right->samples};
  const auto estimates = estimator->estimate({.reactions = reactions}, recipe.method());
  for (const Estimate& found : estimates) {
    std::printf("force %s: %zu samples, standard deviation %.2g N\n", found.label.c_str(),
                found.result.force.size(), found.force_deviation);
  }
}
