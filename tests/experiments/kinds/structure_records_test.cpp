// Records of a structure that no sensors have read: refused with their place, whatever reads them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "experiments/kinds/structure/structure_files.hpp"
#include "libsim/records/record_file.hpp"
#include "tests/folder_test.hpp"
#include "tests/refusal.hpp"

namespace modcal::structure_records_test {
namespace {

using testing::HasSubstr;
using Samples = std::vector<double>;

class StructureRecords : public FolderTest {
 protected:
  // The other strike of configs/ with its second response changed.
  std::string said_of(const std::function<void(Samples&, const Samples&)>& change) const {
    const Recording strike =
        read_csv(std::string(MODCAL_CONFIGS) + "/structures/plate_other_strike.csv");
    Samples second = strike.channels[2].samples;
    const Samples& first = strike.channels[1].samples;
    change(second, first);
    std::string text = "# sample_rate: 4000 Hz\na1 [m/s2],a2 [m/s2]\n";
    for (std::size_t j = 0; j < second.size(); ++j) {
      text += fmt::format("{:.9g},{:.9g}\n", first[j], second[j]);
    }
    write("record.csv", text);
    try {
      load_structure_record(
          {.file = "record.csv", .responses = {{.channel = "a1"}, {.channel = "a2"}}}, path("."));
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return "accepted";
  }
};

TEST_F(StructureRecords, ThatSensorsReadAreAccepted) {
  EXPECT_EQ(said_of([](Samples&, const Samples&) {}), "accepted");
  // Eight bits: runs of equal samples where it turns and where it is quiet.
  EXPECT_EQ(said_of([](Samples& a, const Samples&) {
              double most = 0.0;
              for (const double x : a) most = std::max(most, std::abs(x));
              for (double& x : a) x = std::round(x / most * 128.0) / 128.0 * most;
            }),
            "accepted");
}

TEST_F(StructureRecords, OfASilentOrHeldChannelAreRefused) {
  EXPECT_THAT(said_of([](Samples& a, const Samples&) { std::ranges::fill(a, 0.0); }),
              HasSubstr("record.csv:3: channel a2, sample 0 (0 s): all 1200 samples are 0"));
  EXPECT_THAT(said_of([](Samples& a, const Samples&) { std::fill_n(a.begin() + 120, 40, 0.0); }),
              HasSubstr("record.csv:123: channel a2, sample 120 (0.03 s): 40 samples in a row"));
  EXPECT_THAT(said_of([](Samples& a, const Samples&) { std::fill(a.begin() + 240, a.end(), 0.0); }),
              HasSubstr("the channel was cut off"));
  EXPECT_THAT(said_of([](Samples& a, const Samples&) {
                double most = 0.0;
                for (const double x : a) most = std::max(most, 0.3 * std::abs(x));
                for (double& x : a) x = std::clamp(x, -most, most);
              }),
              HasSubstr("the peaks are clipped"));
  EXPECT_THAT(said_of([](Samples& a, const Samples&) {
                for (double& x : a) x *= 1e300;
              }),
              HasSubstr("outside the range"));
}

TEST_F(StructureRecords, OfOneChannelTwiceAreRefused) {
  EXPECT_THAT(said_of([](Samples& a, const Samples& first) { a = first; }),
              HasSubstr("channels a1 and a2 are the same samples"));
}

}  // namespace
}  // namespace modcal::structure_records_test
