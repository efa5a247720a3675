#include "experiments/report/typeset.hpp"

#include <array>
#include <regex>

#include "experiments/report/encoding.hpp"

namespace modcal::report {
namespace {

std::string superscript(std::string_view digits) {
  static constexpr std::array<std::string_view, 10> kDigits = {"⁰", "¹", "²", "³", "⁴",
                                                               "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text;
  for (const char digit : digits) text += kDigits.at(static_cast<std::size_t>(digit - '0'));
  return text;
}

}  // namespace

std::string typeset_powers(std::string_view text) {
  // "1e-3" of a file's name or of an option is not within a word.
  static const std::regex power(
      R"((^|[^A-Za-z0-9_.])([0-9]+(?:\.[0-9]+)?)e([+-])0*([0-9]+)(?![A-Za-z0-9_]))");
  constexpr auto kNone = std::string_view::npos;
  if (text.find("e-") == kNone && text.find("e+") == kNone) return std::string(text);
  const std::string plain(text);
  std::string result;
  auto rest = plain.begin();
  for (std::sregex_iterator at(plain.begin(), plain.end(), power), end; at != end; ++at) {
    const std::smatch& found = *at;
    result.append(rest, found[0].first);
    result += found[1].str() == "-" ? "−" : found[1].str();
    // "1.00e-03" states its digits, "1e-3" is the power alone.
    if (found[2].str() != "1") result += found[2].str() + "×";
    result += "10";
    if (found[3].str() == "-") result += "⁻";
    result += superscript(found[4].str());
    rest = found[0].second;
  }
  return result.append(rest, plain.end());
}

std::string typeset_html(std::string_view text) {
  static const std::regex symbol(
      R"((^|[^A-Za-z0-9/.])([A-Za-z]|φ|ζ|σ|ε|ω)_([A-Za-z0-9]{1,2})(?![A-Za-z0-9_]))");
  static const std::regex numbered(
      R"((^|[^A-Za-z0-9/._])(f(?=0)|[RH](?=[12]))([012])(?![A-Za-z0-9_]))");
  std::string plain = html_escaped(typeset_powers(text));
  static const std::array<std::pair<std::regex, const char*>, 3> words = {
      {{std::regex(R"((^|[^A-Za-z0-9_/.])zeta_(?=[0-9n]))"), "$1ζ_"},
       {std::regex(R"((^|[^A-Za-z0-9_/.])chi2(?![A-Za-z0-9_]))"), "$1χ²"},
       {std::regex(R"( \+- )"), " ± "}}};
  for (const auto& [word, sign] : words) plain = std::regex_replace(plain, word, sign);
  if (plain.find_first_of("012") != std::string::npos) {
    plain = std::regex_replace(plain, numbered, "$1$2<sub>$3</sub>");
  }
  if (plain.find('_') == std::string::npos) return plain;
  return std::regex_replace(plain, symbol, "$1$2<sub>$3</sub>");
}

}  // namespace modcal::report
