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
  /// Of a MAT file of version 7.3 what MATLAB keeps for itself is left out, and what it calls
  /// letters is text. Throws InvalidInput for what is no whole HDF5 file.
  explicit Hdf5Content(std::filesystem::path path, bool is_matlab = false);

  std::vector<double> column(const NamedArray& array, std::size_t j) override;
  std::vector<std::string> texts(const NamedArray& array) override;

 private:
  /// What an array is in the file.
  struct Place {
    std::string object, attribute;  // attribute: empty for a dataset
    bool is_letters = false;        // MATLAB's, which stand there as numbers
    std::size_t rank = 0;
  };
  static herr_t list_object(hid_t root, const char* name, const H5O_info_t* info, void* self);
  static herr_t list_attribute(hid_t object, const char* name, const H5A_info_t* info, void* self);
  void add(const Place& place, const Hdf5Id& type, const Hdf5Id& space);
  void add_dataset(hid_t root, const std::string& name);
  void list();
  void read_titles();
  bool read_column(const NamedArray& array, std::size_t j, std::span<double> samples) const;
  std::vector<std::string> read_texts(const NamedArray& array) const;
  Hdf5Id opened() const;
  [[noreturn]] void refuse(const NamedArray& array) const;
  // What the library calls must not throw: it would leave open what it has opened. False: it has
  // failed, and list() throws.
  template <typename Work>
  bool keeps(const Work& work) noexcept {
    try {
      work();
      return true;
    } catch (...) {
      failure_ = std::current_exception();
      return false;
    }
  }

  std::filesystem::path path_;
  bool is_matlab_;
  std::vector<Place> places_;
  std::vector<std::vector<std::string>> texts_;  // of the arrays that hold some
  std::exception_ptr failure_;
};

}  // namespace modcal
