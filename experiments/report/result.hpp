// Results as JSON, both ways.
#pragma once

#include <nlohmann/json.hpp>

#include "experiments/report/table.hpp"
#include "libsim/base/result_visitor.hpp"

namespace modcal::report {

using Json = nlohmann::ordered_json;

/// What becomes of a number that JSON has no word for: null, or "nan", "inf" and "-inf", which a
/// JsonReader takes back.
enum class NonFinite { kNull, kWord };

Json number_json(double value, NonFinite non_finite = NonFinite::kNull);

/// An object with one member a value that is visited.
class JsonWriter final : public ResultVisitor {
 public:
  explicit JsonWriter(NonFinite non_finite) : non_finite_(non_finite) {}
  Json take() { return std::move(document_); }

  void value(const ResultField& field, Value held) override;
  bool is_known(const ResultField& field, bool known) override;
  void group(const ResultField& field, const VisitMembers& visit_members) override;
  void list(const ResultField& field, std::size_t size, const Resize& resize,
            const VisitItem& visit_item) override;

 private:
  void put(const ResultField& field, Json value);

  NonFinite non_finite_;
  Json document_;
  Json* here_ = &document_;
};

/// Sets the values that are visited to those of an object. Throws nlohmann::json::exception where
/// one is missing or of another type.
class JsonReader final : public ResultVisitor {
 public:
  explicit JsonReader(const Json& document) : here_(&document) {}

  void value(const ResultField& field, Value held) override;
  bool is_known(const ResultField& field, bool known) override;
  void group(const ResultField& field, const VisitMembers& visit_members) override;
  void list(const ResultField& field, std::size_t size, const Resize& resize,
            const VisitItem& visit_item) override;

 private:
  /// Null where an optional value is missing.
  const Json* find(const ResultField& field) const;

  const Json* here_;
};

/// Anything with visit().
template <typename Result>
Json json_of(const Result& result, NonFinite non_finite = NonFinite::kNull) {
  JsonWriter writer(non_finite);
  if constexpr (requires { result.visit(writer); }) {
    result.visit(writer);
  } else {
    Result(result).visit(writer);
  }
  return writer.take();
}

/// Content of a file: indented, ended by a newline; text that is not UTF-8 is mended.
std::string json_file(const Json& document);

/// JSON on one line from which read_line() gives back every bit.
template <typename Result>
std::string json_line(const Result& result) {
  return json_of(result, NonFinite::kWord).dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// Throws InvalidInput for a text that json_line() of such a result did not write; `what` names it.
template <typename Result>
Result read_line(const std::string& text, std::string_view what) {
  try {
    const Json document = Json::parse(text);
    JsonReader reader(document);
    Result result;
    result.visit(reader);
    return result;
  } catch (const nlohmann::json::exception& error) {
    throw_invalid_input("{} cannot be read: {}", what, error.what());
  }
}

// Results as tables, from which page, CSV and JSON rows are written.

/// Column and cell of every value that is visited; members of groups stand beside the others, lists
/// are left out.
class RowWriter final : public ResultVisitor {
 public:
  std::vector<Column> columns = {};
  std::vector<Cell> cells = {};

  void cell(const ResultField& field, Cell cell);
  void value(const ResultField& field, Value held) override {
    std::visit([&](const auto* one) { cell(field, *one); }, held);
  }
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
