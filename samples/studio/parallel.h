// Parallel loop over independent items: rows of an image, tiles of a path tracer.
// Items are handed out in order as threads become free: a body that writes only what belongs to its
// item gives the same result whatever the number of threads.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace studio {

// Threads to use for a request; 0 asks for one per hardware thread.
inline int threadCount(int requested) {
    if (requested > 0) return requested;
    const unsigned hardware = std::thread::hardware_concurrency();
    return hardware > 0 ? int(hardware) : 1;
}

// Calls body(item) once for each item in [0, count). The calling thread works too and, after each of its
// own items, calls `onProgress` with the number of items begun so far. The first exception of any thread
// stops the hand-out and is rethrown here once all threads have left.
template <class Body>
void parallelFor(std::size_t count, int threads, const Body& body,
                 const std::function<void(std::size_t)>& onProgress = {}) {
    std::atomic<std::size_t> next{0};
    std::exception_ptr failure;
    std::mutex failureLock;

    const auto work = [&](bool reports) {
        try {
            for (std::size_t item = next++; item < count; item = next++) {
                body(item);
                if (reports && onProgress) onProgress(item + 1);
            }
        } catch (...) {
            next = count;
            const std::lock_guard<std::mutex> guard(failureLock);
            if (!failure) failure = std::current_exception();
        }
    };

    std::vector<std::thread> helpers;
    for (int i = 1; i < threadCount(threads); ++i) helpers.emplace_back(work, false);
    work(true);
    for (std::thread& helper : helpers) helper.join();
    if (failure) std::rethrow_exception(failure);
}

// Calls body(row) for each row in [0, rows), on all hardware threads.
template <class Body>
void parallelRows(int rows, const Body& body) {
    parallelFor(std::size_t(rows), 0, [&](std::size_t row) { body(int(row)); });
}

}  // namespace studio
