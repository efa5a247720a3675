// MAT files: what modcal writes, and what MATLAB and other programs do, made here with libmatio.
#include <gmock/gmock.h>
#include <hdf5.h>

#include <array>
#include <fstream>

#include "tests/libsim/records/matlab_case.hpp"

namespace modcal::matlab_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class Matlab : public MatFileTest {
 protected:
  // The class of a variable of a file of version 7.3 in another form; padded with zeros it has no
  // room for one at its end.
  void set_class(const char* variable, const std::string& name, H5T_str_t padding) const {
    const hid_t whole = H5Fopen(file().c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    const hid_t dataset = H5Dopen2(whole, variable, H5P_DEFAULT);
    ASSERT_GE(H5Adelete(dataset, "MATLAB_class"), 0);
    const hid_t text = H5Tcopy(H5T_C_S1), space = H5Screate(H5S_SCALAR);
    H5Tset_size(text, name.size() + (padding == H5T_STR_NULLTERM ? 1 : 0));
    H5Tset_strpad(text, padding);
    const hid_t made = H5Acreate2(dataset, "MATLAB_class", text, space, H5P_DEFAULT, H5P_DEFAULT);
    ASSERT_GE(H5Awrite(made, text, name.c_str()), 0);
    H5Aclose(made);
    H5Sclose(space);
    H5Tclose(text);
    H5Dclose(dataset);
    H5Fclose(whole);
  }
};

TEST_F(Matlab, KeepsEveryBitNameAndUnitOfWhatIsWritten) {
  const std::vector<Signal> signals = two_signals();
  record_format(file(), "mat").write(file(), signals, {"a test"});
  const Recording found = read();
  EXPECT_EQ(found.sample_rate, 51200.0);
  EXPECT_EQ(found.format, "MAT file, 2 channels");
  ASSERT_EQ(found.channels.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(found.channels[i].name, signals[i].quantity);
    EXPECT_EQ(found.channels[i].unit, signals[i].unit);
    EXPECT_EQ(found.channels[i].samples, signals[i].samples);
  }
}

// Rows, columns and matrices of any class, with the rate or the instants beside them.
TEST_F(Matlab, ReadsVectorsAndMatricesOfEveryVersion) {
  for (const mat_ft version : {MAT_FT_MAT4, MAT_FT_MAT5, MAT_FT_MAT73}) {
    {
      MatWriter out(file(), version);
      out.write(MatWriter::doubles("force", 1, {1.0, 2.0, 3.0}));
      out.write(MatWriter::doubles("a", 3, {1.0, 2.0, 3.0, 4.0, 5.0, 6.0}));
      out.write(MatWriter::doubles("Fs", 1, {44100.0}));
    }
    // Version 7.3 keeps its variables in the order of their names.
    const Recording found = read({.channels = {"force", "a_1", "a_2"}});
    EXPECT_EQ(found.sample_rate, 44100.0) << version;
    ASSERT_EQ(found.channels.size(), 3u) << version;
    EXPECT_EQ(found.channels[0].name, "force");
    EXPECT_THAT(found.channels[0].samples, ElementsAre(1.0, 2.0, 3.0));
    EXPECT_EQ(found.channels[1].name, "a_1");
    EXPECT_EQ(found.channels[2].name, "a_2");
    EXPECT_THAT(found.channels[2].samples, ElementsAre(4.0, 5.0, 6.0));
    std::filesystem::remove(file());
  }
}

// As h5py writes it: the class in a text that is filled up with zeros, not ended by one. libmatio
// passes such variables over.
TEST_F(Matlab, ReadsVariablesWhoseClassAnotherProgramWrote) {
  {
    MatWriter out(file(), MAT_FT_MAT73);
    out.write(MatWriter::doubles("a", 3, {1.0, 2.0, 3.0}));
    out.write(MatWriter::doubles("force", 3, {4.0, 5.0, 6.0}));
    out.write(MatWriter::made<char>("force_unit", MAT_C_CHAR, MAT_T_UINT8, 1, {'m', 'N'}));
    out.write(MatWriter::doubles("fs", 1, {44100.0}));
  }
  set_class("force", "double", H5T_STR_NULLPAD);
  set_class("force_unit", "char", H5T_STR_NULLPAD);
  const Recording found = read();
  EXPECT_EQ(found.sample_rate, 44100.0);
  ASSERT_EQ(found.channels.size(), 2u);
  EXPECT_EQ(found.channels[1].name, "force");
  EXPECT_EQ(found.channels[1].unit, "mN");
  EXPECT_THAT(found.channels[1].samples, ElementsAre(4.0, 5.0, 6.0));
}

// libmatio knows no class for MATLAB's strings, dates and tables; all else is as it says.
TEST_F(Matlab, PassesOverAString) {
  {
    MatWriter out(file(), MAT_FT_MAT73);
    out.write(MatWriter::doubles("force", 3, {4.0, 5.0, 6.0}));
    out.write(MatWriter::doubles("fs", 1, {44100.0}));
    out.write(MatWriter::made<std::uint32_t>("name", MAT_C_UINT32, MAT_T_UINT32, 1, {1, 2, 3}));
    out.write(MatWriter::made<char>("note", MAT_C_CHAR, MAT_T_UINT8, 1, {'a', 'b', 'c'}));
  }
  set_class("name", "string", H5T_STR_NULLTERM);
  const Recording found = read();
  ASSERT_EQ(found.channels.size(), 1u);
  EXPECT_EQ(found.channels[0].name, "force");
}

TEST_F(Matlab, PassesOverAnEmptyField) {
  {
    MatWriter out(file(), MAT_FT_MAT5);
    out.write(MatWriter::doubles("fs", 1, {44100.0}));
    const char* fields[] = {"y", "note"};
    std::size_t dims[] = {1, 1};
    matvar_t* const structure = Mat_VarCreateStruct("s", 2, dims, fields, 2);
    Mat_VarSetStructFieldByName(structure, "y", 0, MatWriter::doubles(nullptr, 2, {1.0, 2.0}));
    out.write(structure);
  }
  EXPECT_EQ(read().channels.at(0).name, "s.y");
}

// Rows of a matrix of letters, and a cell of texts.
TEST_F(Matlab, ReadsAUnitAColumn) {
  {
    MatWriter out(file(), MAT_FT_MAT5);
    out.write(MatWriter::doubles("fs", 1, {44100.0}));
    out.write(MatWriter::doubles("a", 3, {1.0, 2.0, 3.0, 4.0, 5.0, 6.0}));
    out.write(MatWriter::made<char>("a_units", MAT_C_CHAR, MAT_T_UINT8, 2, {'m', 'g', 'N', ' '}));
    out.write(MatWriter::doubles("b", 3, {1.0, 2.0, 3.0}));
    std::size_t dims[] = {1, 2};
    matvar_t* cells[] = {MatWriter::made<char>(nullptr, MAT_C_CHAR, MAT_T_UINT8, 1, {'N'}),
                         MatWriter::made<char>(nullptr, MAT_C_CHAR, MAT_T_UINT8, 1, {'g'})};
    out.write(Mat_VarCreate("units", MAT_C_CELL, MAT_T_CELL, 2, dims, cells, 0));
  }
  const Recording found = read();
  ASSERT_EQ(found.channels.size(), 3u);
  EXPECT_EQ(found.channels[0].unit, "mN");
  EXPECT_EQ(found.channels[1].unit, "g");
  EXPECT_EQ(found.channels[2].unit, "");
  EXPECT_THAT(found.warnings, ElementsAre(HasSubstr("units (\"N, g\") is not read")));
}

TEST_F(Matlab, ReadsIntegersSinglesAndCompressedVariables) {
  {
    MatWriter out(file(), MAT_FT_MAT5);
    out.write(
        MatWriter::made<std::int16_t>("counts", MAT_C_INT16, MAT_T_INT16, 4, {-32768, 0, 1, 32767}),
        MAT_COMPRESSION_ZLIB);
    out.write(MatWriter::made<float>("v", MAT_C_SINGLE, MAT_T_SINGLE, 4, {0.5f, 1.5f, 2.5f, 3.5f}));
    out.write(MatWriter::doubles("time", 1, {0.0, 0.001, 0.002, 0.003}));
  }
  const Recording found = read();
  EXPECT_NEAR(found.sample_rate, 1000.0, 1e-9);
  ASSERT_EQ(found.channels.size(), 2u);
  EXPECT_THAT(found.channels[0].samples, ElementsAre(-32768.0, 0.0, 1.0, 32767.0));
  EXPECT_THAT(found.channels[1].samples, ElementsAre(0.5, 1.5, 2.5, 3.5));
}

// As modal analyzers export: a structure a signal, its increment beside its values.
TEST_F(Matlab, ReadsStructuresWithTheirOwnRates) {
  for (const mat_ft version : {MAT_FT_MAT5, MAT_FT_MAT73}) {
    {
      MatWriter out(file(), version);
      std::size_t dims[] = {1, 1};
      for (const char* name : {"hammer", "plate"}) {
        const char* axis[] = {"start_value", "increment"};
        matvar_t* x = Mat_VarCreateStruct(nullptr, 2, dims, axis, 2);
        Mat_VarSetStructFieldByName(x, "start_value", 0, MatWriter::doubles(nullptr, 1, {0.0}));
        Mat_VarSetStructFieldByName(x, "increment", 0,
                                    MatWriter::doubles(nullptr, 1, {1.0 / 8192}));
        const char* values[] = {"values"};
        matvar_t* y = Mat_VarCreateStruct(nullptr, 2, dims, values, 1);
        Mat_VarSetStructFieldByName(y, "values", 0,
                                    MatWriter::doubles(nullptr, 3, {7.0, 8.0, 9.0}));
        const char* fields[] = {"x_values", "y_values"};
        matvar_t* signal = Mat_VarCreateStruct(name, 2, dims, fields, 2);
        Mat_VarSetStructFieldByName(signal, "x_values", 0, x);
        Mat_VarSetStructFieldByName(signal, "y_values", 0, y);
        out.write(signal);
      }
    }
    const Recording found = read({.channels = {"plate.y_values.values"}});
    EXPECT_EQ(found.sample_rate, 8192.0) << version;
    ASSERT_EQ(found.channels.size(), 1u);
    EXPECT_THAT(found.channels[0].samples, ElementsAre(7.0, 8.0, 9.0));
    std::filesystem::remove(file());
  }
}

TEST_F(Matlab, ComplexVariablesAndTextsAreNoRecords) {
  {
    MatWriter out(file(), MAT_FT_MAT5);
    double re[] = {1.0, 2.0}, im[] = {3.0, 4.0};
    mat_complex_split_t both{re, im};
    std::size_t dims[] = {2, 1};
    out.write(Mat_VarCreate("H", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, &both, MAT_F_COMPLEX));
  }
  EXPECT_THAT(refusal(), HasSubstr("no channel of it is a record in time"));
}

TEST_F(Matlab, NamesOfOlderProgramsAreText) {
  {
    MatWriter out(file(), MAT_FT_MAT5);
    out.write(
        MatWriter::doubles("Kr\xe4"
                           "fte",
                           1, {1.0, 2.0, 3.0}));
    out.write(MatWriter::doubles("fs", 1, {100.0}));
  }
  EXPECT_EQ(read().channels.at(0).name, "Kr\u00e4fte");
}

TEST_F(Matlab, VariablesWithoutANameAreNoChannels) {
  std::ofstream out(file(), std::ios::binary);
  // Version 4: letters of a name with the zero after them.
  const auto write = [&out](const std::string& name, const std::vector<double>& numbers) {
    const auto count = static_cast<std::uint32_t>(numbers.size());
    const auto letters = static_cast<std::uint32_t>(name.size());
    const std::array<std::uint32_t, 5> header = {0, count, 1, 0, letters};
    out.write(reinterpret_cast<const char*>(header.data()), sizeof header);
    out << name;
    out.write(reinterpret_cast<const char*>(numbers.data()), std::streamsize{8} * count);
  };
  write(std::string("a\0", 2), {1.0, 2.0, 3.0});
  write(std::string("fs\0", 3), {100.0});
  write("", {4.0, 5.0, 6.0});
  out.close();
  const Recording found = read();
  ASSERT_EQ(found.channels.size(), 1u);
  EXPECT_THAT(found.channels[0].samples, ElementsAre(1.0, 2.0, 3.0));
}

// libmatio reads the first of both in place of each; where one was complex, its two parts were
// read as numbers.
TEST_F(Matlab, TwoVariablesOfOneNameAreRefused) {
  const auto file_of = [&](std::size_t rows, const std::vector<double>& numbers) {
    std::filesystem::remove(file());
    MatWriter(file(), MAT_FT_MAT5).write(MatWriter::doubles("force", rows, numbers));
    return content_of(file());
  };
  constexpr std::size_t kHeader = 128;
  const std::string first = file_of(2, {1.0, 2.0});
  write("a.mat", first + file_of(3, {1.0, 2.0, 3.0}).substr(kHeader));
  EXPECT_THAT(refusal(), HasSubstr("two variables are named force; load and save it again"));
}

TEST_F(Matlab, ARateThatIsNotPositiveIsRefused) {
  {
    MatWriter out(file(), MAT_FT_MAT5);
    out.write(MatWriter::doubles("force", 1, {1.0, 2.0, 3.0}));
    out.write(MatWriter::doubles("fs", 1, {0.0}));
  }
  EXPECT_THAT(refusal(), HasSubstr("the file tells a sample rate of 0 Hz (fs = 0)"));
  EXPECT_EQ(read({.survey = true}).problem_count, 1u);
}

TEST_F(Matlab, OtherFilesAreRefused) {
  std::ofstream(file()) << "t,f\n1,2\n";
  EXPECT_THAT(refusal(), HasSubstr("cannot be read as a MAT file"));
  std::ofstream(file(), std::ios::trunc).close();
  EXPECT_THAT(refusal(), HasSubstr("the file is empty"));
}

}  // namespace
}  // namespace modcal::matlab_test
