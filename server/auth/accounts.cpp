#include "server/auth/accounts.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "server/auth/secrets.h"
#include "server/store/account_store.h"
#include "server/store/blobs.h"
#include "server/store/ids.h"
#include "server/store/store_error.h"

namespace leafcutter::server {

namespace {

constexpr std::string_view kKeyPrefix = "lc_";

void check_name(const std::string& name) {
    const auto is_plain = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '_' || c == '.';
    };
    constexpr std::size_t kLongest = 64;
    if (name.empty() || name.size() > kLongest ||
        !std::all_of(name.begin(), name.end(), is_plain)) {
        throw BadAccount("name: must be 1 to 64 of a-z, 0-9, -, _ and .");
    }
}

void check_password(std::string_view password) {
    if (password.size() < Accounts::kShortestPassword ||
        password.size() > Accounts::kLongestPassword) {
        throw BadAccount(fmt::format("password: must have {} to {} bytes",
                                     Accounts::kShortestPassword, Accounts::kLongestPassword));
    }
}

// What an unknown user's password is compared with, so that the answer takes as long.
const std::string& hash_of_nobody() {
    static const std::string hash = hash_password(new_secret());
    return hash;
}

bool is_over(const ApiKey& key, std::int64_t now_ms) {
    return key.expires_ms > 0 && now_ms > key.expires_ms;
}

bool is_over(const Session& session, std::int64_t now_ms) {
    return now_ms - session.created_ms > Accounts::kSessionMs ||
           now_ms - session.used_ms > Accounts::kIdleMs;
}

}  // namespace

Accounts::Accounts(AccountStore& store) : store_(store) {
    reload();
}

void Accounts::reload() {
    const std::scoped_lock change(changing_);
    StoredAccounts stored = store_.load();
    std::map<std::string, User> users;
    for (User& user : stored.users) {
        users.emplace(user.name, std::move(user));
    }
    const std::int64_t now = wall_clock_ms();
    const std::scoped_lock lock(mutex_);
    std::map<std::string, ApiKey> keys;
    for (ApiKey& key : stored.keys) {
        const auto known = keys_.find(key.id);
        key.used_ms = known == keys_.end() ? key.used_ms : known->second.used_ms;
        keys.emplace(key.id, std::move(key));
    }
    std::map<std::string, Session> sessions;
    for (Session& session : stored.sessions) {
        const auto known = sessions_.find(session.token_hash);
        // Uses are not written down: a restart, or another node's word, counts as one.
        session.used_ms = known == sessions_.end() ? now : known->second.used_ms;
        if (!is_over(session, now)) {
            sessions.emplace(session.token_hash, std::move(session));
        }
    }
    users_.swap(users);
    keys_.swap(keys);
    sessions_.swap(sessions);
}

bool Accounts::empty() const {
    const std::scoped_lock lock(mutex_);
    return users_.empty();
}

Caller Accounts::by_key(std::string_view text) {
    const std::size_t end = text.find('_', kKeyPrefix.size());
    if (!text.starts_with(kKeyPrefix) || end == std::string_view::npos) {
        return {};
    }
    const std::string id(text.substr(kKeyPrefix.size(), end - kKeyPrefix.size()));
    const std::string hash = sha256_of(text.substr(end + 1));
    const std::scoped_lock lock(mutex_);
    const auto key = keys_.find(id);
    if (key == keys_.end() || !same_secret(key->second.secret_hash, hash)) {
        return {};
    }
    const auto owner = users_.find(key->second.user);
    const std::int64_t now = wall_clock_ms();
    if (owner == users_.end() || is_over(key->second, now)) {
        return {};
    }
    key->second.used_ms = now;
    return {Caller::Proof::Key, owner->first, std::min(key->second.role, owner->second.role),
            key->second.may_fire, id};
}

Caller Accounts::by_session(std::string_view token) {
    const std::string hash = sha256_of(token);
    const std::int64_t now = wall_clock_ms();
    const std::scoped_lock lock(mutex_);
    const auto session = sessions_.find(hash);
    if (session == sessions_.end() || is_over(session->second, now)) {
        return {};
    }
    const auto owner = users_.find(session->second.user);
    if (owner == users_.end()) {
        return {};
    }
    session->second.used_ms = now;
    return {Caller::Proof::Session, owner->first, owner->second.role, true, hash};
}

bool Accounts::still_admits(const Caller& caller) const {
    const std::int64_t now = wall_clock_ms();
    const std::scoped_lock lock(mutex_);
    switch (caller.proof) {
        case Caller::Proof::None:
            return false;
        case Caller::Proof::NoAccounts:
            return users_.empty();
        case Caller::Proof::Key: {
            const auto key = keys_.find(caller.credential);
            return key != keys_.end() && !is_over(key->second, now);
        }
        case Caller::Proof::Session: {
            const auto session = sessions_.find(caller.credential);
            return session != sessions_.end() && !is_over(session->second, now);
        }
    }
    return false;
}

bool Accounts::is_password_of(const std::string& name, std::string_view password) const {
    const std::optional<User> found = user(name);
    const bool right = is_password(found ? found->password_hash : hash_of_nobody(), password);
    return found && right;
}

NewSecret Accounts::begin_session(const std::string& user) {
    const std::scoped_lock change(changing_);
    const std::int64_t now = wall_clock_ms();
    const std::string token = new_secret();
    const Session session{sha256_of(token), user, now, now};
    try {
        store_.put(session);
    } catch (const StoreError& error) {  // A daemon that only reads can still be looked at.
        spdlog::warn("session of {}: until the daemon stops: {}", user, error.what());
    }
    {
        const std::scoped_lock lock(mutex_);
        sessions_.emplace(session.token_hash, session);
    }
    end_oldest_sessions(user);
    return {token, now + kSessionMs};
}

void Accounts::end_oldest_sessions(const std::string& user) {
    std::vector<Session> over;
    {
        const std::scoped_lock lock(mutex_);
        std::vector<Session> of_user;
        for (const auto& [hash, session] : sessions_) {
            if (session.user == user) {
                of_user.push_back(session);
            }
        }
        std::sort(of_user.begin(), of_user.end(),
                  [](const Session& a, const Session& b) { return a.used_ms > b.used_ms; });
        for (std::size_t i = kMostSessionsPerUser; i < of_user.size(); ++i) {
            sessions_.erase(of_user[i].token_hash);
            over.push_back(of_user[i]);
        }
    }
    for (const Session& session : over) {
        store_.remove_session(session.token_hash);
    }
}

void Accounts::end_session(std::string_view token) {
    const std::scoped_lock change(changing_);
    const std::string hash = sha256_of(token);
    {
        const std::scoped_lock lock(mutex_);
        sessions_.erase(hash);
    }
    store_.remove_session(hash);
}

std::vector<User> Accounts::users() const {
    const std::scoped_lock lock(mutex_);
    std::vector<User> users;
    for (const auto& [name, user] : users_) {
        users.push_back(user);
    }
    return users;
}

std::optional<User> Accounts::user(const std::string& name) const {
    const std::scoped_lock lock(mutex_);
    const auto found = users_.find(name);
    return found == users_.end() ? std::nullopt : std::optional(found->second);
}

void Accounts::add(const std::string& name, Role role, std::string_view password) {
    check_name(name);
    check_password(password);
    const std::string hash = hash_password(password);
    const std::scoped_lock change(changing_);
    const std::optional<User> known = user(name);
    if (known) {
        throw BadAccount("name: there is a user of that name");
    }
    // The first account locks the door for everybody else: it must be able to open it again.
    if (empty() && role != Role::Admin) {
        throw BadAccount("role: the first user must be an admin");
    }
    const User added{name, role, hash, wall_clock_ms()};
    store_.put(added);
    const std::scoped_lock lock(mutex_);
    users_.emplace(name, added);
}

void Accounts::check_stays_admin(const std::string& name) const {
    const std::vector<User> all = users();
    const bool another = std::any_of(all.begin(), all.end(), [&name](const User& each) {
        return each.role == Role::Admin && each.name != name;
    });
    if (!another) {
        throw LastAdmin();
    }
}

void Accounts::set_role(const std::string& name, Role role) {
    const std::scoped_lock change(changing_);
    if (role != Role::Admin) {
        check_stays_admin(name);
    }
    std::optional<User> changed = user(name);
    if (!changed) {
        throw BadAccount("name: there is no user of that name");
    }
    changed->role = role;
    store_.put(*changed);
    const std::scoped_lock lock(mutex_);
    users_.insert_or_assign(name, *changed);
}

void Accounts::set_password(const std::string& name, std::string_view password) {
    check_password(password);
    const std::string hash = hash_password(password);
    const std::scoped_lock change(changing_);
    std::optional<User> changed = user(name);
    if (!changed) {
        throw BadAccount("name: there is no user of that name");
    }
    changed->password_hash = hash;
    store_.put(*changed);
    store_.remove_sessions_of(name);
    const std::scoped_lock lock(mutex_);
    users_.insert_or_assign(name, *changed);
    std::erase_if(sessions_, [&name](const auto& entry) { return entry.second.user == name; });
}

bool Accounts::remove(const std::string& name) {
    const std::scoped_lock change(changing_);
    if (!user(name)) {
        return false;
    }
    check_stays_admin(name);
    store_.remove_user(name);
    const std::scoped_lock lock(mutex_);
    users_.erase(name);
    std::erase_if(keys_, [&name](const auto& entry) { return entry.second.user == name; });
    std::erase_if(sessions_, [&name](const auto& entry) { return entry.second.user == name; });
    return true;
}

std::vector<ApiKey> Accounts::keys() const {
    std::vector<ApiKey> keys;
    {
        const std::scoped_lock lock(mutex_);
        for (const auto& [id, key] : keys_) {
            keys.push_back(key);
        }
    }
    std::sort(keys.begin(), keys.end(), [](const ApiKey& a, const ApiKey& b) {
        return std::tie(a.created_ms, a.id) < std::tie(b.created_ms, b.id);
    });
    return keys;
}

std::pair<ApiKey, NewSecret> Accounts::add_key(const std::string& owner, const KeyWish& wish) {
    constexpr std::size_t kLongestLabel = 100;
    if (wish.label.empty() || wish.label.size() > kLongestLabel) {
        throw BadAccount("label: must have 1 to 100 bytes");
    }
    const std::scoped_lock change(changing_);
    if (!user(owner)) {
        throw BadAccount("user: there is no user of that name");
    }
    const std::int64_t now = wall_clock_ms();
    const std::string secret = new_secret();
    ApiKey key;
    key.id = new_id("");
    key.user = owner;
    key.label = wish.label;
    key.role = wish.role;
    key.may_fire = wish.may_fire;
    key.secret_hash = sha256_of(secret);
    key.created_ms = now;
    key.expires_ms = wish.lifetime_ms > 0 ? now + wish.lifetime_ms : 0;
    store_.put(key);
    const std::scoped_lock lock(mutex_);
    keys_.emplace(key.id, key);
    return {key, {fmt::format("{}{}_{}", kKeyPrefix, key.id, secret), key.expires_ms}};
}

bool Accounts::remove_key(const std::string& id) {
    const std::scoped_lock change(changing_);
    {
        const std::scoped_lock lock(mutex_);
        if (keys_.erase(id) == 0) {
            return false;
        }
    }
    store_.remove_key(id);
    return true;
}

std::string csrf_token_of(std::string_view session_token) {
    return sha256_of(fmt::format("csrf:{}", session_token));
}

}  // namespace leafcutter::server
