#include <string>

#include <gtest/gtest.h>

#include "server/fleet/node_role.h"
#include "server/fleet/remote_views.h"
#include "server/store/postgres/session.h"

namespace leafcutter::server {
namespace {

TEST(NodeRole, NeighbouringReleasesWorkTogetherAndNoOthers) {
    EXPECT_TRUE(may_work_together("1.4.2", "1.4.9"));
    EXPECT_TRUE(may_work_together("1.4.2", "1.5.0"));
    EXPECT_TRUE(may_work_together("1.5.0", "1.4.2"));
    EXPECT_FALSE(may_work_together("1.4.2", "1.6.0"));
    EXPECT_FALSE(may_work_together("1.9.0", "2.0.0"));
    EXPECT_FALSE(may_work_together("1.4.2", ""));
    EXPECT_FALSE(may_work_together("1.4.2", "one.four"));
}

TEST(NodeRole, EveryNameIsItsOwn) {
    for (const NodeRole role :
         {NodeRole::All, NodeRole::Api, NodeRole::Worker, NodeRole::Station}) {
        EXPECT_EQ(node_role_named(to_string(role)), role);
    }
    EXPECT_FALSE(node_role_named("boss"));
}

TEST(PgSession, ParametersAreNumberedOutsideOfQuotes) {
    EXPECT_EQ(with_numbered_parameters("a = ? AND b = ?"), "a = $1 AND b = $2");
    EXPECT_EQ(with_numbered_parameters("a = ?2 AND b = ?1"), "a = $2 AND b = $1");
    EXPECT_EQ(with_numbered_parameters("a = 'really?' AND b = ?"), "a = 'really?' AND b = $1");
    EXPECT_EQ(with_numbered_parameters("a = 'it''s?' AND b = ?"), "a = 'it''s?' AND b = $1");
}

TEST(RemoteViews, TheLastWordOfANodeCounts) {
    RemoteViews views;
    EXPECT_FALSE(views.find("device", "laser"));
    views.put("device", "laser", {{"ready", false}});
    views.put("device", "laser", {{"ready", true}});
    views.put("job", "laser", {{"ready", 5}});
    EXPECT_EQ(views.find("device", "laser")->at("ready"), true);
    EXPECT_FALSE(views.find("cut", "laser"));
}

}  // namespace
}  // namespace leafcutter::server
