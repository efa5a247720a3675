#include "libsim/records/arrays/array_axis.hpp"

#include <cmath>

#include "libsim/records/csv_grammar.hpp"
#include "libsim/records/tuning.hpp"

namespace modcal {
namespace {

// One value, or a text of it.
bool may_be_number(const NamedArray& array) {
  return array.size() == 1 ? array.is_real() || array.holds == NamedArray::Holds::kText
                           : array.holds == NamedArray::Holds::kText;
}

bool is_rate(const NamedArray& array) {
  return may_be_number(array) && is_name_of_rate(last_of(array));
}
bool is_period(const NamedArray& array) {
  return may_be_number(array) && is_one_of(last_of(array), {"dt", "ts", "increment", "wf_increment",
                                                            "sample_period", "delta_t"});
}
// x is time where a step of time stands beside it; alone it is a place as well.
bool is_start(const Content& content, const NamedArray& array) {
  if (array.size() != 1 || !array.is_real()) return false;
  const std::string name = last_of(array);
  if (is_one_of(name, {"t0", "start_time", "wf_start_offset", "t_start"})) return true;
  return is_one_of(name, {"x0", "start_value"}) &&
         std::ranges::any_of(content->arrays(), [&array](const NamedArray& other) {
           return is_period(other) && are_beside(other, array);
         });
}
bool is_line_step(const NamedArray& array) {
  return array.size() == 1 && array.is_real() &&
         is_one_of(last_of(array), {"df", "delta_f", "frequency_step", "frequency_resolution"});
}

bool is_vector_beside(const NamedArray& other, const NamedArray& array) {
  return other.is_real() && !other.is_note && other.is_table() && other.columns() == 1 &&
         other.rows() == array.rows();
}

bool are_instants_of(const Content& content, const NamedArray& other, const NamedArray& array) {
  return is_vector_beside(other, array) && is_time(content, other);
}

// Those called t rather than those called T, which may be anything else.
const NamedArray* instants_beside(const Content& content, const NamedArray& array) {
  const auto are_instants = [&](const NamedArray& other) {
    return are_instants_of(content, other, array);
  };
  const NamedArray* const any = nearest(content->arrays(), array, are_instants);
  const NamedArray* const small =
      nearest(content->arrays(), array, [&are_instants](const NamedArray& other) {
        return other.path.back()[0] == 't' && are_instants(other);
      });
  return small != nullptr && scope(array, *small) == scope(array, *any) ? small : any;
}

// A text that is no number tells nothing.
bool tells_rate(const Content& content, const NamedArray& array) {
  return (is_rate(array) || is_period(array)) &&
         (array.is_real() || std::isfinite(content->number(array)));
}

double rate_told_by(const Content& content, const NamedArray& told) {
  const double value = content->number(told);
  if (is_rate(told)) return value * unit_in(content, told, "Hz");
  return rate_of_period(value * unit_in(content, told, "s"),
                        std::numeric_limits<double>::epsilon());
}

std::vector<double> instants_of(const Content& content, const NamedArray& time) {
  const double second = unit_in(content, time, "s");
  const Packing packing = packing_of(content, time, 0);
  std::vector<double> times = content->column(time, 0);
  for (double& instant : times) instant = packing.unpacked(instant) * second;
  return times;
}

}  // namespace

void ArrayAxes::set_times(const NamedArray& time, StoredChannel& channel) const {
  channel.rate_source = channel.times_name = time.text();
  channel.read_times = [content = content_, time] { return instants_of(content, time); };
  channel.time_resolution = time.is_single
                                ? static_cast<double>(std::numeric_limits<float>::epsilon())
                                : std::numeric_limits<double>::epsilon();
}

// What two vectors of instants in one structure say of it; empty: the same.
const std::string& ArrayAxes::contradiction(const NamedArray& time, const NamedArray& array) {
  const auto [known, is_new] = contradictions_.try_emplace(time.place);
  if (!is_new || headers_only_) return known->second;
  for (const NamedArray& other : content_->arrays()) {
    if (other.place == time.place || !are_instants_of(content_, other, array) ||
        scope(array, other) != scope(array, time)) {
      continue;
    }
    const std::vector<double> mine = instants_of(content_, time);
    const std::vector<double> others = instants_of(content_, other);
    const double same =
        kSameInstant * std::abs(mine.back() - mine.front()) / static_cast<double>(mine.size() - 1);
    const auto [at, there] = std::ranges::mismatch(
        mine, others, [same](double a, double b) { return std::abs(a - b) <= same; });
    if (at == mine.end()) continue;
    known->second = fmt::format("sample {} is at {:.9g} s by {} and at {:.9g} s by {}",
                                at - mine.begin(), *at, time.text(), *there, other.text());
  }
  return known->second;
}

// Where what tells the rate stands nearer, a number farther out tells of another thing.
void ArrayAxes::set_start(const NamedArray& array, std::size_t least_scope,
                          StoredChannel& channel) const {
  const NamedArray* const start =
      nearest(content_->arrays(), array,
              [this](const NamedArray& other) { return is_start(content_, other); });
  if (start == nullptr || *scope(array, *start) < least_scope) return;
  channel.start = content_->number(*start) * unit_in(content_, *start, "s");
}

void ArrayAxes::set_stated(const NamedArray& array, const NamedArray& told,
                           StoredChannel& channel) const {
  channel.sample_rate = rate_told_by(content_, told);
  channel.rate_source = fmt::format("{} = {:.9g}", told.text(), content_->number(told));
  channel.is_rate_stated = true;
  for (const NamedArray& other : content_->arrays()) {
    if (scope(array, other) != scope(array, told) || !tells_rate(content_, other)) continue;
    const double rate = rate_told_by(content_, other);
    if (!(std::abs(rate / channel.sample_rate - 1.0) > kSameRate)) continue;
    channel.contradiction =
        fmt::format("{} says {:.9g} Hz, {} = {:.9g} says {:.9g} Hz", channel.rate_source,
                    channel.sample_rate, other.text(), content_->number(other), rate);
  }
}

void ArrayAxes::set(const NamedArray& array, StoredChannel& channel) {
  const std::vector<NamedArray>& arrays = content_->arrays();
  const NamedArray* const told = nearest(
      arrays, array, [this](const NamedArray& other) { return tells_rate(content_, other); });
  const NamedArray* const time = instants_beside(content_, array);
  if (time != nullptr) {
    set_times(*time, channel);
    channel.contradiction = contradiction(*time, array);
  }
  const bool is_time_nearer =
      time != nullptr && told != nullptr && *scope(array, *time) > *scope(array, *told);
  if (told != nullptr && !is_time_nearer) set_stated(array, *told, channel);
  if (!channel.read_times) set_start(array, told == nullptr ? 0 : *scope(array, *told), channel);
}

const NamedArray* lines_of(const Content& content, const NamedArray& array) {
  const std::vector<NamedArray>& arrays = content->arrays();
  const NamedArray* const lines = nearest(arrays, array, [&array](const NamedArray& other) {
    return is_name_of_lines(other.path.back()) && is_vector_beside(other, array);
  });
  return lines != nullptr ? lines : nearest(arrays, array, is_line_step);
}

}  // namespace modcal
