#include "experiments/report/result_table.hpp"

namespace modcal::report {
namespace {

class TablesWriter final : public ResultVisitor {
 public:
  std::vector<Table> tables = {};

  void number(const ResultField& /*field*/, double& /*value*/) override {}
  void integer(const ResultField& /*field*/, std::int64_t& /*value*/) override {}
  void flag(const ResultField& /*field*/, bool& /*value*/) override {}
  void text(const ResultField& /*field*/, std::string& /*value*/) override {}
  bool is_known(const ResultField& /*field*/, bool known) override { return known; }
  void group(const ResultField& field, const VisitMembers& visit_members) override {
    if (field.shown == kInJson) return;
    if (field.table.empty()) return visit_members(*this);
    add_row(begin(field), visit_members);
  }
  void list(const ResultField& field, std::size_t size, const Resize& /*resize*/,
            const VisitItem& visit_item) override {
    if (field.shown == kInJson || field.table.empty() || size == 0) return;
    Table& table = begin(field);
    for (std::size_t i = 0; i < size; ++i) {
      add_row(table, [&](RowWriter& row) { visit_item(row, i); });
    }
  }

 private:
  Table& begin(const ResultField& field) {
    return tables.emplace_back(Table{.id = std::string(field.table),
                                     .title = std::string(field.name),
                                     .caption = std::string(field.meaning)});
  }
};

}  // namespace

void RowWriter::cell(const ResultField& field, Cell cell) {
  if (field.shown == kInJson) return;
  columns.push_back({.key = std::string(field.key),
                     .name = std::string(field.name),
                     .unit = std::string(field.unit),
                     .format = std::string(field.format)});
  cells.push_back(std::move(cell));
}

bool RowWriter::is_known(const ResultField& field, bool known) {
  if (!known) cell(field, Cell());
  return known;
}

void RowWriter::group(const ResultField& field, const VisitMembers& visit_members) {
  if (field.shown != kInJson) visit_members(*this);
}

std::vector<Table> tables_of(const ResultVisitor::VisitMembers& visit) {
  TablesWriter writer;
  visit(writer);
  return std::move(writer.tables);
}

}  // namespace modcal::report
