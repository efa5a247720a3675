// The blocks of a report as HTML.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "experiments/report/drawing.hpp"
#include "experiments/report/html_page.hpp"
#include "experiments/report/report.hpp"

namespace modcal::report {

/// The command that makes a block again; nothing where there is none.
std::string command_html(const std::string& command);

/// A box of the given kind ("note", "warning", "failure") with its name in front.
std::string box_html(std::string_view kind, std::string_view name, const std::string& text);

/// Writes blocks in reading order; figures are taken from the list of drawn ones.
class BlockWriter {
 public:
  BlockWriter(std::span<const DrawnFigure> figures, const PageLinks& links)
      : figures_(figures), links_(links) {}

  std::string operator()(const Text& text) const;
  std::string operator()(const Figure& figure);
  std::string operator()(const Table& table) const;
  std::string operator()(const Audio& audio) const;

 private:
  std::span<const DrawnFigure> figures_;
  const PageLinks& links_;
  std::size_t next_ = 0;
};

}  // namespace modcal::report
