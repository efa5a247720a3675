#include "libsim/records/matlab/matlab_content.hpp"

#include <fmt/ranges.h>
#include <hdf5.h>

#include <algorithm>

#include "libsim/base/error.hpp"
#include "libsim/base/files.hpp"
#include "libsim/base/utf8.hpp"
#include "libsim/base/words.hpp"
#include "libsim/records/hdf5/hdf5_content.hpp"
#include "libsim/records/hdf5/hdf5_file.hpp"
#include "libsim/records/hdf5/hdf5_matlab.hpp"
#include "libsim/records/matlab/matlab_file.hpp"
#include "libsim/records/matlab/matlab_layout.hpp"

namespace modcal {
namespace {

using Path = std::filesystem::path;
using Variable = std::unique_ptr<matvar_t, decltype(&Mat_VarFree)>;
using File = std::unique_ptr<mat_t, decltype(&Mat_Close)>;

Variable owned(matvar_t* variable) { return {variable, &Mat_VarFree}; }

File opened(const Path& path) {
  // What HDF5 says on the terminal is said by the refusal.
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  File file(Mat_Open(path.c_str(), MAT_ACC_RDONLY), &Mat_Close);
  MODCAL_REQUIRE(file != nullptr,
                 "{}: cannot be read as a MAT file; save it again (save -v7), or export it as CSV",
                 path.string());
  return file;
}

std::size_t size_of(const matvar_t& variable) {
  std::size_t size = 1;
  for (int i = 0; i < variable.rank; ++i) size *= variable.dims[i];
  return variable.rank > 0 ? size : 0;
}

template <typename Number>
double number_at(const void* numbers, std::size_t i) {
  return static_cast<double>(static_cast<const Number*>(numbers)[i]);
}

using NumberAt = double (*)(const void*, std::size_t);

bool holds_texts(const matvar_t& variable) {
  if (variable.class_type == MAT_C_CHAR) return true;
  if (variable.class_type != MAT_C_CELL || size_of(variable) == 0) return false;
  const auto* const cells = static_cast<matvar_t* const*>(variable.data);
  return cells != nullptr &&
         std::all_of(cells, cells + size_of(variable), [](const matvar_t* cell) {
           return cell != nullptr && cell->class_type == MAT_C_CHAR;
         });
}

// Each row of letters, which stand column by column, without the blanks that make it as long as the
// others; bytes, or units of UTF-16 as MATLAB writes them.
void append_texts(const matvar_t& variable, std::vector<std::string>& texts) {
  if (variable.rank != 2 || variable.data == nullptr || size_of(variable) == 0) return;
  const std::size_t rows = variable.dims[0], size = size_of(variable);
  const bool is_utf16 = variable.data_type == MAT_T_UINT16 || variable.data_type == MAT_T_UTF16;
  const bool is_bytes = variable.data_type == MAT_T_UINT8 || variable.data_type == MAT_T_INT8 ||
                        variable.data_type == MAT_T_UTF8;
  if (!is_utf16 && !is_bytes) return;
  for (std::size_t row = 0; row < rows; ++row) {
    std::string text;
    for (std::size_t i = row; i < size; i += rows) {
      if ((i + 1) * (is_utf16 ? 2 : 1) > variable.nbytes) break;
      if (is_bytes) {
        text += static_cast<const char*>(variable.data)[i];
      } else {
        append_utf8(static_cast<const std::uint16_t*>(variable.data)[i], text);
      }
    }
    texts.emplace_back(trimmed(utf8_or_latin1(text)));
  }
}

// How a number of a class is read; null: it has no numbers.
NumberAt number_of_class(matio_classes type) {
  static const std::map<matio_classes, NumberAt> kClasses = {
      {MAT_C_DOUBLE, number_at<double>},      {MAT_C_SINGLE, number_at<float>},
      {MAT_C_INT8, number_at<std::int8_t>},   {MAT_C_UINT8, number_at<std::uint8_t>},
      {MAT_C_INT16, number_at<std::int16_t>}, {MAT_C_UINT16, number_at<std::uint16_t>},
      {MAT_C_INT32, number_at<std::int32_t>}, {MAT_C_UINT32, number_at<std::uint32_t>},
      {MAT_C_INT64, number_at<std::int64_t>}, {MAT_C_UINT64, number_at<std::uint64_t>}};
  const auto found = kClasses.find(type);
  return found == kClasses.end() ? nullptr : found->second;
}

// The variables of a file of version 7.3; what MATLAB keeps for itself begins with #.
std::vector<std::string> variables_in(hid_t file) {
  std::vector<std::string> names;
  H5Literate(
      file, H5_INDEX_NAME, H5_ITER_INC, nullptr,
      [](hid_t, const char* name, const H5L_info_t*, void* to) -> herr_t {
        if (*name != '#') static_cast<std::vector<std::string>*>(to)->emplace_back(name);
        return 0;
      },
      &names);
  return names;
}

// MATLAB itself gives every variable a class; strings, dates and tables are no numbers.
bool holds_numbers(hid_t file, const std::string& name) {
  const Hdf5Id object(H5Oopen(file, name.c_str(), H5P_DEFAULT), H5Oclose);
  if (!object.good() || H5Iget_type(object.get()) != H5I_DATASET) return false;
  static const std::set<std::string> kNumbers = {"",       "double", "single", "int8",
                                                 "uint8",  "int16",  "uint16", "int32",
                                                 "uint32", "int64",  "uint64"};
  const Hdf5Id type(H5Dget_type(object.get()), H5Tclose);
  const H5T_class_t kind = H5Tget_class(type.get());
  return (kind == H5T_FLOAT || kind == H5T_INTEGER || kind == H5T_COMPOUND) &&
         kNumbers.contains(matlab_class(object.get())) && !is_matlab_empty(object.get());
}

}  // namespace

void MatlabContent::add_arrays(matvar_t* variable, std::vector<std::string> path, Leaf at) {
  using Holds = NamedArray::Holds;
  if (variable->class_type != MAT_C_STRUCT) {
    at.type = variable->class_type;
    const bool has_numbers = number_of_class(at.type) != nullptr;
    std::vector<std::size_t> dims(variable->dims, variable->dims + variable->rank);
    if (dims.size() == 1) dims.push_back(1);  // of HDF5, which has vectors
    arrays_.push_back({.path = std::move(path),
                       .dims = std::move(dims),
                       .holds = has_numbers
                                    ? variable->isComplex != 0 ? Holds::kComplex : Holds::kReal
                                : holds_texts(*variable) ? Holds::kText
                                                         : Holds::kOther,
                       .is_single = at.type == MAT_C_SINGLE,
                       .is_integer = at.type >= MAT_C_INT8 && at.type <= MAT_C_UINT64,
                       .place = leaves_.size()});
    leaves_.push_back(std::move(at));
    return;
  }
  if (size_of(*variable) != 1) return;
  char* const* const names = Mat_VarGetStructFieldnames(variable);
  for (std::size_t i = 0; i < Mat_VarGetNumberOfFields(variable); ++i) {
    matvar_t* const field = Mat_VarGetStructFieldByIndex(variable, i, 0);
    if (field == nullptr || names[i] == nullptr) continue;
    std::vector<std::string> below = path;
    below.emplace_back(names[i]);
    Leaf leaf = at;
    leaf.fields.push_back(i);
    add_arrays(field, std::move(below), std::move(leaf));
  }
}

MatlabContent::MatlabContent(Path path) : path_(std::move(path)) {
  require_regular_file(path_);
  MODCAL_REQUIRE(std::filesystem::exists(path_), "{}: there is no such file; check the path",
                 path_.string());
  MODCAL_REQUIRE(std::filesystem::file_size(path_) > 0, "{}: the file is empty", path_.string());
  require_whole_matlab_file(path_);
  {
    const std::lock_guard lock(hdf5_lock());
    const File file = opened(path_);
    std::set<std::string> names;
    for (;;) {
      const Variable variable = owned(Mat_VarReadNextInfo(file.get()));
      if (variable == nullptr) break;
      // Nothing could ask for one without a name.
      if (variable->name == nullptr || *variable->name == 0) continue;
      // libmatio would read the first of them in place of each.
      MODCAL_REQUIRE(names.insert(variable->name).second,
                     "{}: two variables are named {}; load and save it again", path_.string(),
                     variable->name);
      add_arrays(variable.get(), {variable->name}, {});
    }
    is_complete_ = Mat_GetVersion(file.get()) != MAT_FT_MAT73 || !passes_over_numbers(names);
  }
  read_heads();
}

bool MatlabContent::passes_over_numbers(const std::set<std::string>& variables) const {
  const Hdf5Id file(H5Fopen(path_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!file.good()) return false;
  std::vector<std::string> passed_over;
  for (const std::string& name : variables_in(file.get())) {
    if (!variables.contains(name)) passed_over.push_back(name);
  }
  for (const NamedArray& array : arrays_) {
    const bool is_known = leaves_[array.place].type != MAT_C_EMPTY;
    if (!is_known) passed_over.push_back(fmt::format("{}", fmt::join(array.path, "/")));
  }
  return std::ranges::any_of(
      passed_over, [&file](const std::string& name) { return holds_numbers(file.get(), name); });
}

// Names and units as write_matlab() left them.
void MatlabContent::read_heads() {
  for (NamedArray& head : arrays_) {
    if (head.path.size() != 3 || head.path[0] != kMatlabHeads ||
        head.holds != NamedArray::Holds::kText) {
      continue;
    }
    head.is_note = true;
    const auto found = std::ranges::find(arrays_, std::vector{head.path[1]}, &NamedArray::path);
    if (found == arrays_.end()) continue;
    (head.path[2] == "unit" ? found->unit : found->title) = text(head);
  }
}

std::vector<double> MatlabContent::column(const NamedArray& array, std::size_t j) {
  const matvar_t& field = this->field(array);
  const NumberAt read = number_of_class(field.class_type);
  // Numbers stand column by column.
  const std::size_t step = array.is_across() ? array.dims[0] : 1;
  const std::size_t first = array.is_across() ? j : j * array.dims[0];
  std::vector<const void*> parts = {field.data};
  if (!array.is_real()) {
    const auto& split = *static_cast<const mat_complex_split_t*>(field.data);
    parts = {split.Re, split.Im};
    MODCAL_REQUIRE(field.isComplex != 0 && split.Re != nullptr && split.Im != nullptr,
                   "{}: the variable {} cannot be read: the file is damaged; save it again",
                   path_.string(), array.text());
  }
  std::vector<double> samples;
  samples.reserve(array.rows() * parts.size());
  for (std::size_t i = 0; i < array.rows(); ++i) {
    for (const void* const part : parts) samples.push_back(read(part, first + i * step));
  }
  return samples;
}

std::vector<std::string> MatlabContent::texts(const NamedArray& array) {
  const matvar_t& field = this->field(array);
  std::vector<std::string> texts;
  if (field.class_type != MAT_C_CELL) {
    append_texts(field, texts);
    return texts;
  }
  const auto* const cells = static_cast<matvar_t* const*>(field.data);
  for (std::size_t i = 0; i < size_of(field); ++i) {
    if (cells[i] != nullptr) append_texts(*cells[i], texts);
  }
  return texts;
}

const matvar_t& MatlabContent::field(const NamedArray& array) {
  const std::lock_guard lock(hdf5_lock());
  const Leaf& leaf = leaves_[array.place];
  Variable& variable = read_.try_emplace(array.path[0], owned(nullptr)).first->second;
  if (variable == nullptr) {
    const File file = opened(path_);
    variable = owned(Mat_VarRead(file.get(), array.path[0].c_str()));
  }
  matvar_t* found = variable.get();
  for (const std::size_t place : leaf.fields) {
    if (found != nullptr) found = Mat_VarGetStructFieldByIndex(found, place, 0);
  }
  MODCAL_REQUIRE(found != nullptr && found->data != nullptr && size_of(*found) == array.size() &&
                     found->class_type == leaf.type &&
                     (found->isComplex != 0) == (array.holds == NamedArray::Holds::kComplex),
                 "{}: the variable {} cannot be read: the file is damaged; save it again",
                 path_.string(), array.text());
  return *found;
}

}  // namespace modcal
