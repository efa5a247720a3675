#include "libsim/records/arrays/written_arrays.hpp"

#include "libsim/records/arrays/array_file.hpp"
#include "libsim/records/signal_file.hpp"

namespace modcal {

bool WrittenArrays::is_for_axis(const std::string& name) const {
  return name == axis || (has_start() && name == kStart) ||
         (has_lines() ? is_name_of_lines(name) : is_name_of_time(name));
}

WrittenArrays written_arrays(std::span<const Signal> signals, const RecordNotes& notes,
                             const std::string& file) {
  require_one_record(signals, file);
  WrittenArrays result{.axis = "sample_rate",
                       .axis_values = {&signals.front().sample_rate, 1},
                       .arrays = {},
                       .provenance = notes.provenance,
                       .start = notes.start,
                       .kept = {}};
  for (const Signal& signal : signals) {
    result.arrays.push_back(
        {.name = signal.quantity, .unit = signal.unit, .numbers = signal.samples});
  }
  return result;
}

WrittenArrays written_arrays(std::span<const FileFunction> functions, const std::string& provenance,
                             const std::string& file) {
  require_functions(functions, file);
  WrittenArrays result{.axis = "f",
                       .axis_values = functions.front().hertz,
                       .arrays = {},
                       .provenance = provenance,
                       .kept = {}};
  for (const FileFunction& function : functions) {
    WrittenArray& array = result.arrays.emplace_back();
    array.name = function.name;
    array.unit = function.whole_unit();
    array.is_complex = !function.is_real();
    // A complex number is its two parts, one after the other, as std::complex guarantees.
    array.numbers = {reinterpret_cast<const double*>(function.values.data()),
                     2 * function.values.size()};
    if (array.is_complex) continue;
    std::vector<double>& real = result.kept.emplace_back();
    for (const Complex& value : function.values) real.push_back(value.real());
    array.numbers = real;
  }
  return result;
}

}  // namespace modcal
