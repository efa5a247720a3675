#include <algorithm>
#include <fstream>
#include <set>

#include "libsim/base/error.hpp"
#include "libsim/records/hdf5/hdf5_complex.hpp"
#include "libsim/records/hdf5/hdf5_content.hpp"
#include "libsim/records/hdf5/hdf5_file.hpp"
#include "libsim/records/signal_file.hpp"

namespace modcal {
namespace {

// In memory: the library crashes at the program's end where its file could not be closed, as on a
// full disk.
class Hdf5Writer {
 public:
  explicit Hdf5Writer(const std::string& name) : name_(name), file_(created(name), H5Fclose) {}

  void add_text(hid_t object, const char* attribute, const std::string& text) const {
    const Hdf5Id type(H5Tcopy(H5T_C_S1), H5Tclose);
    good(H5Tset_size(type.get(), H5T_VARIABLE));
    good(H5Tset_cset(type.get(), H5T_CSET_UTF8));
    const char* const letters = text.c_str();
    add_attribute(object, attribute, type.get(), &letters);
  }
  void add_attribute(hid_t object, const char* attribute, hid_t type, const void* value) const {
    const Hdf5Id space(H5Screate(H5S_SCALAR), H5Sclose);
    const Hdf5Id made(H5Acreate2(object, attribute, type, space.get(), H5P_DEFAULT, H5P_DEFAULT),
                      H5Aclose);
    good(made.good() ? H5Awrite(made.get(), type, value) : -1);
  }
  // The link's own name is left to what tells the axis.
  void add_array(const WrittenArray& array, const WrittenArrays& all) {
    std::string link = array.name;
    std::replace(link.begin(), link.end(), '/', '_');
    if (link == ".") link = "_";
    const std::string plain = link;
    for (int i = 2; all.is_for_axis(link) || !links_.insert(link).second; ++i) {
      link = fmt::format("{}_{}", plain, i);
    }
    const Hdf5Id number =
        array.is_complex ? complex_as_numpy() : Hdf5Id(H5Tcopy(H5T_NATIVE_DOUBLE), H5Tclose);
    const Hdf5Id dataset = add_dataset(link, number.get(), array.size(), array.numbers.data());
    add_text(dataset.get(), "name", array.name);
    add_text(dataset.get(), "unit", array.unit);
  }
  Hdf5Id add_dataset(const std::string& link, hid_t number, hsize_t size,
                     const double* data) const {
    const Hdf5Id space(H5Screate_simple(1, &size, nullptr), H5Sclose);
    Hdf5Id dataset(H5Dcreate2(file_.get(), link.c_str(), number, space.get(), H5P_DEFAULT,
                              H5P_DEFAULT, H5P_DEFAULT),
                   H5Dclose);
    good(dataset.good() ? H5Dwrite(dataset.get(), number, H5S_ALL, H5S_ALL, H5P_DEFAULT, data)
                        : -1);
    return dataset;
  }
  hid_t root() const { return file_.get(); }
  std::vector<char> content() const {
    good(H5Fflush(file_.get(), H5F_SCOPE_LOCAL));
    std::vector<char> image(
        static_cast<std::size_t>(std::max<ssize_t>(0, H5Fget_file_image(file_.get(), nullptr, 0))));
    good(H5Fget_file_image(file_.get(), image.data(), image.size()) > 0 ? 0 : -1);
    return image;
  }

 private:
  void good(herr_t done) const {
    MODCAL_REQUIRE(done >= 0, "{}: writing failed; is the disk full?", name_);
  }
  static hid_t created(const std::string& name) {
    constexpr std::size_t kGrowsBy = 1 << 20;
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    const Hdf5Id how(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    H5Pset_link_creation_order(how.get(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
    const Hdf5Id where(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    H5Pset_fapl_core(where.get(), kGrowsBy, 0);
    return H5Fcreate(name.c_str(), H5F_ACC_TRUNC, how.get(), where.get());
  }
  const std::string& name_;
  Hdf5Id file_;
  std::set<std::string> links_;
};

std::vector<char> content_of(const WrittenArrays& arrays, const std::string& name) {
  const std::lock_guard lock(hdf5_lock());
  Hdf5Writer writer(name);
  MODCAL_REQUIRE(writer.root() >= 0, "{}: cannot be written; check the folder", name);
  if (arrays.has_lines()) {
    const Hdf5Id lines = writer.add_dataset(arrays.axis, H5T_NATIVE_DOUBLE,
                                            arrays.axis_values.size(), arrays.axis_values.data());
    writer.add_text(lines.get(), "unit", "Hz");
  } else {
    writer.add_attribute(writer.root(), arrays.axis.c_str(), H5T_NATIVE_DOUBLE,
                         arrays.axis_values.data());
  }
  if (arrays.has_start()) {
    writer.add_attribute(writer.root(), kStart, H5T_NATIVE_DOUBLE, &arrays.start);
  }
  writer.add_text(writer.root(), "provenance", arrays.provenance);
  for (const WrittenArray& array : arrays.arrays) writer.add_array(array, arrays);
  return writer.content();
}

}  // namespace

void write_hdf5(const std::filesystem::path& path, const WrittenArrays& arrays) {
  const std::vector<char> content = content_of(arrays, path.string());
  replace_file(path, [&](const std::filesystem::path& temporary) {
    std::ofstream file(temporary, std::ios::binary);
    file.write(content.data(), std::ssize(content));
    file.close();
    MODCAL_REQUIRE(!file.fail(), "{}: writing failed; is the disk full?", path.string());
  });
}

}  // namespace modcal
