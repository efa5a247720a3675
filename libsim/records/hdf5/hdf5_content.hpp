// The datasets and attributes of an HDF5 file.
#pragma once

#include <hdf5.h>

#include "libsim/records/arrays/array_file.hpp"

namespace modcal {

/// An identifier of the library that is closed with it.
class Hdf5Id {
 public:
  Hdf5Id(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Hdf5Id() {
    if (id_ >= 0) close_(id_);
  }
  Hdf5Id(Hdf5Id&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Hdf5Id(const Hdf5Id&) = delete;
  Hdf5Id& operator=(const Hdf5Id&) = delete;
  hid_t get() const { return id_; }
  bool good() const { return id_ >= 0; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

/// Read when it is asked for; from any thread. The library crashes on some damaged files, so that
/// a child of this process goes first (libsim/base/trial.hpp).
class Hdf5Content : public ArrayFile {
 public:
  /// Throws InvalidInput for what is no whole HDF5 file.
  explicit Hdf5Content(std::filesystem::path path);

  std::vector<double> column(const NamedArray& array, std::size_t j) override;
  std::string text(const NamedArray& array) override;

 private:
  /// What an array is in the file.
  struct Place {
    std::string object, attribute;  // attribute: empty for a dataset
    std::size_t rank = 0;
  };
  static herr_t list_object(hid_t root, const char* name, const H5O_info_t* info, void* self);
  static herr_t list_attribute(hid_t object, const char* name, const H5A_info_t* info, void* self);
  void add(const Place& place, const Hdf5Id& type, const Hdf5Id& space);
  void add_dataset(hid_t root, const std::string& name);
  void list();
  void read_titles();
  bool read_column(const NamedArray& array, std::size_t j, std::span<double> samples) const;
  std::string read_text(const NamedArray& array) const;
  Hdf5Id opened() const;
  [[noreturn]] void refuse(const NamedArray& array) const;

  std::filesystem::path path_;
  std::vector<Place> places_;
  std::vector<std::string> texts_;  // of the arrays that are one
};

}  // namespace modcal
