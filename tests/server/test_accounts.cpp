#include <chrono>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "server/auth/accounts.h"
#include "server/auth/audit_log.h"
#include "server/auth/login_limit.h"
#include "server/auth/secrets.h"
#include "server/store/engine.h"
#include "tests/support/temp_dir.h"

namespace leafcutter::server {
namespace {

constexpr const char* kPassword = "correct horse";

class AccountsTest : public ::testing::Test {
protected:
    AccountsTest() { open(); }

    void open() {
        accounts.reset();
        engine.reset();
        engine = open_engine(folder.path(), nullptr).engine;
        store = &engine->accounts();
        accounts = std::make_unique<Accounts>(*store);
    }

    test::TempDir folder;
    std::unique_ptr<Engine> engine;
    AccountStore* store = nullptr;
    std::unique_ptr<Accounts> accounts;
};

TEST_F(AccountsTest, TheFirstIsAnAdminAndTheLastAdminStays) {
    EXPECT_THROW(accounts->add("ann", Role::Viewer, kPassword), BadAccount);
    accounts->add("ann", Role::Admin, kPassword);
    accounts->add("bob", Role::Viewer, kPassword);
    EXPECT_THROW(accounts->set_role("ann", Role::Operator), LastAdmin);
    EXPECT_THROW(accounts->remove("ann"), LastAdmin);
    accounts->set_role("bob", Role::Admin);
    EXPECT_TRUE(accounts->remove("ann"));
    EXPECT_FALSE(accounts->user("ann"));
}

TEST_F(AccountsTest, RefusesNamesAndPasswordsByField) {
    EXPECT_THROW(accounts->add("Ann Lee", Role::Admin, kPassword), BadAccount);
    EXPECT_THROW(accounts->add("", Role::Admin, kPassword), BadAccount);
    EXPECT_THROW(accounts->add("ann", Role::Admin, "short"), BadAccount);
    EXPECT_TRUE(accounts->empty());
}

TEST_F(AccountsTest, PasswordsSurviveARestartAndAreNowhereInTheFile) {
    accounts->add("ann", Role::Admin, kPassword);
    open();
    EXPECT_TRUE(accounts->is_password_of("ann", kPassword));
    EXPECT_FALSE(accounts->is_password_of("ann", "correct horsf"));
    EXPECT_FALSE(accounts->is_password_of("nobody", kPassword));
    EXPECT_TRUE(accounts->user("ann")->password_hash.starts_with("$argon2id$"));
}

TEST_F(AccountsTest, AKeyGivesNoMoreThanItsUserHas) {
    accounts->add("ann", Role::Admin, kPassword);
    accounts->add("bob", Role::Operator, kPassword);
    const auto [key, secret] = accounts->add_key("bob", {"script", Role::Operator, false, 0});
    open();
    Caller caller = accounts->by_key(secret.secret);
    EXPECT_EQ(caller.name, "bob");
    EXPECT_EQ(caller.role, Role::Operator);
    EXPECT_FALSE(caller.may_fire);
    accounts->set_role("bob", Role::Viewer);
    EXPECT_EQ(accounts->by_key(secret.secret).role, Role::Viewer);
    EXPECT_TRUE(accounts->remove_key(key.id));
    EXPECT_EQ(accounts->by_key(secret.secret).proof, Caller::Proof::None);
}

TEST_F(AccountsTest, AKeyOfAnotherSecretOrPastItsEndIsNobody) {
    accounts->add("ann", Role::Admin, kPassword);
    const auto [key, secret] = accounts->add_key("ann", {"script", Role::Admin, true, 0});
    for (const std::string& wrong :
         {secret.secret.substr(0, secret.secret.size() - 1), secret.secret + "x",
          "lc_" + key.id + "_", std::string("lc_"), std::string(), key.secret_hash}) {
        EXPECT_EQ(accounts->by_key(wrong).proof, Caller::Proof::None) << wrong;
    }
    const auto [brief, brief_secret] = accounts->add_key("ann", {"brief", Role::Admin, true, 1});
    ApiKey over = brief;
    over.expires_ms = 1;
    store->put(over);
    open();
    EXPECT_EQ(accounts->by_key(brief_secret.secret).proof, Caller::Proof::None);
}

TEST_F(AccountsTest, ANewPasswordEndsTheSessions) {
    accounts->add("ann", Role::Admin, kPassword);
    const NewSecret session = accounts->begin_session("ann");
    open();
    EXPECT_EQ(accounts->by_session(session.secret).role, Role::Admin);
    accounts->set_password("ann", "another horse");
    EXPECT_EQ(accounts->by_session(session.secret).proof, Caller::Proof::None);
    open();
    EXPECT_EQ(accounts->by_session(session.secret).proof, Caller::Proof::None);
}

TEST_F(AccountsTest, OldSessionsEndWhereThereAreTooMany) {
    accounts->add("ann", Role::Admin, kPassword);
    std::vector<NewSecret> sessions;
    for (std::size_t i = 0; i < Accounts::kMostSessionsPerUser + 3; ++i) {
        sessions.push_back(accounts->begin_session("ann"));
    }
    std::size_t live = 0;
    for (const NewSecret& session : sessions) {
        live += accounts->by_session(session.secret).proof == Caller::Proof::Session ? 1 : 0;
    }
    EXPECT_EQ(live, Accounts::kMostSessionsPerUser);
    EXPECT_EQ(store->load().sessions.size(), Accounts::kMostSessionsPerUser);
}

TEST_F(AccountsTest, TheAuditLogOnlyGrows) {
    {
        AuditLog audit(*store);
        audit.append({0, 0, "ann", "10.0.0.9", "POST /api/v1/jobs", "", 201});
        audit.append({0, 0, "", "10.0.0.9", "POST /api/v1/session", "ann", 401});
    }
    const auto records = store->audit(std::nullopt, 10);
    ASSERT_EQ(records.size(), 2U);
    EXPECT_EQ(records[0].status, 401);
    EXPECT_EQ(store->audit(records[0].seq, 10).size(), 1U);
}

TEST(LoginLimit, AFewTriesAreFreeAndThenEachOneDoublesTheWait) {
    LoginLimit limit;
    LoginLimit::Clock::time_point now{};
    for (int i = 0; i < LoginLimit::kFreeTries; ++i) {
        EXPECT_EQ(limit.try_now("a", now).count(), 0);
    }
    std::chrono::seconds wait = limit.try_now("a", now);
    EXPECT_EQ(wait, LoginLimit::kFirstWait);
    EXPECT_EQ(limit.try_now("b", now).count(), 0) << "others are not held up";
    now += wait;
    EXPECT_EQ(limit.try_now("a", now).count(), 0);
    EXPECT_EQ(limit.try_now("a", now), 2 * LoginLimit::kFirstWait);
    limit.succeed("a");
    EXPECT_EQ(limit.try_now("a", now).count(), 0);
}

TEST(LoginLimit, ForgetsTheOldestOfTooMany) {
    LoginLimit limit;
    LoginLimit::Clock::time_point now{};
    for (int i = 0; i < LoginLimit::kFreeTries; ++i) {
        limit.try_now("first", now);
    }
    for (std::size_t i = 0; i < LoginLimit::kMostKeys; ++i) {
        now += std::chrono::milliseconds(1);
        limit.try_now(std::to_string(i), now);
    }
    EXPECT_EQ(limit.try_now("first", now).count(), 0);
}

TEST(Secrets, AreLongAndNeverTheSame) {
    EXPECT_EQ(new_secret().size(), 43U);
    EXPECT_NE(new_secret(), new_secret());
    EXPECT_TRUE(same_secret("abc", "abc"));
    EXPECT_FALSE(same_secret("abc", "abd"));
    EXPECT_FALSE(same_secret("abc", "abcd"));
}

}  // namespace
}  // namespace leafcutter::server
