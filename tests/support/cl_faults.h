// OpenCL calls that fail when a test wants them to: this program's own definitions stand before the loader's.
#pragma once

#include <CL/cl.h>

namespace lightwell::test {

// The calls that allocate, build, set arguments or enqueue, counted from here on; number `failing` (from 0) returns
// `code` instead of doing anything. One at a time.
class ClFault {
public:
    ClFault(int failing, cl_int code);
    ~ClFault();
    ClFault(const ClFault&) = delete;
    ClFault& operator=(const ClFault&) = delete;
    bool happened() const;
    const char* function() const;  // that failed; "" before
};

// While it lives, every event asked for its state says that its command failed.
class FailedEvents {
public:
    FailedEvents();
    ~FailedEvents();
    FailedEvents(const FailedEvents&) = delete;
    FailedEvents& operator=(const FailedEvents&) = delete;
};

}  // namespace lightwell::test
