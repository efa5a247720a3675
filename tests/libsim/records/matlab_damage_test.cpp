// MAT files that are cut off, damaged, or state more than there is.
#include <gmock/gmock.h>
#include <zlib.h>

#include <array>
#include <cmath>
#include <fstream>

#include "tests/libsim/records/matlab_case.hpp"

namespace modcal::matlab_damage_test {
namespace {

using testing::HasSubstr;

class DamagedMatlab : public MatFileTest {};

TEST_F(DamagedMatlab, AFileCutOffAnywhereIsRefused) {
  record_format(file(), "mat").write(file(), two_signals(), {"a test"});
  std::ifstream whole(file(), std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(whole), {}};
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    std::ofstream(file(), std::ios::binary | std::ios::trunc) << bytes.substr(0, size);
    const std::string said = refusal();
    // Between two variables a file may end; without the heads it is another one.
    if (said != "accepted") {
      EXPECT_THAT(said, HasSubstr("a.mat")) << size;
      continue;
    }
    for (const RecordedChannel& channel : read().channels) {
      EXPECT_EQ(channel.samples.size(), 4u) << size;
      EXPECT_EQ(channel.unit, "") << size;
    }
  }
}

TEST_F(DamagedMatlab, AFileOfVersion73CutOffIsRefused) {
  {
    MatWriter out(file(), MAT_FT_MAT73);
    out.write(MatWriter::doubles("force", 1, {1.0, 2.0, 3.0}));
    out.write(MatWriter::doubles("fs", 1, {1000.0}));
  }
  const std::string bytes = content_of(file());
  for (std::size_t size = 0; size < bytes.size(); size += 101) {
    write("a.mat", std::string_view(bytes).substr(0, size));
    EXPECT_THAT(refusal(), HasSubstr("a.mat")) << size;
  }
}

TEST_F(DamagedMatlab, HeadersThatStateMoreThanThereIsAreRefused) {
  // Version 4: 30 rows and a name of 2 GB; 2^31 columns.
  for (const std::array<std::uint32_t, 5>& header :
       {std::array<std::uint32_t, 5>{0, 30, 1, 0, 0x7fffffff}, {0, 30, 0x80000000, 0, 2}}) {
    std::ofstream out(file(), std::ios::binary);
    out.write(reinterpret_cast<const char*>(header.data()), sizeof header);
    out << std::string(300, 'a');
    out.close();
    EXPECT_THAT(refusal(), HasSubstr("the variable at byte 0 is not whole"));
  }
}

// A file of version 5 whose variable at byte 128 is of these numbers, packed or as they are.
std::string of_version_5(const std::vector<std::uint32_t>& words, bool is_packed) {
  const auto bytes = [](const auto& numbers) {
    return std::string(reinterpret_cast<const char*>(numbers.data()),
                       numbers.size() * sizeof numbers[0]);
  };
  std::string text = "MATLAB 5.0 MAT-file";
  text.resize(124, ' ');
  text += std::string("\x00\x01IM", 4);
  if (!is_packed) return text + bytes(words);
  std::string packed(2048, ' ');
  uLongf size = packed.size();
  const std::string plain = bytes(words);
  EXPECT_EQ(compress(reinterpret_cast<Bytef*>(packed.data()), &size,
                     reinterpret_cast<const Bytef*>(plain.data()), plain.size()),
            Z_OK);
  packed.resize(size);
  return text + bytes(std::array<std::uint32_t, 2>{15, static_cast<std::uint32_t>(size)}) + packed;
}

// What libmatio believes: 2^29 dimensions in a variable of 185 bytes kept it busy for 12 s and 3
// GB; numbers that are stated and not there are what memory held; 2^24 cells or fields are cleared.
TEST_F(DamagedMatlab, AVariableThatStatesMoreThanItHoldsIsRefused) {
  constexpr std::uint32_t kMany = 1 << 24;
  // A tag of 14 and a size; flags of a class; dimensions; the name "a"; contents.
  const auto variable = [](std::uint32_t type, std::uint32_t columns,
                           std::vector<std::uint32_t> contents) {
    std::vector<std::uint32_t> words = {14, 0, 6, 8, type, 0, 5, 8, 1, columns, 1, 1, 0x61, 0};
    words.insert(words.end(), contents.begin(), contents.end());
    words[1] = static_cast<std::uint32_t>(4 * words.size() - 8);
    return words;
  };
  constexpr std::uint32_t kCell = 1, kStructure = 2, kText = 4, kSparse = 5, kDouble = 6,
                          kFunction = 16, kBytes = 2;
  const std::vector<std::uint32_t> three = {kBytes, 3, 0x00030201, 0};
  const std::vector<std::uint32_t> field = {0x00040005, 2, 1, 2, 0x62, 0};
  for (const bool is_packed : {false, true}) {
    for (const auto& [words, is_whole] : std::vector<std::pair<std::vector<std::uint32_t>, bool>>{
             {variable(kDouble, 3, three), true},
             {variable(kDouble, 4, three), false},
             {variable(kDouble, kMany, three), false},
             {variable(kDouble | 0x800, 3, three), false},
             {variable(kText, 4, {4, 4, 0x00620061, 0}), false},
             {variable(kCell, kMany, {14, 0}), false},
             {variable(kStructure, kMany, field), false},
             {variable(kFunction, kMany, {14, 0}), false},
             {variable(kFunction, 1, {14, 0}), true},
             {variable(kSparse, 3, {5, 4, 0, 0, 5, 8, 0, 1, 9, 8, 0, 0}), true},
             {variable(kSparse, 3, {5, kMany, 0, 0}), false},
             {{14, 48, 6, 8, kDouble, 0, 5, 4, 3, 0, 1, 1, 0x61, 0}, false},
             {{14, 200, 6, 8, kDouble, 0, 5, 0x68010008, 1, 30}, false}}) {
      write("a.mat", of_version_5(words, is_packed));
      const std::string said = refusal();
      EXPECT_EQ(said.find("the variable at byte 128 is damaged") != std::string::npos ||
                    said.find("is not whole") != std::string::npos,
                !is_whole)
          << said << " " << words[4] << " " << words[9];
    }
  }
}

// libmatio reads numbers whose checksum is another.
TEST_F(DamagedMatlab, ADamagedCompressedVariableIsRefused) {
  std::vector<double> numbers(60);
  for (std::size_t i = 0; i < numbers.size(); ++i)
    numbers[i] = std::sin(0.3 * static_cast<double>(i));
  {
    MatWriter writer(file(), MAT_FT_MAT5);
    writer.write(MatWriter::doubles("a", 60, numbers), MAT_COMPRESSION_ZLIB);
    writer.write(MatWriter::doubles("fs", 1, {1000.0}));
  }
  EXPECT_EQ(read().channels.at(0).samples, numbers);
  const std::string whole = content_of(file());
  std::size_t refused = 0;
  for (std::size_t i = 300; i < 500; ++i) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    write("a.mat", damaged);
    const std::string said = refusal();
    refused += said.find("is damaged") != std::string::npos ? 1 : 0;
  }
  EXPECT_EQ(refused, 200u);
}

}  // namespace
}  // namespace modcal::matlab_damage_test
