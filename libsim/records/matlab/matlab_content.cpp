#include "libsim/records/matlab/matlab_content.hpp"

#include <hdf5.h>

#include <algorithm>
#include <set>

#include "libsim/base/error.hpp"
#include "libsim/base/files.hpp"
#include "libsim/base/utf8.hpp"
#include "libsim/records/hdf5/hdf5_file.hpp"
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
                                : at.type == MAT_C_CHAR ? Holds::kText
                                                        : Holds::kOther,
                       .is_single = at.type == MAT_C_SINGLE,
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
  }
  read_heads();
}

// Names and units as write_matlab() left them.
void MatlabContent::read_heads() {
  for (const NamedArray& head : arrays_) {
    if (head.path.size() != 3 || head.path[0] != kMatlabHeads ||
        head.holds != NamedArray::Holds::kText) {
      continue;
    }
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

std::string MatlabContent::text(const NamedArray& array) {
  const matvar_t& field = this->field(array);
  const auto* const letters = static_cast<const char*>(field.data);
  const bool is_bytes = field.data_type == MAT_T_UINT8 || field.data_type == MAT_T_INT8 ||
                        field.data_type == MAT_T_UTF8;
  if (!is_bytes) return {};
  return utf8_or_latin1({letters, std::min(size_of(field), field.nbytes)});
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
