// Which relation between the reactions of one string a record obeys.
//
// Whatever the force at x_c is, the waves that it sends to both ends make
//     R₁ sin kx_c = R₂ sin k(L − x_c),    k = nπ/L,  n √(1 + B n²) = f/f₀
// (pinned string; losses and near fields of the bending, of order ζ and B, left out). It holds in
// every bin, near modes or between them, from the first sample or from mid-stroke, so that
// exchanged channels, a turned sign, copies and lost samples show without a calibration.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <span>

namespace modcal {

/// Both reactions as recorded, of one length.
struct EndRecord {
  std::span<const double> left, right;  ///< R₁, R₂ [N]
  double sample_rate = 0.0;             ///< [Hz]
  std::array<double, 2> noise{};        ///< standard deviation of white noise [N]
};

/// The string as it is stated; f₀ may be off by 3 %, x_c by 2 % of L.
struct StatedString {
  double length = 0.0;         ///< L [m]
  double fundamental = 0.0;    ///< f₀ [Hz]
  double inharmonicity = 0.0;  ///< B
  double contact = 0.0;        ///< x_c [m]
};

enum class EndRelation { kString, kSignTurned, kSwapped, kSwappedSignTurned, kCopies };

/// Where in the record the relation of a string fails, although it holds elsewhere.
struct EndDisturbance {
  double time = 0.0;   ///< centre of a period, after the first sample [s]
  double ratio = 0.0;  ///< power left there over what is left elsewhere of as much
};

struct EndRelationFit {
  /// Mean of ln(1 + |e|²/v) over bins between f₀/2 and 10 f₀ that stand above the noise, e what the
  /// relation leaves, v its noise and 5 % of the reactions: 0 explained, 6 not at all.
  std::array<double, 5> misfit{};
  double copy_gain = 0.0;    ///< g of R₂ = g R₁
  double fundamental = 0.0;  ///< f₀ of the string [Hz]
  double contact = 0.0;      ///< x_c of the string [m]
  /// Of that string by the closer grid, and of one with the f₀ stated.
  double least_misfit = 0.0, misfit_as_stated = 0.0;
  /// Whether the f₀ found serves better than that stated; in few periods many do as well.
  bool tells_fundamental() const;
  bool at_edge = false;      ///< f₀ is farther from the one stated than it may be
  double unexplained = 0.0;  ///< share of the reactions' power below 10 f₀ that the string leaves
  bool explained() const;    ///< it is that of one string
  bool explained_at_edge() const;  ///< it would be but for an f₀ at the edge of what is looked for
  /// Largest power of a bin below 10 f₀ over that of the noise, of either reaction.
  std::array<double, 2> peak_over_noise{};
  /// Whether no bin of that end stands above the noise by more than noise itself does.
  bool noise_alone(std::size_t end) const;
  std::optional<EndDisturbance> disturbance;

  double misfit_of(EndRelation relation) const {
    return misfit[static_cast<std::size_t>(relation)];
  }
  /// The relation that leaves less than half of what the string as stated leaves, and least.
  EndRelation best() const;
};

/// Throws InvalidInput for reactions of different lengths, records shorter than two periods of f₀,
/// a contact outside the string.
EndRelationFit fit_end_relations(const EndRecord& record, const StatedString& string);

/// How many times R₂ would have to read more for both to be those of the string, which they are not
/// as they are; none: no gain of a sensor explains them. Throws as fit_end_relations() does.
std::optional<double> gain_of_right(const EndRecord& record, const StatedString& string);

/// What a record tells of a string of which nothing is known.
struct ToldString {
  double fundamental = 0.0;    ///< f₀ [Hz]
  double inharmonicity = 0.0;  ///< B
  double contact = 0.0;        ///< x_c/L, from the end of the left reaction [1]
  double misfit = std::numeric_limits<double>::infinity();  ///< as EndRelationFit's, up to 40 f₀
  bool explained = false;  ///< the reactions are those of this string
  bool near_pitch = true;  ///< f₀ is the pitch, and not above or below it
  /// x_c/L of the string that serves nearly as well with the contact elsewhere, as of what rings by
  /// itself any does; none: the record tells its contact.
  std::optional<double> rival = {};
};

/// f₀, B ≥ 0 and x_c of the string that the ends obey best up to 40 f₀, looked for below 5 f₀ with
/// x_c anywhere and f₀ near the pitch, the first lag at which both reactions are alike, or, where
/// no such string explains them, up to eight times as high. Where the record does not tell its
/// contact, the string is that of x_c/L as stated, and the best elsewhere its rival. Throws
/// InvalidInput for a record without a period.
ToldString find_string(const EndRecord& record, std::optional<double> contact = {});

}  // namespace modcal
