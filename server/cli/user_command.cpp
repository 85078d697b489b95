// leafcutter user: accounts, made and changed in the state folder of a daemon that doesn't run.
// Whoever can write that folder is its owner: no password is asked for.

#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <termios.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "server/auth/accounts.h"
#include "server/cli/command.h"
#include "server/config.h"
#include "server/store/account_store.h"
#include "server/store/ids.h"
#include "server/store/state_dir.h"
#include "server/store/store.h"

namespace leafcutter::server {

namespace {

struct UserOptions {
    std::string state;
    std::string store;
    std::string name;
    std::string role = "admin";
    std::string key_role = "submitter";
    std::string label = "command line";
    bool may_fire = false;
};

// Not shown while it is typed.
class SilentTerminal {
public:
    SilentTerminal() {
        if (::tcgetattr(STDIN_FILENO, &before_) == 0) {
            termios silent = before_;
            silent.c_lflag &= ~static_cast<tcflag_t>(ECHO);
            changed_ = ::tcsetattr(STDIN_FILENO, TCSANOW, &silent) == 0;
        }
    }
    ~SilentTerminal() {
        if (changed_) {
            ::tcsetattr(STDIN_FILENO, TCSANOW, &before_);
        }
    }
    SilentTerminal(const SilentTerminal&) = delete;
    SilentTerminal& operator=(const SilentTerminal&) = delete;

private:
    termios before_{};
    bool changed_ = false;
};

// The first line of the standard input.
std::string asked_password() {
    const bool terminal = ::isatty(STDIN_FILENO) == 1;
    if (terminal) {
        std::fputs("password: ", stderr);
    }
    std::string password;
    {
        const SilentTerminal silent;
        std::getline(std::cin, password);
    }
    if (terminal) {
        std::fputs("\n", stderr);
    }
    return password;
}

Role wanted_role(const std::string& name) {
    const auto role = role_named(name);
    if (!role) {
        throw UsageError("--role: must be viewer, submitter, operator or admin");
    }
    return *role;
}

template <typename Act>
void with_accounts(const UserOptions& options, Act act) {
    const StateDir folder(options.state.empty() ? default_state_dir()
                                                : std::filesystem::path(options.state));
    StoreChoice choice;
    choice.uri = options.store;
    const OpenedEngine opened = open_engine(folder.path(), nullptr, choice);
    AccountStore& store = opened.engine->accounts();
    Accounts accounts(store);
    try {
        act(accounts, store);
    } catch (const BadAccount& error) {
        throw UsageError(error.what());
    } catch (const LastAdmin& error) {
        throw UsageError(error.what());
    }
}

void note(AccountStore& store, const std::string& action) {
    const AuditRecord record{
        0, wall_clock_ms(), "", "", fmt::format("leafcutter user {}", action), "", 0};
    store.append({&record, 1});
}

void add_user(const UserOptions& options) {
    const Role role = wanted_role(options.role);
    const std::string password = asked_password();
    with_accounts(options, [&](Accounts& accounts, AccountStore& store) {
        accounts.add(options.name, role, password);
        note(store, fmt::format("add {} --role {}", options.name, options.role));
    });
}

void set_password(const UserOptions& options) {
    const std::string password = asked_password();
    with_accounts(options, [&](Accounts& accounts, AccountStore& store) {
        accounts.set_password(options.name, password);
        note(store, fmt::format("password {}", options.name));
    });
}

void remove_user(const UserOptions& options) {
    with_accounts(options, [&](Accounts& accounts, AccountStore& store) {
        if (!accounts.remove(options.name)) {
            throw UsageError(fmt::format("there is no user {}", options.name));
        }
        note(store, fmt::format("remove {}", options.name));
    });
}

void list_users(const UserOptions& options) {
    with_accounts(options, [](Accounts& accounts, AccountStore&) {
        for (const User& user : accounts.users()) {
            std::printf("%-24s %s\n", user.name.c_str(), std::string(to_string(user.role)).c_str());
        }
    });
}

void add_key(const UserOptions& options) {
    const KeyWish wish{options.label, wanted_role(options.key_role), options.may_fire, 0};
    with_accounts(options, [&](Accounts& accounts, AccountStore& store) {
        const auto [key, secret] = accounts.add_key(options.name, wish);
        note(store, fmt::format("key {} --role {}", options.name, options.key_role));
        std::printf("%s\n", secret.secret.c_str());
    });
}

}  // namespace

void add_user_command(CLI::App& app, const CommonOptions&) {
    CLI::App* command =
        app.add_subcommand("user", "Accounts of a daemon that doesn't run just now");
    command->require_subcommand(1);
    const auto options = std::make_shared<UserOptions>();  // Shared with the callbacks.
    command->add_option("--state", options->state, "Folder of the database and the files");
    command->add_option("--store", options->store, "postgresql://… of a fleet, in its place")
        ->envname("LEAFCUTTER_STORE");
    const auto add = [&](const char* verb, const char* help, void (*act)(const UserOptions&)) {
        CLI::App* sub = command->add_subcommand(verb, help);
        sub->callback([options, act] { act(*options); });
        return sub;
    };
    CLI::App* added = add("add", "Adds a user; the password is read from standard input", add_user);
    added->add_option("name", options->name)->required();
    added->add_option("--role", options->role,
                      "viewer, submitter, operator or admin (if not given)");
    CLI::App* password = add("password", "Sets a user's password", set_password);
    password->add_option("name", options->name)->required();
    CLI::App* removed = add("remove", "Removes a user with all keys", remove_user);
    removed->add_option("name", options->name)->required();
    add("list", "Lists the users", list_users);
    CLI::App* key = add("key", "Makes an API key and prints it, this once", add_key);
    key->add_option("name", options->name, "Its user")->required();
    key->add_option("--role", options->key_role, "The most it may do; submitter if not given");
    key->add_option("--label", options->label, "What it is for");
    key->add_flag("--may-fire", options->may_fire, "It may start cuts, as an operator");
}

}  // namespace leafcutter::server
