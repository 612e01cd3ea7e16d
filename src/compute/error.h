// Exceptions used inside the library; src/api turns them into status codes and messages.
#pragma once

#include <sstream>
#include <stdexcept>
#include <string>

#include "lightwell/lightwell.h"

namespace lightwell {

class Error : public std::runtime_error {
public:
    Error(LWStatus status, const std::string& message) : std::runtime_error(message), status_(status) {}
    LWStatus status() const { return status_; }

private:
    LWStatus status_;
};

// Throws Error with the parts streamed into one message:
// fail(LW_ERROR_INVALID_ARGUMENT, "vpls: expected at most ", limit, ", got ", value).
template <class... Parts>
[[noreturn]] void fail(LWStatus status, const Parts&... parts) {
    std::ostringstream message;
    (message << ... << parts);
    throw Error(status, message.str());
}

// Throws on a failed OpenCL call: out-of-memory codes become LW_ERROR_OUT_OF_MEMORY, the rest
// LW_ERROR_DEVICE; the message carries `call` and the code's name.
void checkCl(int code, const char* call);
const char* clErrorName(int code);

}  // namespace lightwell
