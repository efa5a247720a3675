// Blocks of a report as HTML.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "experiments/report/html_page.hpp"

namespace modcal::report {

/// Writes blocks in reading order; figures are taken from the list of drawn ones.
class BlockWriter {
 public:
  BlockWriter(std::span<const DrawnFigure> figures, const PageLinks& links)
      : figures_(figures), links_(links) {}

  /// Narrow figures that follow each other stand two a row; the long tables of what is not the
  /// answer are folded.
  std::string section(const Section& section, bool is_answer);

  std::string operator()(const Text& text) const;
  std::string operator()(const Figure& figure);
  std::string operator()(const Table& table) const;
  std::string operator()(const Audio& audio) const;

 private:
  std::span<const DrawnFigure> figures_;
  const PageLinks& links_;
  std::size_t next_ = 0;
  bool is_answer_ = true;
};

/// The command that makes it again, folded; empty without one.
std::string command_html(const std::string& command);
/// Text in a box with a name at its head.
std::string box_html(std::string_view kind, std::string_view name, const std::string& text);

}  // namespace modcal::report
