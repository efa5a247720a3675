// Of the tests of one cause at several places the best.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "libcalib/identifiability/misfit_causes.hpp"

namespace modcal {

/// Tests of one cause by one name each: of those tried at several places the one found best, with
/// what they leave untold. There may be a mode of the body at any place: of every unknown it is the
/// most of all, each by its evidence over that of the best.
class BestTests {
 public:
  void add(ScoreTest test);
  /// Of a mode of the body that was taken out: what it leaves untold counts whole.
  void add_known(ScoreTest test);
  /// Of a bridge that is named [Hz].
  std::optional<double> named_place() const;
  std::vector<ScoreTest> take();

 private:
  void change_body(ScoreTest& further);
  void doubt_resonance();

  struct Tried {
    double count;          // places
    double log_evidence;   // the largest
    Eigen::VectorXd most;  // of the diagonals of what they leave untold
  };
  std::vector<ScoreTest> tests_;
  std::vector<Tried> tried_;
  std::vector<ScoreTest> body_;  // changes of the modes of the body that were taken out
  Eigen::MatrixXd known_;        // what those leave untold
};

}  // namespace modcal
