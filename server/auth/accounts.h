// Users, keys and sessions. All of them are held in memory and written through to the store: who
// somebody is never waits for the database, so that a stop doesn't either. Safe from any thread.

#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "server/auth/account.h"

namespace leafcutter::server {

class AccountStore;

// The change is refused; the message begins with the field, "password: …".
class BadAccount : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

// Somebody has to stay who can let others in.
class LastAdmin : public std::runtime_error {
public:
    LastAdmin() : std::runtime_error("the last admin stays an admin") {}
};

// What a login or a new key gives out, once.
struct NewSecret {
    std::string secret;
    std::int64_t expires_ms = 0;  // 0: never.
};

struct KeyWish {
    std::string label;
    Role role = Role::Viewer;
    bool may_fire = false;
    std::int64_t lifetime_ms = 0;  // 0: for ever.
};

class Accounts {
public:
    static constexpr std::int64_t kIdleMs = 12LL * 3600 * 1000;
    static constexpr std::int64_t kSessionMs = 14LL * 24 * 3600 * 1000;
    static constexpr std::size_t kShortestPassword = 10;
    static constexpr std::size_t kLongestPassword = 256;
    static constexpr std::size_t kMostSessionsPerUser = 20;  // The oldest end beyond it.

    explicit Accounts(AccountStore& store);

    // Other processes change them too: as the store has them now. Throws StoreError.
    void reload();

    // Nobody has an account: on the loopback interface everything is open then.
    bool empty() const;

    // Nobody (Proof::None) for what is unknown or over.
    Caller by_key(std::string_view key);
    Caller by_session(std::string_view token);

    // What the caller came with still opens the door: not revoked, not over. No use of it.
    bool still_admits(const Caller& caller) const;

    // Takes a good part of 0.1 s, whether there is such a user or not.
    bool is_password_of(const std::string& user, std::string_view password) const;
    NewSecret begin_session(const std::string& user);
    void end_session(std::string_view token);

    std::vector<User> users() const;  // By name.
    std::optional<User> user(const std::string& name) const;

    // Throws BadAccount, LastAdmin. A new password ends the user's sessions.
    void add(const std::string& name, Role role, std::string_view password);
    void set_role(const std::string& name, Role role);
    void set_password(const std::string& name, std::string_view password);

    // With keys and sessions; false if there is none.
    bool remove(const std::string& name);

    std::vector<ApiKey> keys() const;  // Oldest first.

    // `secret` is the whole key, "lc_<id>_<secret>". Throws BadAccount.
    std::pair<ApiKey, NewSecret> add_key(const std::string& user, const KeyWish& wish);
    bool remove_key(const std::string& id);

private:
    void check_stays_admin(const std::string& name) const;
    void end_oldest_sessions(const std::string& user);

    AccountStore& store_;
    mutable std::mutex changing_;  // One change at a time, from memory to disk.
    mutable std::mutex mutex_;  // Guards the members below; never held while the disk is waited on.
    std::map<std::string, User> users_;        // By name.
    std::map<std::string, ApiKey> keys_;       // By id.
    std::map<std::string, Session> sessions_;  // By the token's hash.
};

// What a page sends along with unsafe calls, beside its cookie: only a page of ours can know it.
std::string csrf_token_of(std::string_view session_token);

}  // namespace leafcutter::server
