// The typed exceptions of the pure core (geometry and fab).
//
// Every message names what is wrong, where (line, vertex, face, edge) and what to do about it.
// `code` is a stable short identifier for programs ("non-manifold-edges"), `what()` is for people.

#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace leafcutter::geometry {

enum class ErrorKind {
    BadFile,       // The bytes are no mesh of the format they claim to be.
    BadMesh,       // A mesh, but no surface we can weave: non-manifold, not orientable, zero area.
    BadOption,     // An option is out of range; the message starts with its full path.
    NotSupported,  // Understood and refused: not built yet.
    SelfCheck,     // A stage's own result failed its check; the message names the stage.
};

class Error : public std::runtime_error {
public:
    Error(ErrorKind kind, std::string code, const std::string& message)
        : std::runtime_error(message), kind_(kind), code_(std::move(code)) {}

    ErrorKind kind() const { return kind_; }
    const std::string& code() const { return code_; }

private:
    ErrorKind kind_;
    std::string code_;
};

// Thrown by Context::check() after a stop request.
class Cancelled : public std::exception {
public:
    const char* what() const noexcept override { return "cancelled"; }
};

}  // namespace leafcutter::geometry
