#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "experiments/cli/command.hpp"
#include "experiments/cli/slurm.hpp"

namespace modcal::slurm_script_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::vector<std::size_t> first_tasks(std::size_t count, std::size_t step = 1) {
  std::vector<std::size_t> tasks;
  for (std::size_t i = 0; i < count; ++i) tasks.push_back(i * step);
  return tasks;
}

TEST(SlurmBundles, CutsTheListIntoJobsOfTheWantedLength) {
  // 10 000 tasks of 1.8 s are five hours of one core: ten jobs of half an hour.
  const SlurmBundles one = slurm_bundles(first_tasks(10000), 1.8, 1, 1800.0, 1000);
  EXPECT_EQ(one.count, 10u);
  EXPECT_DOUBLE_EQ(one.seconds, 1800.0);
  EXPECT_EQ(one.time_limit, 90u);
  EXPECT_EQ(slurm_bundles(first_tasks(10000), 1.8, 5, 1800.0, 1000).count, 2u);
}

TEST(SlurmBundles, KeepsToTheArrayToTheTasksAndToTenMinutes) {
  EXPECT_EQ(slurm_bundles(first_tasks(10000), 1.8, 1, 1.0, 7).count, 7u);
  EXPECT_EQ(slurm_bundles(first_tasks(3), 1e6, 1, 1.0, 1000).count, 3u);
  const SlurmBundles short_list = slurm_bundles(first_tasks(5), 0.001, 1, 1800.0, 1000);
  EXPECT_EQ(short_list.count, 1u);
  EXPECT_EQ(short_list.time_limit, 10u);
  EXPECT_EQ(slurm_bundles(first_tasks(0), 1.0, 1, 1800.0, 1000).count, 1u);
}

// Three of four shards were run by hand: in four jobs again one would do all that is left.
TEST(SlurmBundles, SharesOutWhatIsLeft) {
  const SlurmBundles rest = slurm_bundles(first_tasks(100, 4), 10.0, 1, 250.0, 1000);
  EXPECT_NE(rest.count % 4, 0u);
  EXPECT_LE(rest.seconds, 1.25 * 260.0);
  EXPECT_EQ(slurm_bundles(first_tasks(100, 4), 10.0, 1, 250.0, 4).count, 4u);
}

TEST(SlurmScript, RunsOneShardAJobAndMergesAfterwards) {
  const SlurmSettings settings{.program = "/opt/my modcal",
                               .file = "/a/b.yaml --set x=1",
                               .out = "/scratch/out",
                               .partition = "short",
                               .threads = 4};
  const std::string run = slurm_array_script(settings, {.count = 12, .time_limit = 45});
  EXPECT_THAT(run, HasSubstr("#!/bin/sh\n#SBATCH --job-name=modcal-run\n"));
  EXPECT_THAT(run, HasSubstr("#SBATCH --cpus-per-task=4\n#SBATCH --time=45\n"));
  EXPECT_THAT(run,
              HasSubstr("#SBATCH --requeue\n#SBATCH --partition=short\n#SBATCH --array=1-12\n"));
  EXPECT_THAT(run, HasSubstr("exec '/opt/my modcal' run /a/b.yaml --set x=1 --out /scratch/out "
                             "--threads 4 --shard \"$SLURM_ARRAY_TASK_ID\"/12\n"));
  const std::string merge = slurm_merge_script(settings);
  EXPECT_THAT(merge, HasSubstr("'/opt/my modcal' merge /scratch/out && "));
  EXPECT_THAT(merge, Not(HasSubstr("--array")));
}

TEST(ShellWord, QuotesWhatAShellWouldRead) {
  EXPECT_EQ(shell_word("out/a-1.yaml"), "out/a-1.yaml");
  EXPECT_EQ(shell_word("a b"), "'a b'");
  EXPECT_EQ(shell_word("it's"), "'it'\\''s'");
  EXPECT_EQ(shell_word(""), "''");
}

}  // namespace
}  // namespace modcal::slurm_script_test
