#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <vector>

#include "libsim/dynamics/event/sticking.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal::event::sticking_block_test {
namespace {

using Complex = std::complex<double>;

struct Shown {
  double duration;
  std::vector<double> force;
};

class Pieces final : public ForceObserver {
 public:
  void piece(const ForcePiece& piece) override {
    all.push_back({piece.duration, {piece.force.begin(), piece.force.end()}});
  }
  void attached(double) override {}
  void released() override {}
  std::vector<Shown> all;
};

// Every piece is as long as its 25 powers tell the force to 1e-17 of the limit, Σ |w_j| (|μ_j|
// t)²⁵/25! of what is left out, and together they are the stretch. The size of w_j is taken for |Re
// w_j| + |Im w_j|, at most √2 of it.
TEST(Sticking, ShowsAStretchInPiecesAsLongAsTheirSeriesReach) {
  constexpr double kLimit = 10.0, kStiffness = 1e5, kStretch = 0.02;
  const ContactModes modes = contact_modes(make_modal_basis(paper_scene().string), 0.03, {});
  const double damping = 2.0 * std::sqrt(kStiffness * modes.effective_mass());
  const ContactParameters contact{.stiffness = kStiffness, .damping = damping};
  Sticking held = held_string(modes, contact, StaticLimit(kLimit), 1.0 / 51200.0, {});
  PlanarVector open(modes.size());
  for (std::size_t n = 0; n < modes.size(); ++n) open.set(n, {1e-6, 0.0});
  held.attach({}, open, 0.0, 0.0);
  const PlanarVector start = held.state();
  const auto loop = make_closed_loop(modes, kStiffness, damping);
  ASSERT_TRUE(loop.has_value());
  Pieces pieces;
  held.show(start, 0.0, kStretch, pieces);

  double from = 0.0;
  for (std::size_t i = 0; i < pieces.all.size(); ++i) {
    const Shown& piece = pieces.all[i];
    double left_out = 0.0, force = 0.0, size = 0.0;
    for (std::size_t j = 0; j < loop->roots; ++j) {
      const Complex w = start.at(j) * std::exp(loop->pole.at(j) * from);
      const double phase = std::abs(loop->pole.at(j)) * piece.duration;
      left_out += std::abs(w) * std::exp(25.0 * std::log(phase) - std::lgamma(26.0));
      force += w.real();
      size += std::abs(w);
    }
    EXPECT_NEAR(piece.force[0], force, 1e-10 * size) << i;  // phases of 1e4 rad at most
    if (i + 1 < pieces.all.size()) {
      EXPECT_LT(left_out, 1e-17 * kLimit * (1.0 + 1e-6)) << i;
      EXPECT_GT(left_out, 1e-17 * kLimit / std::sqrt(2.0) * (1.0 - 1e-6)) << i;
      double end = 0.0;
      for (const double power : piece.force) end += power;
      EXPECT_NEAR(end, pieces.all[i + 1].force[0], 1e-10 * size) << i;
    }
    from += piece.duration;
  }
  EXPECT_GT(pieces.all.size(), 3u);
  EXPECT_NEAR(from, kStretch, 1e-14);
}

}  // namespace
}  // namespace modcal::event::sticking_block_test
