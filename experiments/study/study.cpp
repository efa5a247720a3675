#include "experiments/study/study.hpp"

#include <algorithm>

namespace modcal {
namespace {

constexpr std::size_t kSmallTable = 12;

// Whether a block answers the question where nothing says so. `answer`: those that do already.
bool is_answer(const report::Block& block, const std::vector<report::Block>& answer) {
  using Kind = report::Text::Kind;
  const auto has = [&answer]<typename Type>(const Type& /*of it*/) {
    return std::ranges::any_of(
        answer, [](const report::Block& one) { return std::holds_alternative<Type>(one); });
  };
  if (const auto* text = std::get_if<report::Text>(&block)) {
    return text->kind == Kind::kWarning || text->kind == Kind::kFailure;
  }
  if (const auto* figure = std::get_if<report::Figure>(&block)) return !has(*figure);
  const auto* table = std::get_if<report::Table>(&block);
  return table != nullptr && table->rows.size() <= kSmallTable && !has(*table);
}

}  // namespace

std::pair<std::vector<report::Block>, std::vector<report::Block>> StudyResult::take_parts() {
  std::pair<std::vector<report::Block>, std::vector<report::Block>> parts;
  std::size_t texts = 0;
  while (texts < blocks.size() && std::holds_alternative<report::Text>(blocks[texts])) ++texts;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const bool is_first =
        first_screen > 0 ? i < first_screen : i < texts || is_answer(blocks[i], parts.first);
    (is_first ? parts.first : parts.second).push_back(std::move(blocks[i]));
  }
  blocks.clear();
  return parts;
}

void StudyResult::move_to(report::Report& report, std::string title, std::string details) {
  auto [first, further] = take_parts();
  report.sections.push_back({.title = std::move(title), .blocks = std::move(first)});
  if (further.empty()) return;
  report.sections.push_back(
      {.title = std::move(details), .blocks = std::move(further), .folded = true});
}

}  // namespace modcal
