// What a call threw, for CHECK(thrown([&] { ... }) == LW_ERROR_...) and checks of its message.
#pragma once

#include <ostream>
#include <string>

#include "compute/error.h"

namespace lightwell::test {

struct Thrown {
    LWStatus status = LW_SUCCESS;
    std::string message;
    bool says(const std::string& part) const { return message.find(part) != std::string::npos; }
};

inline std::ostream& operator<<(std::ostream& stream, const Thrown& thrown) {
    return stream << "status " << int(thrown.status) << ": " << thrown.message;
}

// The Error of `call`, or LW_SUCCESS when it threw none.
template <class Call>
Thrown thrown(Call call) {
    try {
        call();
    } catch (const Error& error) {
        return {error.status(), error.what()};
    }
    return {};
}

}  // namespace lightwell::test
