#include "libcalib/optimizers/staged/best_tests.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace modcal {

void BestTests::add(ScoreTest test) {
  const auto same = std::ranges::find(tests_, test.cause, &ScoreTest::cause);
  if (same == tests_.end()) {
    tried_.push_back({1.0, test.log_evidence, test.untold.diagonal()});
    tests_.push_back(std::move(test));
    return;
  }
  Tried& tried = tried_[static_cast<std::size_t>(same - tests_.begin())];
  const Eigen::VectorXd own = test.untold.diagonal();
  const double weight = std::exp(test.log_evidence - tried.log_evidence);
  const double old = std::min(1.0, 1.0 / weight), now = std::min(1.0, weight);
  tried.most = (old * tried.most).cwiseMax(now * own);
  tried.log_evidence = std::max(tried.log_evidence, test.log_evidence);
  tried.count += 1.0;
  const Eigen::MatrixXd untold = old * same->untold + now * test.untold;
  if (test.statistic > same->statistic) std::swap(*same, test);
  same->untold = untold;
  same->shift_per_root = std::max(same->shift_per_root, test.shift_per_root);
}

void BestTests::add_known(ScoreTest test) {
  if (known_.size() == 0) known_.setZero(test.untold.rows(), test.untold.cols());
  known_ += test.untold;
  body_.push_back(std::move(test));
}

std::optional<double> BestTests::named_place() const {
  const auto found = std::ranges::find_if(
      tests_, [](const ScoreTest& test) { return test.cause == kBridge && test.named(); });
  return found == tests_.end() ? std::nullopt : std::optional(found->place);
}

std::vector<ScoreTest> BestTests::take() {
  for (std::size_t i = 0; i < tests_.size(); ++i) {
    ScoreTest& test = tests_[i];
    test.log_p = std::min(0.0, test.log_p + std::log(tried_[i].count));
    // With the correlations of their sum.
    const Eigen::ArrayXd sum = test.untold.diagonal();
    const Eigen::VectorXd part = (sum > 0.0).select((tried_[i].most.array() / sum).sqrt(), 0.0);
    test.untold = part.asDiagonal() * test.untold * part.asDiagonal();
    if (test.cause == kBridge) change_body(test);
    if (!test.named() || !test.frees()) test.columns.clear();
    if (test.named() && test.cause == kBridge) {
      test.detail = bridge_detail(test.place, test.amplitude);
    }
  }
  doubt_resonance();
  return std::move(tests_);
}

// A mode of the body that is not as it was taken out looks like a further one beside it: the change
// of the one there is goes first unless it explains not half as much.
void BestTests::change_body(ScoreTest& further) {
  if (body_.empty()) return;
  const auto change = std::ranges::min_element(body_, {}, &ScoreTest::log_p);
  const bool first = change->frees() && change->log_p <= further.log_p;
  Eigen::MatrixXd untold = further.untold + known_;
  if (first) further = std::move(*change);
  further.untold = std::move(untold);
}

// Between two modes of the string a bridge looks like a sensor's resonance: what explains not
// twice as much may be a bridge, and what explains half as much may be the resonance.
void BestTests::doubt_resonance() {
  const auto bridge = std::ranges::find(tests_, kBridge, &ScoreTest::cause);
  const auto resonance = std::ranges::find(tests_, kResonance, &ScoreTest::cause);
  if (resonance == tests_.end() || resonance->statistic >= 2.0 * bridge->statistic) return;
  if (resonance->statistic > 0.5 * bridge->statistic) bridge->rivals.push_back(*resonance);
  tests_.erase(resonance);
}

}  // namespace modcal
