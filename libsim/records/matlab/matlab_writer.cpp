#include <matio.h>

#include <cctype>
#include <memory>
#include <set>

#include "libsim/base/error.hpp"
#include "libsim/records/matlab/matlab_file.hpp"
#include "libsim/records/matlab/matlab_layout.hpp"
#include "libsim/records/signal_file.hpp"

namespace modcal {
namespace {

using Variable = std::unique_ptr<matvar_t, decltype(&Mat_VarFree)>;

Variable created(matvar_t* variable) {
  if (variable == nullptr) throw std::bad_alloc();
  return {variable, &Mat_VarFree};
}

Variable column(const std::string& name, std::span<const double> samples) {
  std::size_t dims[] = {samples.size(), 1};
  return created(Mat_VarCreate(name.c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims,
                               const_cast<double*>(samples.data()), MAT_F_DONT_COPY_DATA));
}

// MAT files keep the real parts before the imaginary ones.
Variable complex_column(const std::string& name, const WrittenArray& array) {
  std::size_t dims[] = {array.size(), 1};
  std::vector<double> parts[2];
  for (std::size_t i = 0; i < array.numbers.size(); ++i) {
    parts[i % 2].push_back(array.numbers[i]);
  }
  mat_complex_split_t split{parts[0].data(), parts[1].data()};
  return created(
      Mat_VarCreate(name.c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, &split, MAT_F_COMPLEX));
}

Variable text(const std::string& letters) {
  std::size_t dims[] = {letters.empty() ? std::size_t{0} : std::size_t{1}, letters.size()};
  return created(Mat_VarCreate(nullptr, MAT_C_CHAR, MAT_T_UTF8, 2, dims,
                               const_cast<char*>(letters.data()), 0));
}

Variable structure(const char* name, const std::vector<std::string>& fields) {
  std::vector<const char*> names;
  for (const std::string& field : fields) names.push_back(field.c_str());
  std::size_t dims[] = {1, 1};
  return created(
      Mat_VarCreateStruct(name, 2, dims, names.data(), static_cast<unsigned>(names.size())));
}

// A name that MATLAB takes for a variable: letters, digits and _, a letter first, 63 at the most
// with the number of another one of that name.
std::string variable_name(const std::string& quantity, const WrittenArrays& arrays,
                          std::set<std::string>& taken) {
  std::string name;
  for (const char letter : quantity.substr(0, 58)) {
    name += std::isalnum(static_cast<unsigned char>(letter)) ? letter : '_';
  }
  if (!std::isalpha(static_cast<unsigned char>(name[0]))) name = "x" + name;
  const std::string plain = name;
  for (int i = 2; arrays.is_for_axis(name) || !taken.insert(name).second; ++i) {
    name = fmt::format("{}_{}", plain, i);
  }
  return name;
}

void set(matvar_t& structure, const std::string& field, Variable value) {
  Mat_VarSetStructFieldByName(&structure, field.c_str(), 0, value.release());
}

void write_all(mat_t* file, const WrittenArrays& arrays) {
  std::set<std::string> taken = {kMatlabHeads, "provenance", "sample_rate", "t",
                                 "time",       "fs",         "dt",          kStart};
  std::vector<std::string> names;
  for (const WrittenArray& array : arrays.arrays) {
    names.push_back(variable_name(array.name, arrays, taken));
  }
  bool good = true;
  const auto write = [&](const Variable& variable) {
    good = good && Mat_VarWrite(file, variable.get(), MAT_COMPRESSION_NONE) == 0;
  };
  std::vector<std::string> fields = names;
  fields.emplace_back("provenance");
  const Variable heads = structure(kMatlabHeads, fields);
  for (std::size_t i = 0; i < names.size(); ++i) {
    Variable head = structure(nullptr, {"name", "unit"});
    set(*head, "name", text(arrays.arrays[i].name));
    set(*head, "unit", text(arrays.arrays[i].unit));
    set(*heads, names[i], std::move(head));
  }
  set(*heads, "provenance", text(arrays.provenance));
  write(column(arrays.axis, arrays.axis_values));
  if (arrays.has_start()) write(column(kStart, {&arrays.start, 1}));
  for (std::size_t i = 0; i < names.size(); ++i) {
    const WrittenArray& array = arrays.arrays[i];
    write(array.is_complex ? complex_column(names[i], array) : column(names[i], array.numbers));
  }
  write(heads);
  MODCAL_REQUIRE(good, "writing failed");
}

// libmatio says nothing of numbers that found no room. What is written last is looked for.
bool is_written(const std::filesystem::path& path) {
  try {
    require_whole_matlab_file(path);
  } catch (const InvalidInput&) {
    return false;
  }
  mat_t* const file = Mat_Open(path.c_str(), MAT_ACC_RDONLY);
  if (file == nullptr) return false;
  const Variable last(Mat_VarReadInfo(file, kMatlabHeads), &Mat_VarFree);
  Mat_Close(file);
  return last != nullptr;
}

}  // namespace

void write_matlab(const std::filesystem::path& path, const WrittenArrays& arrays) {
  const std::string name = path.string();
  replace_file(path, [&](const std::filesystem::path& temporary) {
    mat_t* const file =
        Mat_CreateVer(temporary.c_str(), "MATLAB 5.0 MAT-file, written by modcal", MAT_FT_MAT5);
    MODCAL_REQUIRE(file != nullptr, "{}: cannot be written; check the folder", name);
    std::string failure;
    try {
      write_all(file, arrays);
    } catch (const InvalidInput& error) {
      failure = error.what();
    }
    const bool closed = Mat_Close(file) == 0;
    MODCAL_REQUIRE(failure.empty() && closed && is_written(temporary),
                   "{}: writing failed; is the disk full?", name);
  });
}

}  // namespace modcal
