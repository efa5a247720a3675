#include <array>

#include "libsim/dynamics/gestures/ramp_gesture.hpp"
#include "libsim/dynamics/gestures/sine_gesture.hpp"
#include "libsim/dynamics/gestures/steady_gesture.hpp"
#include "libsim/dynamics/gestures/table_gesture.hpp"

namespace modcal {

Registry<Gesture> Gesture::registry() {
  static constexpr std::array kTable = {
      entry_of<Gesture, RampGesture>("ramp", "linear change from one factor to another"),
      entry_of<Gesture, SineGesture>("sine", "sinusoidal change about a mean"),
      entry_of<Gesture, SteadyGesture>("steady", "no change"),
      entry_of<Gesture, TableGesture>("table", "straight lines through points in time"),
  };
  return kTable;
}

}  // namespace modcal
