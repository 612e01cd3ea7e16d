// Commands on their way: which have ended, and whether one of them failed.
#pragma once

#include <cstdint>
#include <deque>
#include <string>

#include "compute/cl.h"

namespace lightwell {

// Events of commands that run one after the other, as all of a device's do (an out-of-order queue gets a
// barrier after each). So only the oldest has to be asked: adding an event costs O(1) queries in the mean,
// however many are pending.
class EventWatch {
public:
    EventWatch() = default;
    ~EventWatch() { clear(); }
    EventWatch(const EventWatch&) = delete;
    EventWatch& operator=(const EventWatch&) = delete;

    void add(cl_event event);  // keeps a reference
    // Drops the events that have ended, up to the first that has not, and notes the first failure.
    void collect();
    // Drops all; those that have not ended are forgotten.
    void clear();

    std::size_t pending() const { return events_.size(); }  // not yet seen to have ended
    const std::string& failure() const { return failure_; }  // empty: none
    void noteFailure(const char* name);
    std::string takeFailure();
    std::uint64_t failures() const { return failures_; }  // noted since creation
    std::uint64_t queries() const { return queries_; }  // of events' states, since creation

private:
    std::deque<cl_event> events_;
    std::string failure_;
    std::uint64_t failures_ = 0, queries_ = 0;
};

}  // namespace lightwell
