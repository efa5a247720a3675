#include "libcalib/optimizers/settled_variables.hpp"

#include <cmath>

#include "libcalib/optimizers/tuning.hpp"

namespace modcal {
SettledVariables::SettledVariables(std::span<const double> start) : histories_(start.size()) {
  for (std::size_t i = 0; i < start.size(); ++i) histories_[i].stood.fill(start[i]);
}

bool SettledVariables::is_settled(std::size_t i, std::span<const double> position,
                                  const std::function<bool(std::size_t)>& reaches) const {
  const History& history = histories_[i];
  if (history.searches < 2) return false;
  if (std::abs(history.stood[0] - history.stood[2]) > kUnmovedSteps * history.step) return false;
  for (std::size_t j = 0; j < histories_.size(); ++j) {
    const bool moved =
        std::abs(position[j] - history.around[j]) > kReachingSteps * histories_[j].step;
    if (moved && (j == i || reaches(j))) return false;
  }
  return true;
}

void SettledVariables::searched(std::size_t i, std::span<const double> position,
                                const CandidateChoice& choice, double moved_to) {
  History& history = histories_[i];
  ++history.searches;
  history.step = choice.step;
  history.around.assign(position.begin(), position.end());
  advance(history, choice.place, moved_to);
}

void SettledVariables::left_out(std::size_t i, double moved_to) {
  advance(histories_[i], expected_place(i), moved_to);
}

void SettledVariables::advance(History& history, std::size_t place, double moved_to) {
  history.places = {place, history.places[0]};
  history.stood = {moved_to, history.stood[0], history.stood[1]};
}

}  // namespace modcal
