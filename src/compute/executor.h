// Enqueues the kernels of a frame on the device's queue, in order, and times them as passes.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "compute/buffer.h"
#include "compute/cl.h"
#include "compute/program.h"
#include "lightwell/lightwell.h"

namespace lightwell {

class Device;

// Device times of named passes. One per technique; update() starts a new frame.
class Profile {
public:
    Profile() = default;
    ~Profile();
    Profile(const Profile&) = delete;
    Profile& operator=(const Profile&) = delete;

    void clear();
    void add(const char* pass, cl_event event);  // takes the event over; null: counted, not timed
    // Waits for nothing: call after Device::finish. `names` are string literals.
    std::vector<LWPassTime> passes() const;
    double totalMilliseconds() const;
    std::unique_ptr<Profile> snapshot() const;  // what it holds now, for a report after a wait
    std::size_t heldEntries() const { return entries_.size(); }
    // The events of an entry that it holds and of its last one, each with a reference for the caller; null where there is none.
    void retainEnds(std::size_t firstEntry, cl_event& first, cl_event& last) const;

private:
    struct Entry {
        const char* pass;
        cl_event event;
    };
    // Times summed by pass, and the span of them all in nanoseconds.
    struct Sums {
        std::vector<LWPassTime> passes;
        cl_ulong first = ~cl_ulong(0), last = 0;
        bool untimed = false;
        void add(const Entry& entry);
    };
    void fold();
    Sums sums() const;

    Sums folded_;  // of commands that have completed and whose events are let go
    std::vector<Entry> entries_;
};

using Range = std::array<std::size_t, 2>;
// Where the origin of a frame's positions lies in the host's world (LWFrame::worldOrigin).
using WorldOrigin = std::array<double, 3>;

class Executor {
public:
    Executor(Device& device, Profile& profile) : device_(device), profile_(profile) {}

    Device& device() { return device_; }
    const Profile& profile() const { return profile_; }
    // All positions that are recorded are relative to this.
    const WorldOrigin& worldOrigin() const { return worldOrigin_; }
    void setWorldOrigin(const WorldOrigin& origin) { worldOrigin_ = origin; }

    // Enqueues `kernel` over `global` work-items, rounded up to `local` (the kernel must leave surplus
    // items idle). `pass` is a string literal "<pass>.<verb>". Arguments in the kernel's order: cl_mem,
    // Buffer, Planes (two arguments: memory and int4 layout), arithmetic values, shared structs.
    template <class... Args>
    void run(const char* pass, Kernel& kernel, Range global, Range local, const Args&... args) {
        cl_uint index = 0;
        (setArg(kernel, index, args), ...);
        enqueue(pass, kernel, global, local, index);
    }

    // Non-blocking transfers, timed as passes too. Host memory must stay valid until they are done.
    void write(const char* pass, const Buffer& to, std::size_t byteOffset, std::size_t bytes,
               const void* from);
    // The same of memory that is read before the call returns: a copy of it waits for the command.
    void writeCopy(const char* pass, const Buffer& to, std::size_t byteOffset, std::size_t bytes, const void* from);
    void read(const char* pass, cl_mem from, std::size_t byteOffset, std::size_t bytes, void* to);
    void fill(const char* pass, const Buffer& buffer, std::uint32_t pattern, std::size_t byteOffset,
              std::size_t bytes);
    void copy(const char* pass, cl_mem from, cl_mem to, std::size_t fromOffset, std::size_t toOffset,
              std::size_t bytes);
    // Makes what kernels wrote to a Buffer::overHost visible to the host (map and unmap), non-blocking.
    void publish(const char* pass, const Buffer& buffer);

    // Commands enqueued from here on start after the host's events (which must live until the first of
    // them). Nothing is enqueued yet: a call that is refused leaves no wait behind in the queue.
    void waitFor(const LWSync* sync);
    void forgetWaits() { waits_.clear(); }
    void signal(const LWSync* sync);   // gives the host an event of everything enqueued so far
    void flush();
    std::uint64_t copiedBytes() const { return copiedBytes_; }  // between host and device

private:
    void setRaw(Kernel& kernel, cl_uint& index, std::size_t bytes, const void* value);
    void setArg(Kernel& kernel, cl_uint& index, cl_mem memory) {
        setRaw(kernel, index, sizeof memory, &memory);
    }
    void setArg(Kernel& kernel, cl_uint& index, const Buffer& buffer) {
        setArg(kernel, index, buffer.get());
    }
    void setArg(Kernel& kernel, cl_uint& index, const Planes& planes);
    template <class T,
              class = std::enable_if_t<std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>>>
    void setArg(Kernel& kernel, cl_uint& index, const T& value) {
        setRaw(kernel, index, sizeof value, &value);
    }
    void enqueue(const char* pass, Kernel& kernel, Range global, Range local, cl_uint argumentCount);
    void startWaits();  // before every command
    void done(const char* pass, cl_event event);  // takes the event; a barrier on an out-of-order queue

    Device& device_;
    Profile& profile_;
    std::vector<cl_event> waits_;
    std::uint64_t copiedBytes_ = 0;
    WorldOrigin worldOrigin_{};
};

}  // namespace lightwell
