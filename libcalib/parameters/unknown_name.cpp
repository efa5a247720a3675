#include "libcalib/parameters/unknown_name.hpp"

#include <charconv>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

struct Word {
  std::string_view text;
  UnknownKind kind;
  std::string_view unit;
  std::string_view meaning;
};

constexpr Word kWords[] = {
    {"f0", UnknownKind::kFundamental, "Hz", "fundamental of the string without its stiffness"},
    {"B", UnknownKind::kInharmonicity, "1", "inharmonicity: f_n = n f0 sqrt(1 + B n^2)"},
    {"x_c", UnknownKind::kContact, "m", "position of the bow"},
    {"damping", UnknownKind::kDampingFactor, "1",
     "factor c of the damping ratios: zeta_n = c n^p zeta_n(initial)"},
    {"damping_power", UnknownKind::kDampingPower, "1",
     "exponent p of the damping ratios: zeta_n = c n^p zeta_n(initial)"},
    {"gain", UnknownKind::kGain, "1", "gain of the sensor at x = L over that at x = 0"},
    {"delay", UnknownKind::kDelay, "s", "delay of the sensor at x = L after that at x = 0"},
    {"corner", UnknownKind::kCorner, "Hz", "corner of the high pass of the sensor at x = L"}};

// A number >= 1 that is all of the text; 0 for other text.
std::size_t number_of(std::string_view text) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc{} && end == text.data() + text.size() ? number : 0;
}

}  // namespace

std::optional<UnknownName> parse_unknown(std::string_view text) {
  UnknownName name;
  if (const std::size_t space = text.rfind(' '); space != std::string_view::npos) {
    const std::size_t record = number_of(text.substr(space + 1));
    if (record == 0) return std::nullopt;
    name.record = record - 1;
    text = text.substr(0, space);
  }
  for (const Word& word : kWords) {
    if (text != word.text) continue;
    name.kind = word.kind;
    return name;
  }
  const bool frequency = text.starts_with("f_");
  if (!frequency && !text.starts_with("zeta_")) return std::nullopt;
  const std::size_t mode = number_of(text.substr(frequency ? 2 : 5));
  if (mode == 0) return std::nullopt;
  name.kind = frequency ? UnknownKind::kFrequency : UnknownKind::kDampingRatio;
  name.mode = mode - 1;
  return name;
}

UnknownName require_unknown(std::string_view text, std::size_t modes) {
  const std::optional<UnknownName> name = parse_unknown(text);
  MODCAL_REQUIRE(name && name->mode < modes,
                 "unknown parameter \"{}\": state f0, B, x_c, f_1 ... f_{}, zeta_1 ... zeta_{}, "
                 "damping, damping_power, gain, delay or corner",
                 text, modes, modes);
  return *name;
}

std::string_view unit_of_unknown(std::string_view text) {
  const std::optional<UnknownName> name = parse_unknown(text);
  if (!name) return "1";
  if (name->kind == UnknownKind::kFrequency) return "Hz";
  for (const Word& word : kWords) {
    if (word.kind == name->kind) return word.unit;
  }
  return "1";
}

std::string_view meaning_of_unknown(std::string_view text) {
  const std::optional<UnknownName> name = parse_unknown(text);
  if (!name) return "";
  if (name->kind == UnknownKind::kFrequency) return "frequency of one mode";
  if (name->kind == UnknownKind::kDampingRatio) return "damping ratio of one mode";
  for (const Word& word : kWords) {
    if (word.kind == name->kind) return word.meaning;
  }
  return "";
}

bool is_positive(UnknownKind kind) {
  return kind == UnknownKind::kFundamental || kind == UnknownKind::kFrequency ||
         kind == UnknownKind::kDampingRatio || kind == UnknownKind::kDampingFactor ||
         kind == UnknownKind::kGain;
}

}  // namespace modcal
