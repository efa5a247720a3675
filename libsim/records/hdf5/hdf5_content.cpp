#include "libsim/records/hdf5/hdf5_content.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "libsim/base/error.hpp"
#include "libsim/base/files.hpp"
#include "libsim/base/trial.hpp"
#include "libsim/base/utf8.hpp"
#include "libsim/records/hdf5/hdf5_complex.hpp"
#include "libsim/records/hdf5/hdf5_file.hpp"
#include "libsim/records/hdf5/hdf5_matlab.hpp"
#include "libsim/records/hdf5/hdf5_texts.hpp"

namespace modcal {
namespace {

using Path = std::filesystem::path;

// More objects than any record has; a damaged file may have them in circles.
constexpr std::size_t kMostArrays = 1 << 17;

// What the library said first.
std::string last_error() {
  std::string text;
  H5Ewalk2(
      H5E_DEFAULT, H5E_WALK_UPWARD,
      [](unsigned, const H5E_error2_t* error, void* to) -> herr_t {
        auto& said = *static_cast<std::string*>(to);
        if (said.empty() && error->desc != nullptr) said = error->desc;
        return 0;
      },
      &text);
  return text.empty() ? "no reason is told" : text;
}

std::vector<std::string> names_of(std::string_view object) {
  std::vector<std::string> names;
  while (!object.empty()) {
    const std::size_t at = object.find('/');
    const std::string_view name = object.substr(0, at);
    if (!name.empty() && name != ".") names.push_back(utf8_or_latin1(name));
    if (at == std::string_view::npos) break;
    object.remove_prefix(at + 1);
  }
  return names;
}

std::optional<std::vector<std::size_t>> dims_of(hid_t space) {
  if (H5Sget_simple_extent_type(space) == H5S_NULL) return std::nullopt;
  std::array<hsize_t, H5S_MAX_RANK> dims{};
  const int rank = H5Sget_simple_extent_dims(space, dims.data(), nullptr);
  if (rank < 0) return std::nullopt;
  std::vector<std::size_t> result(dims.begin(), dims.begin() + rank);
  while (result.size() < 2) result.push_back(1);
  std::size_t size = 1;
  for (const std::size_t n : result) {
    if (__builtin_mul_overflow(size, n, &size)) return std::nullopt;
  }
  return result;
}

NamedArray::Holds holds(hid_t type) {
  const H5T_class_t kind = H5Tget_class(type);
  if (kind == H5T_FLOAT || kind == H5T_INTEGER) return NamedArray::Holds::kReal;
  if (kind == H5T_STRING) return NamedArray::Holds::kText;
  return is_complex(type) ? NamedArray::Holds::kComplex : NamedArray::Holds::kOther;
}

// Whether all that is in a dataset stands in this file.
bool is_own(hid_t dataset) {
  const Hdf5Id layout(H5Dget_create_plist(dataset), H5Pclose);
  return layout.good() && H5Pget_external_count(layout.get()) == 0 &&
         H5Pget_layout(layout.get()) != H5D_VIRTUAL;
}

}  // namespace

std::mutex& hdf5_lock() {
  static std::mutex mutex;
  // What the library closes at the program's end may be what a damaged file left half open: it
  // crashed there, after the file was refused.
  static const herr_t left_open = H5dont_atexit();
  static_cast<void>(left_open);
  return mutex;
}

Hdf5Content::Hdf5Content(Path path, bool is_matlab)
    : path_(std::move(path)), is_matlab_(is_matlab) {
  const std::lock_guard lock(hdf5_lock());
  const std::uintmax_t bytes = std::filesystem::file_size(path_);
  // Headers of objects, hundreds of bytes each, are read in a millisecond; damaged ones may lead
  // the library round for ever.
  const auto most_seconds = static_cast<unsigned>(2 + std::min<std::uintmax_t>(bytes >> 17, 18));
  MODCAL_REQUIRE(survives([this] { list(); }, most_seconds),
                 "{}: the HDF5 library fails on it: the file of {} bytes is damaged; copy or save "
                 "it again",
                 path_.string(), bytes);
  list();
}

void Hdf5Content::list() {
  const Hdf5Id file = opened();
  // As they were made, where the file knows; else by their names.
  bool known = false;
  for (const H5_index_t order : {H5_INDEX_CRT_ORDER, H5_INDEX_NAME}) {
    if (known) break;
    arrays_.clear();
    places_.clear();
    known = H5Ovisit2(file.get(), order, H5_ITER_INC, list_object, this, H5O_INFO_BASIC) >= 0;
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  }
  MODCAL_REQUIRE(known, "{}: its objects cannot be listed: {}: the file is damaged", path_.string(),
                 last_error());
  read_titles();
}

Hdf5Id Hdf5Content::opened() const {
  require_regular_file(path_);
  MODCAL_REQUIRE(std::filesystem::exists(path_), "{}: there is no such file; check the path",
                 path_.string());
  const std::uint64_t size = std::filesystem::file_size(path_);
  MODCAL_REQUIRE(size > 0, "{}: the file is empty", path_.string());
  // What the library says on the terminal is said by the refusal.
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  Hdf5Id file(H5Fopen(path_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  MODCAL_REQUIRE(file.good(),
                 "{}: cannot be read as an HDF5 file of {} bytes: {}: copy or save it again",
                 path_.string(), size, last_error());
  return file;
}

herr_t Hdf5Content::list_object(hid_t root, const char* name, const H5O_info_t* info, void* self) {
  auto& content = *static_cast<Hdf5Content*>(self);
  if (content.arrays_.size() > kMostArrays) return 1;
  if (content.is_matlab_ && *name == '#') return 0;
  const bool is_dataset = info->type == H5O_TYPE_DATASET;
  if (is_dataset && !content.keeps([&] { content.add_dataset(root, name); })) return -1;
  if (info->type != H5O_TYPE_DATASET && info->type != H5O_TYPE_GROUP) return 0;
  const Hdf5Id object(H5Oopen(root, name, H5P_DEFAULT), H5Oclose);
  if (!object.good()) return 0;
  std::pair<Hdf5Content*, std::string> with(&content, name);
  H5Aiterate2(object.get(), H5_INDEX_NAME, H5_ITER_INC, nullptr, list_attribute, &with);
  return 0;
}

herr_t Hdf5Content::list_attribute(hid_t object, const char* name, const H5A_info_t*, void* self) {
  const auto& with = *static_cast<const std::pair<Hdf5Content*, std::string>*>(self);
  Hdf5Content& content = *with.first;
  const Hdf5Id attribute(H5Aopen(object, name, H5P_DEFAULT), H5Aclose);
  const bool is_matlabs = content.is_matlab_ && std::string_view(name).starts_with("MATLAB_");
  if (!attribute.good() || is_matlabs) return 0;
  const Hdf5Id type(H5Aget_type(attribute.get()), H5Tclose);
  const Hdf5Id space(H5Aget_space(attribute.get()), H5Sclose);
  const auto add = [&] { content.add({.object = with.second, .attribute = name}, type, space); };
  return content.keeps(add) ? 0 : -1;
}

void Hdf5Content::add_dataset(hid_t root, const std::string& name) {
  const Hdf5Id dataset(H5Dopen2(root, name.c_str(), H5P_DEFAULT), H5Dclose);
  MODCAL_REQUIRE(dataset.good(), "{}: the dataset {} cannot be read: {}: the file is damaged",
                 path_.string(), name, last_error());
  if (!is_own(dataset.get()) || (is_matlab_ && is_matlab_empty(dataset.get()))) return;
  const bool is_letters = is_matlab_ && matlab_class(dataset.get()) == "char";
  const Hdf5Id type(H5Dget_type(dataset.get()), H5Tclose);
  const Hdf5Id space(H5Dget_space(dataset.get()), H5Sclose);
  add({.object = name, .attribute = {}, .is_letters = is_letters}, type, space);
}

void Hdf5Content::add(const Place& place, const Hdf5Id& type, const Hdf5Id& space) {
  if (!type.good() || !space.good()) return;
  const auto dims = dims_of(space.get());
  if (!dims) return;
  NamedArray array{
      .path = names_of(place.object),
      .dims = *dims,
      .holds = holds(type.get()),
      .is_single = H5Tget_class(type.get()) == H5T_FLOAT && H5Tget_size(type.get()) < 8,
      .is_integer = H5Tget_class(type.get()) == H5T_INTEGER,
      .place = places_.size()};
  if (place.is_letters) array.holds = NamedArray::Holds::kText;
  if (place.is_letters) array.dims = {array.dims[1], 1};
  const bool is_attribute = !place.attribute.empty();
  if (is_attribute) array.path.push_back(utf8_or_latin1(place.attribute));
  // A list in an attribute tells of its object; it is no channel.
  array.is_note = is_attribute && array.size() != 1;
  if (array.is_note && array.size() != array.rows()) return;
  places_.push_back(place);
  places_.back().rank = static_cast<std::size_t>(H5Sget_simple_extent_ndims(space.get()));
  arrays_.push_back(std::move(array));
}

// Texts are few and short: a unit a column at most. The attribute `name` of a dataset is what it is
// called.
void Hdf5Content::read_titles() {
  texts_.assign(places_.size(), {});
  for (const NamedArray& array : arrays_) {
    constexpr std::size_t kMostTexts = 1 << 12;
    const bool is_text = array.holds == NamedArray::Holds::kText && array.size() <= kMostTexts;
    if (is_text) texts_[array.place] = read_texts(array);
  }
  for (const NamedArray& of : arrays_) {
    const Place& place = places_[of.place];
    if (place.attribute != "name" || texts_[of.place].size() != 1) continue;
    for (NamedArray& array : arrays_) {
      const Place& other = places_[array.place];
      const bool is_its = other.attribute.empty() && other.object == place.object;
      if (is_its) array.title = texts_[of.place].front();
    }
  }
}

void Hdf5Content::refuse(const NamedArray& array) const {
  throw_invalid_input("{}: {} cannot be read: the file of {} bytes is damaged; save it again",
                      path_.string(), array.text(), std::filesystem::file_size(path_));
}

std::vector<double> Hdf5Content::column(const NamedArray& array, std::size_t j) {
  const std::lock_guard lock(hdf5_lock());
  const std::size_t rows = (array.size() == 1 ? 1 : array.rows()) * (array.is_real() ? 1 : 2);
  // Compressed a thousand times at the most, and only as large as its header says where it is
  // whole.
  constexpr std::uint64_t kMostCompressed = 1 << 11;
  if (array.rows() / kMostCompressed > std::filesystem::file_size(path_)) refuse(array);
  // The samples, and whether they were read.
  const SharedMemory memory((rows + 1) * sizeof(double));
  const std::span<double> values = memory.as<double>();
  constexpr unsigned kMostSeconds = 3600;
  const bool alive = survives(
      [&] { values[rows] = read_column(array, j, values.first(rows)) ? 1.0 : 0.0; }, kMostSeconds);
  if (!alive || values[rows] != 1.0) refuse(array);
  return {values.begin(), values.begin() + static_cast<std::ptrdiff_t>(rows)};
}

bool Hdf5Content::read_column(const NamedArray& array, std::size_t j,
                              std::span<double> samples) const {
  const Place& place = places_[array.place];
  const Hdf5Id file = opened();
  if (!place.attribute.empty()) {
    const Hdf5Id attribute(H5Aopen_by_name(file.get(), place.object.c_str(),
                                           place.attribute.c_str(), H5P_DEFAULT, H5P_DEFAULT),
                           H5Aclose);
    return attribute.good() && H5Aread(attribute.get(), H5T_NATIVE_DOUBLE, samples.data()) >= 0;
  }
  const Hdf5Id dataset(H5Dopen2(file.get(), place.object.c_str(), H5P_DEFAULT), H5Dclose);
  const Hdf5Id space(dataset.good() ? H5Dget_space(dataset.get()) : -1, H5Sclose);
  if (!space.good() || dims_of(space.get()) != array.dims) return false;
  // The j-th row or column of a table; all of a vector.
  const bool across = array.is_across();
  const hsize_t rows = samples.size() / (array.is_real() ? 1 : 2);
  const std::array<hsize_t, 2> start = {across ? j : 0, across ? 0 : j};
  const std::array<hsize_t, 2> count = {across ? 1 : rows, across ? rows : 1};
  if (place.rank > 0 && H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr,
                                            count.data(), nullptr) < 0) {
    return false;
  }
  const Hdf5Id memory(H5Screate_simple(1, &rows, nullptr), H5Sclose);
  const Hdf5Id stored(H5Dget_type(dataset.get()), H5Tclose);
  const Hdf5Id number = array.is_real() ? Hdf5Id(H5Tcopy(H5T_NATIVE_DOUBLE), H5Tclose)
                                        : complex_in_memory(stored.get());
  return H5Dread(dataset.get(), number.get(), memory.get(), space.get(), H5P_DEFAULT,
                 samples.data()) >= 0;
}

std::vector<std::string> Hdf5Content::texts(const NamedArray& array) { return texts_[array.place]; }

std::vector<std::string> Hdf5Content::read_texts(const NamedArray& array) const {
  const Place& place = places_[array.place];
  const Hdf5Id file = opened();
  if (place.attribute.empty()) {
    const Hdf5Id dataset(H5Dopen2(file.get(), place.object.c_str(), H5P_DEFAULT), H5Dclose);
    if (!dataset.good()) refuse(array);
    if (place.is_letters) return matlab_letters(dataset.get(), array.size());
    const Hdf5Id type(H5Dget_type(dataset.get()), H5Tclose);
    return texts_of(type.get(), array.size(), [&](hid_t as, void* to) {
      return H5Dread(dataset.get(), as, H5S_ALL, H5S_ALL, H5P_DEFAULT, to);
    });
  }
  const Hdf5Id attribute(H5Aopen_by_name(file.get(), place.object.c_str(), place.attribute.c_str(),
                                         H5P_DEFAULT, H5P_DEFAULT),
                         H5Aclose);
  if (!attribute.good()) refuse(array);
  const Hdf5Id type(H5Aget_type(attribute.get()), H5Tclose);
  return texts_of(type.get(), array.size(),
                  [&](hid_t as, void* to) { return H5Aread(attribute.get(), as, to); });
}

}  // namespace modcal
