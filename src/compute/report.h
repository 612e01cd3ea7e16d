// What happened in the frames since update(): counts and choices for LWStats.
#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <string>
#include <vector>

#include "compute/buffer.h"
#include "compute/cl.h"
#include "lightwell/lightwell.h"

namespace lightwell {

// Filled in two steps, so that nobody waits under a lock: a technique notes what it knows and has the rest
// read without waiting; after the wait, resolve() puts in what was read. Names and reasons are string literals,
// but for chooseText's and those of a part's report, which the report keeps.
class Report {
public:
    Report() = default;
    ~Report();  // waits for what is still being read
    Report(Report&&) = default;
    Report& operator=(Report&&) = default;

    std::vector<LWCount> counts;
    std::vector<LWChoice> choices;

    // Adds the 32-bit count that `buffer` holds at `byteOffset`, as it stands when the commands enqueued so far
    // have run, to the count of this name.
    void read(Device& device, const char* name, const Buffer& buffer, std::size_t byteOffset);
    // Adds a choice whose reason is the one of `reasons` (`reasonCount` string literals) that the 32-bit
    // number there names; none where it names none.
    void readChoice(Device& device, const char* name, const Buffer& buffer, std::size_t byteOffset,
                    const char* const* reasons, std::uint32_t reasonCount);
    // Adds a choice, unless the same was made before (for another view).
    void choose(const char* name, const char* reason);
    // ... whose reason is made for this report, which keeps it.
    void chooseText(const char* name, std::string reason);
    // Takes over another's, each name as "part.name": of a technique that is part of another.
    void add(const std::string& part, Report other);
    // After the queue has got past the reads.
    void resolve();

private:
    struct Pending {
        std::size_t count;  // index in counts
        std::unique_ptr<cl_uint> value;
    };
    struct PendingChoice {
        const char* name;
        const char* const* reasons;
        std::uint32_t reasonCount;
        std::unique_ptr<cl_uint> value;
    };
    void enqueueRead(Device& device, const Buffer& buffer, std::size_t byteOffset, cl_uint* value);
    std::size_t indexOf(const char* name);
    const char* keep(std::string name);

    std::vector<Pending> pending_;
    std::vector<PendingChoice> pendingChoices_;
    std::list<std::string> names_;  // stay where they are when the report moves
    Device* device_ = nullptr;  // set while something is pending
};

}  // namespace lightwell
