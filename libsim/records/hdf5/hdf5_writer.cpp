#include <algorithm>
#include <set>

#include "libsim/base/error.hpp"
#include "libsim/records/hdf5/hdf5_content.hpp"
#include "libsim/records/hdf5/hdf5_file.hpp"
#include "libsim/records/signal_file.hpp"

namespace modcal {
namespace {

class Hdf5Writer {
 public:
  Hdf5Writer(const std::filesystem::path& path, const std::string& name)
      : name_(name), file_(created(path), H5Fclose) {}

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
  void add_signal(const Signal& signal) {
    std::string link = signal.quantity;
    std::replace(link.begin(), link.end(), '/', '_');
    if (link == ".") link = "_";
    const std::string plain = link;
    for (int i = 2; !links_.insert(link).second; ++i) link = fmt::format("{}_{}", plain, i);
    const hsize_t size = signal.size();
    const Hdf5Id space(H5Screate_simple(1, &size, nullptr), H5Sclose);
    const Hdf5Id dataset(H5Dcreate2(file_.get(), link.c_str(), H5T_NATIVE_DOUBLE, space.get(),
                                    H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                         H5Dclose);
    good(dataset.good() ? H5Dwrite(dataset.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                                   signal.samples.data())
                        : -1);
    add_text(dataset.get(), "name", signal.quantity);
    add_text(dataset.get(), "unit", signal.unit);
  }
  hid_t root() const { return file_.get(); }
  void finish() const { good(H5Fflush(file_.get(), H5F_SCOPE_LOCAL)); }

 private:
  void good(herr_t done) const {
    MODCAL_REQUIRE(done >= 0, "{}: writing failed; is the disk full?", name_);
  }
  static hid_t created(const std::filesystem::path& path) {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    const Hdf5Id how(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    H5Pset_link_creation_order(how.get(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
    return H5Fcreate(path.c_str(), H5F_ACC_TRUNC, how.get(), H5P_DEFAULT);
  }
  const std::string& name_;
  Hdf5Id file_;
  std::set<std::string> links_;
};

}  // namespace

void write_hdf5(const std::filesystem::path& path, std::span<const Signal> signals,
                const std::string& provenance) {
  const std::string name = path.string();
  require_one_record(signals, name);
  replace_file(path, [&](const std::filesystem::path& temporary) {
    const std::lock_guard lock(hdf5_lock());
    Hdf5Writer writer(temporary, name);
    MODCAL_REQUIRE(writer.root() >= 0, "{}: cannot be written; check the folder", name);
    const double rate = signals.front().sample_rate;
    writer.add_attribute(writer.root(), "sample_rate", H5T_NATIVE_DOUBLE, &rate);
    writer.add_text(writer.root(), "provenance", provenance);
    for (const Signal& signal : signals) writer.add_signal(signal);
    writer.finish();
  });
}

}  // namespace modcal
