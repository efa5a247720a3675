#include "experiments/kinds/lint_bow.hpp"

#include <cmath>

#include "experiments/kinds/lint.hpp"

namespace modcal {
namespace {

// Of hands: a bow is drawn at up to 2 m/s and pressed with up to 5 N.
void lint_hand(const std::string& path, const Bow& bow, std::vector<Finding>& findings) {
  constexpr double kFastest = 20.0, kStrongest = 100.0;  // [m/s], [N]
  const auto warn = [&](const char* key, double value, const char* unit) {
    findings.push_back({path + key,
                        fmt::format("{:g} {} are beyond any hand: check the unit, a bare "
                                    "number is in {}",
                                    value, unit, unit),
                        false});
  };
  if (std::abs(bow.velocity) > kFastest) warn(".velocity", bow.velocity, "m/s");
  if (bow.normal_force > kStrongest) warn(".normal_force", bow.normal_force, "N");
}

// A gesture that begins behind the end of the scene does nothing.
void lint_gesture(const std::string& path, const Choice<Gesture>& gesture, double duration,
                  std::vector<Finding>& findings) {
  lint_making(findings, path, [&] {
    const auto made = gesture.make();
    if (!(duration > 0.0 && std::isfinite(duration))) return;
    const PiecewiseLinear factor = made->over(duration);
    const std::vector<double>& times = factor.times();
    MODCAL_REQUIRE(times.size() < 2 || times.front() < duration,
                   "the gesture begins at {:g} s, behind the end of the scene at {:g} s: state "
                   "earlier times or a longer {}.duration",
                   times.front(), duration, path.substr(0, path.find('.')));
  });
}

}  // namespace

void lint_bow(const std::string& path, const Bow& bow, double duration,
              std::vector<Finding>& findings) {
  lint_hand(path, bow, findings);
  lint_gesture(path + ".velocity_gesture", bow.velocity_gesture, duration, findings);
  lint_gesture(path + ".force_gesture", bow.force_gesture, duration, findings);
  lint_making(findings, path, [&] { bow_motion(bow, duration); });
}

}  // namespace modcal
