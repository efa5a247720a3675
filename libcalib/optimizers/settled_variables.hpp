// Which variables of a repeated search need not be searched again.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace modcal {

/// One search of a variable: the candidate taken, and how far candidates lay apart.
struct CandidateChoice {
  std::size_t place = 0;  ///< among the candidates
  double step = 0.0;
};

/// History of a search of one variable after the other, all of them again and again.
///
/// A variable is settled where it stands within a tenth of its step of where it stood two searches
/// ago, and no variable that reaches it, nor it itself, stands more than a step of its own from
/// where it stood before the last search of this variable. An even number of candidates has none in
/// the middle: a settled variable then goes half a step to and fro, else it stays. Its next answer
/// is the one it gave two searches ago.
class SettledVariables {
 public:
  explicit SettledVariables(std::span<const double> start);

  /// reaches(j): whether variable j moves what variable i is searched by.
  bool is_settled(std::size_t i, std::span<const double> position,
                  const std::function<bool(std::size_t j)>& reaches) const;
  /// Place of the candidate that variable i, settled, is expected to take.
  std::size_t expected_place(std::size_t i) const { return histories_[i].places[1]; }

  /// Variable i was searched, with the others at `position`, and is now at `moved_to`.
  void searched(std::size_t i, std::span<const double> position, const CandidateChoice& choice,
                double moved_to);
  /// Variable i took its expected place and is now at `moved_to`.
  void left_out(std::size_t i, double moved_to);

 private:
  struct History {
    std::size_t searches = 0;
    std::array<std::size_t, 2> places{};  // the last first
    std::array<double, 3> stood{};        // now, and after the two answers before
    double step = 0.0;
    std::vector<double> around;  // all variables before the last search
  };
  static void advance(History& history, std::size_t place, double moved_to);

  std::vector<History> histories_;
};

}  // namespace modcal
