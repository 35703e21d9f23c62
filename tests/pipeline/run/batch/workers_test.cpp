#include "pipeline/run/batch/workers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mesh/errors.h"
#include "tests/messages.h"

namespace palpate::pipeline {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsSupersetOf;
using testing::Not;

TEST(Workers, AreReadAsTheyAreWritten) {
    EXPECT_EQ(parse_workers("local:3").jobs, 3);
    EXPECT_EQ(parse_workers("local:3").kind, Workers::Kind::local);
    EXPECT_EQ(parse_workers("snakemake:our-cluster").profile, "our-cluster");
    EXPECT_EQ(parse_workers("slurm").kind, Workers::Kind::slurm);
    const Workers slurm = parse_workers("slurm:partition=short,account=a_1,jobs=7,memory=2.5,minutes=30");
    EXPECT_EQ(slurm.partition, "short");
    EXPECT_EQ(slurm.account, "a_1");
    EXPECT_EQ(slurm.jobs, 7);
    EXPECT_EQ(slurm.memory, 2.5);
    EXPECT_EQ(slurm.minutes, 30);
}

TEST(Workers, WhatTheyCannotBeIsSaid) {
    const auto says_why = [](const char* written, const char* why) {
        EXPECT_THAT(message_of<InvalidInput>([&] { parse_workers(written); }),
                    AllOf(HasSubstr(written), HasSubstr(why), HasSubstr("allowed: local:N, slurm")));
    };
    says_why("local", "number of runs at a time");
    says_why("local:0", "from 1 to");
    says_why("local:2x", "from 1 to");
    says_why("cloud", "not known");
    says_why("snakemake", "profile is missing");
    says_why("slurm:memory=none", "GB");
    says_why("slurm:memory=-1", "GB");
    says_why("slurm:queue=short", "'queue' is not known");
    // What a shell would take for a command of its own.
    says_why("slurm:partition=a;reboot", "letters, digits");
}

TEST(Workers, SnakemakeIsToldWhatTheyAre) {
    const auto arguments = [](const char* written) { return snakemake_arguments(parse_workers(written), 2); };
    EXPECT_THAT(arguments("local:3"), IsSupersetOf({"--cores", "6"}));
    EXPECT_THAT(arguments("local:3"), Not(Contains("--cluster")));
    EXPECT_THAT(arguments("snakemake:our-cluster"), IsSupersetOf({"--profile", "our-cluster"}));
    const auto slurm = arguments("slurm:partition=short,jobs=5");
    EXPECT_THAT(slurm,
                IsSupersetOf({"--jobs", "5", "--cluster-status", "./workflow/slurm_status.sh", "--restart-times"}));
    EXPECT_THAT(slurm, Contains(AllOf(HasSubstr("sbatch --parsable"), HasSubstr("--partition=short"),
                                      Not(HasSubstr("--account")))));
}

}  // namespace
}  // namespace palpate::pipeline
