// The paper's case as a pair of measured reactions, with the converged truth.
#pragma once

#include "libsim/dynamics/simulators/modal_event.hpp"
#include "libsim/model/modal_basis.hpp"
#include "libsim/signal/measurement.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal {

constexpr double kRecordRate = 51200.0;

struct BowedRecord {
  Scene scene;
  ModalBasis basis;
  Simulation truth;
  Signal left, right;
};

/// Reactions of the paper's case with `noise` of their standard deviations, means removed.
inline BowedRecord bowed_record(double duration, double noise, std::uint64_t seed = 1,
                                double bow_velocity = 0.1) {
  BowedRecord record;
  record.scene = paper_scene();
  record.scene.duration = duration;
  record.scene.bow.velocity = bow_velocity;
  record.basis = make_modal_basis(record.scene.string);
  record.truth = ModalEvent({}).simulate(record.scene, kRecordRate, OutputRequest::all());
  Measurement measurement;
  measurement.noise_level = noise;
  const StreamKey key(seed);
  record.left = measure(record.truth.left_reaction, measurement, key.with("R1"));
  record.right = measure(record.truth.right_reaction, measurement, key.with("R2"));
  return record;
}

}  // namespace modcal
