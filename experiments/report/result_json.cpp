#include "experiments/report/result_json.hpp"

#include <cmath>
#include <limits>

namespace modcal::report {

Json number_json(double value, NonFinite non_finite) {
  if (std::isfinite(value)) return value;
  if (non_finite == NonFinite::kNull) return nullptr;
  return std::isnan(value) ? "nan" : value > 0.0 ? "inf" : "-inf";
}

void JsonWriter::put(const ResultField& field, Json value) {
  if (field.shown == kInTables) return;
  (field.key.empty() ? *here_ : (*here_)[std::string(field.key)]) = std::move(value);
}

void JsonWriter::number(const ResultField& field, double& value) {
  put(field, number_json(value, non_finite_));
}

void JsonWriter::text(const ResultField& field, std::string& value) {
  if (!field.optional || !value.empty()) put(field, value);
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

void JsonReader::number(const ResultField& field, double& value) {
  const Json* const found = find(field);
  if (found == nullptr) return;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (*found == "nan") {
    value = std::numeric_limits<double>::quiet_NaN();
  } else if (*found == "inf" || *found == "-inf") {
    value = *found == "inf" ? kInfinity : -kInfinity;
  } else {
    found->get_to(value);
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

}  // namespace modcal::report
