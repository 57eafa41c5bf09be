// SPDX-License-Identifier: BSD-3-Clause
#include "schedulers/scripts.hpp"

#include <gtest/gtest.h>

#include <cstdlib>

#include "base/atomic_file.hpp"
#include "schedulers/command.hpp"
#include "schedulers/scheduler.hpp"
#include "schedulers/table.hpp"
#include "tests/support/temporary_directory.hpp"

namespace grouser {
namespace {

JobSpec plain_spec() {
  JobSpec spec;
  spec.campaign = "sweep";
  spec.label = "slip_20-s1";
  spec.token = "abc123def456";
  spec.run_directory = "/scratch/runs/sweep/runs/slip_20-s1-01234567";
  spec.engine = {"/opt/grouser/bin/grouser-engine", "--run-dir", spec.run_directory.string(),
                 "--token", spec.token};
  return spec;
}

JobSpec full_spec() {
  JobSpec spec = plain_spec();
  spec.run_directory = "/scratch/it's here/run";
  spec.ranks = 10;
  spec.nodes = 3;
  spec.walltime = 8 * 3600.0;
  spec.memory = "64G";
  spec.partition = "batch";
  spec.account = "soil@gpu";
  spec.qos = "normal";
  spec.launcher = "srun --mpi=pmix -n {ranks}";
  spec.setup_file = "/home/user/set up.sh";
  return spec;
}

// Compares with the file, or writes it when GROUSER_WRITE_GOLDEN is set.
void expect_golden(const std::string& name, const std::string& text) {
  const auto file = std::filesystem::path(GROUSER_TEST_DATA) / "scripts" / name;
  if (std::getenv("GROUSER_WRITE_GOLDEN") != nullptr) write_atomic(file, text);
  EXPECT_EQ(read_file(file).value_or("(no such file)"), text) << file;
}

TEST(Scripts, AreWordForWordTheGoldenOnes) {
  expect_golden("local_plain.sh", make_local_script(plain_spec()));
  expect_golden("slurm_plain.sh", make_slurm_script(plain_spec()));
  expect_golden("slurm_full.sh", make_slurm_script(full_spec()));
  ArraySpec array;
  array.common = full_spec();
  array.common.excluded_hosts = {"node7", "node12"};
  array.name = "gabc123def456";
  array.scripts = {"/scratch/it's here/a.sh", "/scratch/b.sh"};
  array.at_once = 1;
  expect_golden("slurm_array.sh", make_slurm_array_script(array));
  JobSpec member = plain_spec();
  member.token = member_token(member.token, 1);
  member.is_array_member = true;
  member.chain = "prologue";
  member.root = "/scratch/runs/sweep";
  member.partition = "batch";
  expect_golden("slurm_member.sh", make_slurm_script(member));
  JobSpec spec = full_spec();
  spec.qos.clear();
  spec.launcher.clear();
  expect_golden("pbs_full.sh", make_pbs_script(spec));
}

TEST(Scripts, WhatALaunchersNamesStandForIsQuotedAsOneWord) {
  JobSpec spec = full_spec();
  spec.root = "/scratch/it's; rm -rf $HOME";
  spec.home = "/home/user name";
  spec.launcher = "wrap --root={root} {run} {campaign} {home}/bin/mpi -n {ranks}:{ranks} {other}";
  for (const std::string& name : scheduler_names()) {
    const std::string script = scheduler_kind(name).make_script(spec);
    EXPECT_NE(script.find("\n'wrap' '--root=/scratch/it'\\''s; rm -rf $HOME' 'slip_20-s1' 'sweep' "
                          "'/home/user name/bin/mpi' '-n' '10:10' '{other}' '/opt/grouser"),
              std::string::npos)
        << script;
  }
}

TEST(Scripts, ThreadsGetTheirCoresAndAreNotBoundToOne) {
  JobSpec spec = full_spec();
  spec.threads = 4;
  spec.launcher.clear();
  const auto has = [](const std::string& script, const std::string& part) {
    EXPECT_NE(script.find(part), std::string::npos) << part << " in\n" << script;
  };
  const std::string slurm = make_slurm_script(spec);
  has(slurm, "\n#SBATCH --ntasks=10\n#SBATCH --cpus-per-task=4\n");
  has(slurm, "\nmpirun -n 10 --map-by slot:PE=4 --bind-to core '/opt/grouser");
  const std::string pbs = make_pbs_script(spec);
  has(pbs,
      "select=1:ncpus=16:mpiprocs=4:ompthreads=4:mem=64gb+2:ncpus=12:mpiprocs=3:ompthreads=4:"
      "mem=64gb\n");
  has(pbs, "mpirun -n 10 --map-by slot:PE=4 --bind-to core --hostfile");
  has(make_local_script(spec), "--bind-to none -n 10 ");
  has(make_local_script(spec), "\nexport OMP_WAIT_POLICY=passive\n");
  spec.launcher = "srun -n {ranks} -c {threads}";
  has(make_slurm_script(spec), "'srun' '-n' '10' '-c' '4'");
}

TEST(Scripts, OfEveryKindAreGoodShell) {
  TemporaryDirectory directory;
  for (const std::string& name : scheduler_names()) {
    const auto file = directory.path() / (name + ".sh");
    write_atomic(file, scheduler_kind(name).make_script(full_spec()));
    const auto result = run_command({"bash", "-n", file.string()}, 10.0);
    EXPECT_EQ(result.code, 0) << name << ": " << result.err;
  }
}

TEST(Scripts, OfChainsAndArraysAreGoodShell) {
  TemporaryDirectory directory;
  const auto file = directory.path() / "script.sh";
  for (const std::string& name : scheduler_names())
    for (const char* chain : {"prologue", "epilogue"}) {
      JobSpec spec = full_spec();
      spec.root = "/scratch/it's here";
      spec.chain = chain;
      write_atomic(file, scheduler_kind(name).make_script(spec));
      const auto result = run_command({"bash", "-n", file.string()}, 10.0);
      EXPECT_EQ(result.code, 0) << name << ": " << result.err;
      EXPECT_EQ(read_file(file)->find("/scratch/it'\\''s here/wake.sh") != std::string::npos,
                name != "local" || std::string(chain) == "epilogue")
          << name << " " << chain;
    }
}

TEST(Scripts, TheMembersOfAnArrayShareAJobName) {
  EXPECT_EQ(job_name(member_token("123456789abc", 17)), "g123456789abc_17");
  // A letter n at its end makes no member of a plain token.
  EXPECT_EQ(job_name("12345678nabn"), "g12345678nabn");
}

TEST(Scripts, JobNamesFitOldBatchSystems) {
  const std::string name = job_name("123456789abc");
  EXPECT_LE(name.size(), 15u);
  EXPECT_TRUE(std::isalpha(static_cast<unsigned char>(name[0])) != 0);
}

TEST(Scripts, StopMarginIsFivePercentWithinBounds) {
  EXPECT_EQ(stop_margin(0.0), 0.0);
  EXPECT_EQ(stop_margin(20.0), 10.0);
  EXPECT_EQ(stop_margin(100.0), 30.0);
  EXPECT_EQ(stop_margin(3600.0), 180.0);
  EXPECT_EQ(stop_margin(86400.0), 600.0);
}

}  // namespace
}  // namespace grouser
