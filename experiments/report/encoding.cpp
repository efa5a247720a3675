#include "experiments/report/encoding.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>

#include "experiments/report/typeset.hpp"
#include "libsim/base/error.hpp"
#include "libsim/records/signal_file.hpp"

namespace modcal::report {
namespace {

// What a spreadsheet would compute, or start a program for; "-3 dB" and "-" are texts.
bool is_formula(std::string_view text) {
  if (text.empty()) return false;
  if (std::string_view("=@\t\r").find(text[0]) != std::string_view::npos) return true;
  if ((text[0] != '+' && text[0] != '-') || text.size() == 1) return false;
  const bool number = text[1] == '.' || (text[1] >= '0' && text[1] <= '9');
  return !number || text.find_first_of("=|!(") != std::string_view::npos;
}

}  // namespace

std::string quoted(std::string_view text, char mark, std::string_view inside) {
  std::string result(1, mark);
  for (const char c : text) c == mark ? result += inside : result += c;
  return result + mark;
}

std::string csv_field(std::string_view text) {
  std::string field = is_formula(text) ? fmt::format("'{}", text) : std::string(text);
  // NumPy knows no quotes, and pandas takes what follows a # for a comment wherever it stands.
  constexpr std::string_view kRead = ",\"\r\n#", kWritten = ";'  .";
  for (char& c : field) {
    const std::size_t place = kRead.find(c);
    if (place != std::string_view::npos) c = kWritten[place];
  }
  return field;
}

std::string csv_field(double value) { return std::isnan(value) ? "nan" : fmt::format("{}", value); }

std::string csv_text(const std::vector<std::string>& headings, std::size_t rows,
                     const std::function<std::string(std::size_t, std::size_t)>& field) {
  std::string text;
  const auto add_line = [&](const auto& cell) {
    for (std::size_t j = 0; j < headings.size(); ++j) {
      if (j > 0) text += ',';
      text += cell(j);
    }
    text += '\n';
  };
  add_line([&](std::size_t j) { return csv_field(headings[j]); });
  for (std::size_t i = 0; i < rows; ++i) {
    add_line([&](std::size_t j) { return field(i, j); });
  }
  return text;
}

std::string html_escaped(std::string_view text) {
  static constexpr std::pair<char, std::string_view> kEscapes[] = {
      {'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&#39;"}};
  std::string escaped;
  escaped.reserve(text.size());
  for (const char c : text) {
    const auto* const found = std::find_if(std::begin(kEscapes), std::end(kEscapes),
                                           [c](const auto& escape) { return escape.first == c; });
    found == std::end(kEscapes) ? escaped += c : escaped += found->second;
  }
  return escaped;
}

std::string html_paragraphs(std::string_view text) {
  std::string html;
  while (!text.empty()) {
    const std::size_t end = text.find("\n\n");
    const std::string_view paragraph = text.substr(0, end);
    if (paragraph.find_first_not_of(" \t\n") != std::string_view::npos) {
      html += "<p>" + typeset_html(paragraph) + "</p>\n";
    }
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 2);
  }
  return html;
}

std::string base64(std::span<const unsigned char> bytes) {
  static constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    unsigned group = 0;
    for (std::size_t j = 0; j < 3; ++j) group = group << 8 | (j < count ? bytes[i + j] : 0u);
    for (std::size_t j = 0; j < 4; ++j) {
      text += j <= count ? kDigits[group >> (18 - 6 * j) & 63u] : '=';
    }
  }
  return text;
}

void write_file_atomically(const std::filesystem::path& file, std::string_view content) {
  replace_file(file, [&](const std::filesystem::path& temporary) {
    errno = 0;
    std::ofstream stream(temporary, std::ios::binary);
    stream.write(content.data(), static_cast<std::streamsize>(content.size()));
    stream.close();
    MODCAL_REQUIRE(stream.good(), "{} cannot be written: {}", file.string(), std::strerror(errno));
  });
}

}  // namespace modcal::report
