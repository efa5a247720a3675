// Results as tables, from which page, CSV and JSON rows are written.
#pragma once

#include <string>
#include <vector>

#include "experiments/report/table.hpp"
#include "libsim/base/result_visitor.hpp"

namespace modcal::report {

/// Column and cell of every value that is visited; members of groups stand beside the others, lists
/// are left out.
class RowWriter final : public ResultVisitor {
 public:
  std::vector<Column> columns = {};
  std::vector<Cell> cells = {};

  void cell(const ResultField& field, Cell cell);
  void number(const ResultField& field, double& value) override { cell(field, value); }
  void integer(const ResultField& field, std::int64_t& value) override { cell(field, value); }
  void flag(const ResultField& field, bool& value) override { cell(field, value); }
  void text(const ResultField& field, std::string& value) override { cell(field, value); }
  bool is_known(const ResultField& field, bool known) override;
  void group(const ResultField& field, const VisitMembers& visit_members) override;
  void list(const ResultField& /*field*/, std::size_t /*size*/, const Resize& /*resize*/,
            const VisitItem& /*visit_item*/) override {}
};

/// `head` with the columns and the row of one item more.
template <typename VisitRow>
void add_row(Table& head, VisitRow visit_row) {
  RowWriter row;
  visit_row(row);
  head.columns = std::move(row.columns);
  head.rows.push_back(std::move(row.cells));
}

/// `head` with one row an item, as visit_row(RowWriter&, item) describes it. Without items the
/// columns are those of an item by default.
template <typename Items, typename VisitRow>
Table table_of(Table head, const Items& items, VisitRow visit_row) {
  for (const auto& item : items) {
    add_row(head, [&](RowWriter& row) { visit_row(row, item); });
  }
  if (head.rows.empty()) {
    add_row(head, [&](RowWriter& row) { visit_row(row, typename Items::value_type{}); });
    head.rows.clear();
  }
  return head;
}

/// Tables of the lists and groups that name one, in the order of the visit.
std::vector<Table> tables_of(const ResultVisitor::VisitMembers& visit);

/// Those of anything with visit().
template <typename Result>
requires requires(const Result& result, ResultVisitor& visitor) { result.visit(visitor); }
std::vector<Table> tables_of(const Result& result) {
  return tables_of([&result](ResultVisitor& visitor) { result.visit(visitor); });
}

}  // namespace modcal::report
