// The paper's case as a pair of measured reactions, with the converged truth.
#pragma once

#include "libinverse/observer/model_based_estimator.hpp"
#include "libsim/dynamics/event/modal_event.hpp"
#include "libsim/dynamics/gestures/gesture.hpp"
#include "libsim/model/modal_basis.hpp"
#include "libsim/signal/measurement.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal {

constexpr double kRecordRate = 51200.0;
constexpr double kLightRate = 0.5 * kRecordRate;

struct BowedRecord {
  Scene scene;
  ModalBasis basis;
  Simulation truth;
  Signal left, right;
  double rate = kRecordRate;
};

inline Scene bowed_scene(double duration) {
  Scene scene = paper_scene();
  scene.duration = duration;
  return scene;
}

/// The paper's case with the lower half of its modes, for records at kLightRate: modes and samples
/// keep their proportion, a period costs a quarter.
inline Scene light_scene(double duration) {
  Scene scene = bowed_scene(duration);
  scene.string.modes = 25;
  return scene;
}

/// Reactions of a simulated motion with `noise` of their standard deviations, means removed.
inline void measure_again(BowedRecord& record, double noise, std::uint64_t seed = 1) {
  Measurement measurement;
  measurement.sample_rate = record.rate;
  measurement.noise_level = noise;
  const StreamKey key(seed);
  record.left = measure(record.truth.left_reaction, measurement, key.with("R1"));
  record.right = measure(record.truth.right_reaction, measurement, key.with("R2"));
}

template <class Simulator = ModalEvent>
BowedRecord record_of(const Scene& scene, double rate, double noise, std::uint64_t seed = 1) {
  BowedRecord record;
  record.scene = scene;
  record.basis = make_modal_basis(scene.string);
  record.rate = rate;
  record.truth = Simulator({}).simulate(scene, rate, OutputRequest::all());
  measure_again(record, noise, seed);
  return record;
}

inline BowedRecord bowed_record(double duration, double noise, std::uint64_t seed = 1,
                                double bow_velocity = 0.1) {
  Scene scene = bowed_scene(duration);
  scene.bow.velocity = bow_velocity;
  return record_of(scene, kRecordRate, noise, seed);
}

inline BowedRecord light_record(double duration, double noise, std::uint64_t seed = 1) {
  return record_of(light_scene(duration), kLightRate, noise, seed);
}

/// The light record under a bow whose velocity swings by ±10 %, once in 0.14 s.
inline BowedRecord swinging_record(double noise) {
  Scene scene = light_scene(0.14);
  SineGesture::Options swing;
  swing.amplitude = 0.1;
  swing.frequency = 1.0 / scene.duration;
  scene.bow.velocity_gesture = Choice<Gesture>::of<SineGesture>("sine", swing);
  return record_of(scene, kLightRate, noise);
}

/// The exponential law alone, by few substeps.
inline ModelBasedOptions quick_fit(std::int64_t rounds) {
  ModelBasedOptions options;
  options.laws = {"exponential"};
  options.substeps = 4;
  options.rounds = rounds;
  return options;
}

}  // namespace modcal
