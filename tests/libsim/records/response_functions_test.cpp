// Response functions as columns of a CSV file and as complex arrays of MAT and NumPy files.
#include "libsim/records/response_functions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <matio.h>

#include <cmath>
#include <cstring>
#include <numbers>

#include "tests/folder_test.hpp"
#include "tests/refusal.hpp"

namespace modcal::response_functions_test {
namespace {

using testing::HasSubstr;

class ResponseFunctionsIn : public FolderTest {
 protected:
  ResponseFunctions read(const std::filesystem::path& file, const std::vector<std::string>& names,
                         FrequencyFunction wanted = FrequencyFunction::kResponse) const {
    return read_response_functions(file, "auto", names, wanted);
  }
  std::string refusal(const std::string& text, const std::string& name) const {
    const auto file = write("refused.csv", text);
    return refusal_of([&] { read(file, {name}); });
  }
};

// Three lines from 2 Hz on, 1 Hz apart.
void expect_lines(const ResponseFunctions& read) {
  EXPECT_EQ(read.grid.bins, 5u);
  EXPECT_DOUBLE_EQ(read.grid.omega(3), 3.0 * 2.0 * std::numbers::pi);
  for (const ResponseFunction& function : read.functions) {
    ASSERT_EQ(function.values.size(), 5u);
    EXPECT_TRUE(std::isnan(function.values[1].real()));
  }
}

TEST_F(ResponseFunctionsIn, ColumnsOfText) {
  const auto file =
      write("a.csv",
            "frequency [Hz],h1 [m/s2/N],h1 imaginary,b real [g/lbf],b imaginary [g/lbf],"
            "p [(m/s2)/N],p phase [deg],c1\n"
            "2,0.5,-1,7,8,2,90,0.9\n3,1.5,-2,9,10,3,-180,0.8\n4,2.5,-3,11,12,4,0,1\n");
  const ResponseFunctions read = this->read(file, {"h1", "b", "p"});
  expect_lines(read);
  EXPECT_EQ(read.functions[0].unit, "m/s2");
  EXPECT_EQ(read.functions[0].per_unit, "N");
  EXPECT_EQ(read.functions[0].values[3], Complex(1.5, -2.0));
  EXPECT_EQ(read.functions[1].name, "b");
  EXPECT_EQ(read.functions[1].unit, "g");
  EXPECT_EQ(read.functions[1].per_unit, "lbf");
  EXPECT_EQ(read.functions[1].values[4], Complex(11.0, 12.0));
  // cos and sin of a right angle, to rounding.
  EXPECT_NEAR(std::abs(read.functions[2].values[2] - Complex(0.0, 2.0)), 0.0, 1e-15);
  EXPECT_NEAR(std::abs(read.functions[2].values[3] - Complex(-3.0, 0.0)), 0.0, 1e-15);
  const ResponseFunctions coherence = this->read(file, {"c1"}, FrequencyFunction::kCoherence);
  EXPECT_EQ(coherence.functions[0].values[3], Complex(0.8));
  EXPECT_THAT(refusal_of([&] { this->read(file, {"c1"}); }),
              HasSubstr("\"c1\" is no response function"));
  EXPECT_THAT(refusal_of([&] { this->read(file, {"h1"}, FrequencyFunction::kCoherence); }),
              HasSubstr("\"h1\" is no coherence"));
}

TEST_F(ResponseFunctionsIn, ColumnsInKilohertz) {
  const auto file = write("a.csv", "f [kHz],h,h imaginary\n0.002,1,2\n0.003,3,4\n0.004,5,6\n");
  expect_lines(read(file, {"h"}));
}

TEST_F(ResponseFunctionsIn, ColumnsThatAreNoneAreRefused) {
  EXPECT_THAT(refusal("x,h,h imaginary\n1,2,3\n2,3,4\n", "h"),
              HasSubstr("need a column frequency [Hz]"));
  EXPECT_THAT(refusal("frequency [s],h,h imaginary\n1,2,3\n2,3,4\n", "h"),
              HasSubstr("state frequencies in Hz"));
  EXPECT_THAT(refusal("frequency [Hz],h,h phase\n1,2,3\n2,3,4\n", "h"),
              HasSubstr("state its unit, [deg] or [rad]"));
  EXPECT_THAT(refusal("frequency [Hz],h [m/N],h imaginary [mm/N]\n1,2,3\n2,3,4\n", "h"),
              HasSubstr("its imaginary part in"));
  EXPECT_THAT(refusal("frequency [Hz],h,h imaginary\n1,2,3\n2,3,4\n4,3,4\n", "h"),
              HasSubstr("3 lines that are not even"));
  EXPECT_THAT(refusal("frequency [Hz],h,h imaginary,h phase [deg]\n1,2,3,4\n2,3,4,5\n", "h"),
              HasSubstr("leave one column out"));
  EXPECT_THAT(refusal("frequency [Hz],h real\n1,2\n2,3\n", "h"),
              HasSubstr("no column \"h imaginary\""));
  EXPECT_THAT(refusal("frequency [Hz],h [dB],h phase [deg]\n1,2,3\n2,3,4\n", "h"),
              HasSubstr("write magnitudes"));
  // 1.3 Hz is no whole number of steps of 1 Hz.
  EXPECT_THAT(refusal("frequency [Hz],h,h imaginary\n1.3,2,3\n2.3,3,4\n", "h"),
              HasSubstr("not even"));
  EXPECT_THAT(refusal("frequency [Hz],h,h imaginary\n1,nan,3\n2,3,4\n", "h"), HasSubstr(":2:3"));
  EXPECT_THAT(refusal("frequency [Hz],h,h imaginary\n2,2,3\n", "h"), HasSubstr("not even"));
}

TEST_F(ResponseFunctionsIn, MatFiles) {
  for (const mat_ft version : {MAT_FT_MAT4, MAT_FT_MAT5, MAT_FT_MAT73}) {
    const auto file = path("a.mat");
    std::filesystem::remove(file);
    mat_t* const mat = Mat_CreateVer(file.c_str(), nullptr, version);
    const auto put = [&](const char* name, std::size_t rows, std::size_t columns, void* data,
                         int is_complex) {
      std::size_t dims[] = {rows, columns};
      matvar_t* const variable =
          Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, data, is_complex);
      EXPECT_EQ(Mat_VarWrite(mat, variable, MAT_COMPRESSION_NONE), 0);
      Mat_VarFree(variable);
    };
    std::vector<double> f = {2.0, 3.0, 4.0}, real = {1, 2, 3, 4, 5, 6},
                        imaginary = {-1, -2, -3, -4, -5, -6}, coherence = {0.9, 0.8, 1.0};
    mat_complex_split_t split{real.data(), imaginary.data()};
    put("freq", 3, 1, f.data(), 0);
    put("H", 3, 2, &split, MAT_F_COMPLEX);
    put("gamma2", 3, 1, coherence.data(), 0);
    // Four lines are told by their distance.
    double step = 0.5;
    std::vector<double> even = {1, 2, 3, 4};
    mat_complex_split_t four{even.data(), even.data()};
    put("df", 1, 1, &step, 0);
    put("G", 4, 1, &four, MAT_F_COMPLEX);
    Mat_Close(mat);
    const ResponseFunctions told = this->read(file, {"G"});
    EXPECT_EQ(told.grid.bins, 4u);
    EXPECT_DOUBLE_EQ(told.grid.spacing, std::numbers::pi);
    EXPECT_EQ(told.functions[0].values[2], Complex(3.0, 3.0));
    const ResponseFunctions read = this->read(file, {"H_1", "H_2"});
    expect_lines(read);
    EXPECT_EQ(read.functions[0].values[3], Complex(2.0, -2.0));
    EXPECT_EQ(read.functions[1].values[4], Complex(6.0, -6.0));
    EXPECT_EQ(this->read(file, {"gamma2"}, FrequencyFunction::kCoherence).functions[0].values[3],
              Complex(0.8));
  }
}

// Header and numbers as NumPy writes them.
std::string npy(const std::string& type, const std::string& shape, const void* data,
                std::size_t bytes) {
  std::string head = "{'descr': '" + type + "', 'fortran_order': False, 'shape': " + shape + ", }";
  head.resize(117, ' ');
  head += '\n';
  std::string text("\x93NUMPY\x01\x00", 8);
  text += std::string("\x76\x00", 2) + head;
  return text + std::string(static_cast<const char*>(data), bytes);
}

TEST_F(ResponseFunctionsIn, AnArrayOfNumPyWithoutLinesIsRefused) {
  const std::vector<Complex> values = {{1, 2}, {3, 4}, {5, 6}};
  const auto file = write("h.npy", npy("<c16", "(3,)", values.data(), 48));
  EXPECT_THAT(refusal_of([&] { read(file, {"h"}); }),
              HasSubstr("3 values without their lines: state them as a vector f [Hz]"));
}

TEST_F(ResponseFunctionsIn, FieldsOfNumPy) {
  struct Item {
    double f;
    float real, imaginary;
  };
  const std::vector<Item> items = {{2.0, 1.0F, 2.0F}, {3.0, 3.0F, -4.0F}, {4.0, 5.0F, 6.0F}};
  std::string head =
      "{'descr': [('f', '<f8'), ('h [m/N]', '<c8')], 'fortran_order': False, 'shape': (3,), }";
  head.resize(117, ' ');
  std::string text("\x93NUMPY\x01\x00\x76\x00", 10);
  text += head + '\n';
  text.append(reinterpret_cast<const char*>(items.data()), sizeof(Item) * items.size());
  const ResponseFunctions read = this->read(write("h.npy", text), {"h"});
  expect_lines(read);
  EXPECT_EQ(read.functions[0].values[3], Complex(3.0, -4.0));
  EXPECT_EQ(read.functions[0].unit, "m");
}

}  // namespace
}  // namespace modcal::response_functions_test
