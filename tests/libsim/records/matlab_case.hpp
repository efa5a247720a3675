// MAT files of tests, made with libmatio.
#pragma once

#include <gtest/gtest.h>
#include <matio.h>

#include <string>
#include <vector>

#include "libsim/records/formats.hpp"
#include "tests/folder_test.hpp"
#include "tests/refusal.hpp"

namespace modcal {

class MatFileTest : public FolderTest {
 protected:
  std::filesystem::path file() const { return path("a.mat"); }
  Recording read(const ReadOptions& options = {}) const {
    return read_record(file(), "auto", options);
  }
  std::string refusal() const {
    return refusal_of([&] { read(); });
  }
};

// Variables of one file, made by the calls that every MAT file goes through.
class MatWriter {
 public:
  MatWriter(const std::filesystem::path& path, mat_ft version)
      : file_(Mat_CreateVer(path.c_str(), nullptr, version)) {}
  ~MatWriter() { Mat_Close(file_); }
  MatWriter(const MatWriter&) = delete;
  MatWriter& operator=(const MatWriter&) = delete;

  template <typename Number>
  static matvar_t* made(const char* name, matio_classes type, matio_types data, std::size_t rows,
                        std::vector<Number> numbers) {
    std::size_t dims[] = {rows, numbers.size() / rows};
    return Mat_VarCreate(name, type, data, 2, dims, numbers.data(), 0);
  }
  static matvar_t* doubles(const char* name, std::size_t rows, std::vector<double> numbers) {
    return made(name, MAT_C_DOUBLE, MAT_T_DOUBLE, rows, std::move(numbers));
  }
  void write(matvar_t* variable, matio_compression compression = MAT_COMPRESSION_NONE) {
    EXPECT_EQ(Mat_VarWrite(file_, variable, compression), 0);
    Mat_VarFree(variable);
  }

 private:
  mat_t* file_;
};

inline std::vector<Signal> two_signals() {
  return {{"R1 left", "N", 51200.0, {0.1, -2.5, 1e-300, 3.0}},
          {"R1_left", "mm/s", 51200.0, {4.0, 5.0, -0.0, 1.0 / 3.0}}};
}

}  // namespace modcal
