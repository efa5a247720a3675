// What stands beside an array in its file and tells of it: units, scales, and where to look.
#pragma once

#include <optional>

#include "libsim/records/arrays/array_file.hpp"

namespace modcal {

using Content = std::shared_ptr<ArrayFile>;

/// The last of its names in small letters.
std::string last_of(const NamedArray& array);
bool is_one_of(std::string_view name, std::initializer_list<std::string_view> names);

/// Whether it is called so and has no unit of its own but one of time.
bool is_time(const Content& content, const NamedArray& array);

/// Numbers, more than one, that are neither instants nor tell of another array.
bool may_be_channel(const Content& content, const NamedArray& array);

/// Whether both stand in one structure.
bool are_beside(const NamedArray& a, const NamedArray& b);

/// How many names lead to the structure that `of` stands in, where the other is all of it or stands
/// in it, too; the axis of a signal often stands in a structure x_values beside it.
std::optional<std::size_t> scope(const NamedArray& array, const NamedArray& of);

/// The one that tells of an array, from the nearest structure; null: none.
template <typename Tells>
const NamedArray* nearest(const std::vector<NamedArray>& arrays, const NamedArray& array,
                          Tells tells) {
  const NamedArray* best = nullptr;
  for (const NamedArray& other : arrays) {
    if (!scope(array, other) || !tells(other)) continue;
    if (best == nullptr || *scope(array, other) > *scope(array, *best)) best = &other;
  }
  return best;
}

/// The unit of the j-th column: a text `unit` right below the array, one called "dt_unit" beside
/// dt, or one that is a unit, not of time, in a structure in which the array is the only one that
/// may be a channel; of several such texts one a column.
std::string unit_of(const Content& content, const NamedArray& array, std::size_t j = 0);

/// What one unit of the array is in SI; NaN where it is of another dimension.
double unit_in(const Content& content, const NamedArray& array, std::string_view si);

/// Texts of units that belong to no array, a sentence each: nobody shall believe that they were
/// read.
std::vector<std::string> units_of_nobody(const Content& content);

/// What stored numbers are to be multiplied by and added to: scale_factor and add_offset, as netCDF
/// has them, for all columns or one for each: below the array, called after it, or beside it where
/// it holds whole numbers or is called `data`. Beside other numbers they may tell of something
/// else.
struct Packing {
  double factor = 1.0, offset = 0.0;
  std::string fault = {};  ///< why what is stated cannot be applied; empty: it can
  std::vector<const NamedArray*> unapplied = {};  ///< what stands beside other numbers

  bool is_plain() const { return factor == 1.0 && offset == 0.0; }
  double unpacked(double stored) const { return factor * stored + offset; }
};
Packing packing_of(const Content& content, const NamedArray& array, std::size_t j);

/// What is not applied, a sentence each.
std::vector<std::string> unapplied_packing(const Content& content);

}  // namespace modcal
