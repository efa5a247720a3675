// One fit to several records of one string: strokes, contact points, plucks.
#pragma once

#include <span>
#include <vector>

#include "libcalib/optimizers/staged/continuation.hpp"

namespace modcal {

/// Both reactions of the string left to itself after a pluck.
struct PluckRecord {
  CalibrationData data;
  /// Noise standard deviation of each reaction [N]; NaN: estimated from the record.
  std::array<double, 2> noise{std::numeric_limits<double>::quiet_NaN(),
                              std::numeric_limits<double>::quiet_NaN()};
};

/// Sensors and damping as one record has them, its own or shared.
struct RecordValues {
  SensorPair sensors;
  std::array<double, 3> sensor_deviation{};  ///< of gain, delay [s], corner [Hz]; 0: not free
  /// Factor of all initial ζ_n that are free; where each is, their geometric mean.
  double damping = 1.0;
  double damping_deviation = 0.0;
};

struct RecordsFit {
  ModelPoint model;              ///< shared; the contact of the first record
  std::vector<double> contacts;  ///< x_c of every stroke [m]
  std::vector<double> contact_deviations;
  /// The law as all records have it, fitted by itself where every frequency is free too; the
  /// contact of the first record.
  LawEstimate law;
  /// Relative standard deviations of f_n, where every frequency is free.
  std::vector<double> frequency_deviations;
  std::vector<ModeVerdict> modes;  ///< by all records
  double damping_power = 0.0;      ///< exponent of n, see ContinuationResult
  double damping_power_deviation = 0.0;
  std::vector<double> ratio_deviations;  ///< of every ζ_n, relative; empty unless each is free
  /// As that of ContinuationResult; "x_c 2": of the second record.
  NamedCovariance covariance;
  double law_width = 0.0;            ///< τ, where every frequency is free
  std::vector<RecordValues> values;  ///< of every stroke, then of every pluck
  double chi2 = 0.0;                 ///< reduced, of all records
  double chi2_deviation = 0.0;
  bool fits = false;                       ///< χ² < 1 + 3 sd
  PriorMisfit priors;                      ///< of all records' parameters to what was stated
  bool right = false;                      ///< neither χ² nor the priors contradict the fit
  std::size_t evaluations = 0;             ///< of all records together, the law's among them
  std::vector<FitStage> stages;            ///< likewise
  std::vector<ContinuationResult> single;  ///< every stroke by itself
};

/// Every stroke by itself (calibrate_by_continuation), then all at σ = 0 in one likelihood, started
/// from the one χ² contradicts least: frequencies or law shared, the end state of each record its
/// own, and what `per_record` names of x_c, damping and sensors; the rest of these is shared. Modes
/// that no stroke identifies start where the plucks ring. Records are independent, so their
/// informations add. Stated noise levels of `options` hold for all strokes. Throws InvalidInput for
/// no stroke. What `poll` throws comes out within one evaluation.
RecordsFit calibrate_records(const ModelPoint& initial, std::span<const CalibrationData> strokes,
                             const ContinuationOptions& options,
                             std::span<const PluckRecord> plucks = {}, const FitPoll& poll = {});

/// Throws InvalidInput for a prior or a fixed value of a contact that no stroke has.
void require_contacts(const UnknownsOptions& options, std::size_t strokes);

/// The fit in the form of that of one record: model, law, modes, χ² and what is shared are those of
/// all records, contact and what is each record's own those of the first.
ContinuationResult as_continuation(const RecordsFit& fit);

}  // namespace modcal
