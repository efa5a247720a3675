// What every format that keeps channels with headers must do; the formats' own tests say the rest.
#include "libsim/records/formats.hpp"

#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <thread>

#include "tests/folder_test.hpp"
#include "tests/refusal.hpp"

namespace modcal::formats_test {
namespace {

using testing::HasSubstr;

struct Formats : FolderTest, testing::WithParamInterface<std::string_view> {
  std::filesystem::path file() const { return path("a." + std::string(GetParam())); }
  Recording read(const ReadOptions& options = {}) const {
    return read_record(file(), std::string(GetParam()), options);
  }
  void write_signals(const std::vector<Signal>& signals) const {
    record_format(file(), std::string(GetParam())).write(file(), signals, {"a test"});
  }
};

std::vector<Signal> two_signals() {
  return {{"R1 left/\u00e9", "N", 51200.0, {0.1, -2.5, 1e-300, 3.0}},
          {"R1_left", "mm/s", 51200.0, {4.0, 5.0, -0.0, 1.0 / 3.0}}};
}

TEST_P(Formats, KeepEveryBitNameAndUnitOfWhatIsWritten) {
  for (const double rate : {51200.0, 44100.0 / 1.001, 12345.678901}) {
    std::vector<Signal> signals = two_signals();
    for (Signal& signal : signals) signal.sample_rate = rate;
    write_signals(signals);
    const Recording found = read();
    // NPY has a column of time alone: four instants tell the rate to the rounding of the last one.
    const double rounding = GetParam() == "npy" ? 2e-16 : 0.0;
    EXPECT_NEAR(found.sample_rate, rate, rounding * rate);
    ASSERT_EQ(found.channels.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(found.channels[i].name, signals[i].quantity);
      EXPECT_EQ(found.channels[i].unit, signals[i].unit);
      ASSERT_EQ(found.channels[i].samples.size(), 4u);
      for (std::size_t j = 0; j < 4; ++j) {
        EXPECT_EQ(std::bit_cast<std::uint64_t>(found.channels[i].samples[j]),
                  std::bit_cast<std::uint64_t>(signals[i].samples[j]));
      }
    }
  }
}

TEST_P(Formats, HeadersAloneTellChannelsRateAndLength) {
  write_signals(two_signals());
  const Recording found = read({.headers_only = true});
  ASSERT_EQ(found.channels.size(), 2u);
  EXPECT_EQ(found.frames(), 4u);
  EXPECT_EQ(found.channels[1].name, "R1_left");
  EXPECT_EQ(found.channels[1].unit, "mm/s");
  // NPY has a column of time for it.
  if (GetParam() != "npy") {
    EXPECT_EQ(found.sample_rate, 51200.0);
  }
}

TEST_P(Formats, AFileCutOffAtAnyByteIsRefused) {
  write_signals(two_signals());
  const std::string bytes = content_of(file());
  // HDF5 is Debian's, slow to refuse, and tells its length in its first block.
  const std::size_t step = GetParam() == "hdf5" ? 29 : 1;
  for (std::size_t size = 0; size < bytes.size(); size += step) {
    write(file().filename().string(), std::string_view(bytes).substr(0, size));
    Recording found;
    const std::string said = refusal_of([&] { found = read(); });
    if (said != "accepted") {
      EXPECT_THAT(said, HasSubstr(file().filename().string())) << size;
      continue;
    }
    // A universal file may end behind any of its functions, and needs no last line end.
    EXPECT_EQ(GetParam(), "uff") << size << " of " << bytes.size();
    for (std::size_t i = 0; i < found.channels.size(); ++i) {
      EXPECT_EQ(found.channels[i].samples, two_signals()[i].samples) << size;
    }
  }
}

// One byte after the other, and many at once: refused or read, never more and never a crash. An
// archive has checksums: no sample of one that is read has changed.
TEST_P(Formats, DamagedFilesAreReadOrRefused) {
  write_signals(two_signals());
  const std::string bytes = content_of(file());
  const auto is_told = [](const RecordedChannel& channel) {
    return std::ranges::any_of(
        two_signals(), [&](const Signal& signal) { return signal.samples == channel.samples; });
  };
  const auto try_out = [&](const std::string& damaged) {
    write(file().filename().string(), damaged);
    refusal_of([&] {
      for (const RecordedChannel& channel : read().channels) {
        EXPECT_LE(channel.samples.size(), damaged.size());
        if (GetParam() == "npz") {
          EXPECT_TRUE(is_told(channel));
        }
      }
    });
  };
  const std::size_t step = GetParam() == "hdf5" ? 31 : 1;
  for (std::size_t i = 0; i < bytes.size(); i += step) {
    for (const int change : {1, 0xff}) {
      std::string damaged = bytes;
      damaged[i] = static_cast<char>(damaged[i] ^ change);
      try_out(damaged);
    }
  }
  std::uint64_t state = 7;
  const auto drawn = [&state](std::uint64_t below) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return (state >> 33) % below;
  };
  for (int round = 0; round < (step > 1 ? 40 : 200); ++round) {
    std::string damaged = bytes;
    for (int i = 0; i < 8; ++i) damaged[drawn(bytes.size())] = static_cast<char>(drawn(256));
    try_out(damaged);
  }
}

INSTANTIATE_TEST_SUITE_P(Every, Formats, testing::Values("npy", "npz", "hdf5", "lvm", "uff"),
                         [](const auto& test) { return std::string(test.param); });

struct AnyFile : FolderTest {};

// Rows are added every tenth of a millisecond to a file that takes a tenth of a second to read.
TEST_F(AnyFile, ThatIsWrittenToWhileItIsReadIsRefused) {
  std::string rows = "# sample_rate: 1000 Hz\nR1 [N],R2 [N]\n";
  for (int i = 0; i < 1'000'000; ++i) rows += "1,2\n";
  write("r.csv", rows);
  std::atomic<bool> is_read = false, is_begun = false;
  std::thread writer([&] {
    std::ofstream file(path("r.csv"), std::ios::app);
    for (int i = 0; i < 100'000 && !is_read; ++i) {
      file << "1,2\n" << std::flush;
      is_begun = true;
      std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
  });
  while (!is_begun) std::this_thread::yield();
  const std::string said = refusal_of([&] { read_record(path("r.csv"), "csv"); });
  is_read = true;
  writer.join();
  EXPECT_THAT(said, HasSubstr("r.csv: the file was written to while it was read"));
}

}  // namespace
}  // namespace modcal::formats_test
