#include <gtest/gtest.h>

#include "server/queue/states.h"

namespace leafcutter::server {
namespace {

constexpr CutState kCutStates[] = {
    CutState::Waiting, CutState::Armed,         CutState::Cutting,
    CutState::Paused,  CutState::AwaitingSheet, CutState::Done,
    CutState::Aborted, CutState::Failed,        CutState::Interrupted};

TEST(CutStates, OnlyAnArmedOrPausedCutStartsToBurn) {
    for (const CutState from : kCutStates) {
        const bool may = from == CutState::Armed || from == CutState::Paused;
        EXPECT_EQ(may_follow(from, CutState::Cutting), may) << to_string(from);
    }
}

TEST(CutStates, NothingFollowsAFinalState) {
    for (const CutState from : kCutStates) {
        for (const CutState to : kCutStates) {
            if (is_final(from)) {
                EXPECT_FALSE(may_follow(from, to)) << to_string(from) << " " << to_string(to);
            }
        }
    }
}

TEST(CutStates, NamesGoThereAndBack) {
    for (const CutState state : kCutStates) {
        EXPECT_EQ(cut_state_named(to_string(state)), state);
    }
    EXPECT_FALSE(cut_state_named("burning"));
}

TEST(JobStates, AFailedJobLeavesThatStateOnlyByAnotherTry) {
    EXPECT_TRUE(may_follow(JobState::Failed, JobState::Queued));
    EXPECT_TRUE(may_follow(JobState::Cancelled, JobState::Queued));
    for (const JobState to : {JobState::Computing, JobState::Ready, JobState::Done}) {
        EXPECT_FALSE(may_follow(JobState::Failed, to)) << to_string(to);
        EXPECT_FALSE(may_follow(JobState::Cancelled, to)) << to_string(to);
    }
}

}  // namespace
}  // namespace leafcutter::server
