#include "experiments/report/result.hpp"

#include <limits>

namespace modcal::report {
namespace {

class TablesWriter final : public ResultVisitor {
 public:
  std::vector<Table> tables = {};

  void value(const ResultField& /*field*/, Value /*held*/) override {}
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

Json number_json(double value, NonFinite non_finite) {
  if (std::isfinite(value)) return value;
  if (non_finite == NonFinite::kNull) return nullptr;
  return std::isnan(value) ? "nan" : value > 0.0 ? "inf" : "-inf";
}

void JsonWriter::put(const ResultField& field, Json value) {
  if (field.shown == kInTables) return;
  (field.key.empty() ? *here_ : (*here_)[std::string(field.key)]) = std::move(value);
}

void JsonWriter::value(const ResultField& field, Value held) {
  if (const auto* number = std::get_if<double*>(&held)) {
    return put(field, number_json(**number, non_finite_));
  }
  const auto* text = std::get_if<std::string*>(&held);
  if (text && field.optional && (*text)->empty()) return;
  std::visit([&](const auto* one) { put(field, *one); }, held);
}

bool JsonWriter::is_known(const ResultField& field, bool known) {
  if (!known && !field.optional) put(field, nullptr);
  return known;
}

void JsonWriter::group(const ResultField& field, const VisitMembers& visit_members) {
  if (field.shown == kInTables) return;
  if (field.key.empty()) return visit_members(*this);
  Json* const outside = here_;
  here_ = &(*outside)[std::string(field.key)];
  *here_ = Json::object();
  visit_members(*this);
  here_ = outside;
}

void JsonWriter::list(const ResultField& field, std::size_t size, const Resize& /*resize*/,
                      const VisitItem& visit_item) {
  if (field.shown == kInTables || (field.optional && size == 0)) return;
  Json items = Json::array();
  Json* const outside = here_;
  for (std::size_t i = 0; i < size; ++i) {
    here_ = &items.emplace_back();
    visit_item(*this, i);
  }
  here_ = outside;
  put(field, std::move(items));
}

const Json* JsonReader::find(const ResultField& field) const {
  if (field.shown == kInTables) return nullptr;
  if (field.key.empty()) return here_;
  const auto found = here_->find(field.key);
  if (found != here_->end()) return &*found;
  return field.optional ? nullptr : &here_->at(std::string(field.key));  // throws
}

void JsonReader::value(const ResultField& field, Value held) {
  const Json* const found = find(field);
  if (found == nullptr) return;
  const auto* number = std::get_if<double*>(&held);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (number && *found == "nan") {
    **number = std::numeric_limits<double>::quiet_NaN();
  } else if (number && (*found == "inf" || *found == "-inf")) {
    **number = *found == "inf" ? kInfinity : -kInfinity;
  } else if (auto* const* whole = std::get_if<std::int64_t*>(&held)) {
    // A fraction, or a number beyond 63 bits, is no count: this throws.
    if (found->is_number_unsigned() && found->get<std::uint64_t>() >> 63 != 0) {
      throw Json::type_error::create(302, "a count is beyond 63 bits", found);
    }
    **whole = found->get_ref<const std::int64_t&>();
  } else {
    std::visit([found](auto* one) { found->get_to(*one); }, held);
  }
}

bool JsonReader::is_known(const ResultField& field, bool /*known*/) {
  const Json* const found = find(field);
  return found != nullptr && !found->is_null();
}

void JsonReader::group(const ResultField& field, const VisitMembers& visit_members) {
  const Json* const outside = here_;
  here_ = find(field);
  if (here_ != nullptr) visit_members(*this);
  here_ = outside;
}

void JsonReader::list(const ResultField& field, std::size_t size, const Resize& resize,
                      const VisitItem& visit_item) {
  const Json* const found = find(field);
  if (found == nullptr) return;
  if (resize) {
    size = found->size();
    resize(size);
  }
  const Json* const outside = here_;
  for (std::size_t i = 0; i < size; ++i) {
    here_ = &found->at(i);
    visit_item(*this, i);
  }
  here_ = outside;
}

std::string json_file(const Json& document) {
  return document.dump(1, ' ', false, Json::error_handler_t::replace) + '\n';
}

void RowWriter::cell(const ResultField& field, Cell cell) {
  if (field.shown == kInJson) return;
  columns.push_back({.key = std::string(field.key),
                     .name = std::string(field.name),
                     .unit = std::string(field.unit),
                     .format = std::string(field.format),
                     .is_effort = field.is_effort});
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
