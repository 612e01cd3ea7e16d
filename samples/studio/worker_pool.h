// Threads that wait for work between frames, so that a frame of a few milliseconds does not pay for
// starting them.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace studio {

class WorkerPool {
public:
    explicit WorkerPool(int threads = 0);  // 0: one per hardware thread, the caller's among them
    ~WorkerPool();
    WorkerPool(const WorkerPool&) = delete;
    WorkerPool& operator=(const WorkerPool&) = delete;

    int threads() const { return int(helpers_.size()) + 1; }
    // Calls body(item, thread) once for each item in [0, count), handed out in order; thread <
    // threads(). The calling thread works too. The first exception ends the hand-out and comes out here.
    void run(std::size_t count, const std::function<void(std::size_t, int)>& body);

private:
    void help(int thread);
    void work(int thread);

    std::vector<std::thread> helpers_;
    std::mutex lock_;
    std::condition_variable begin_, end_;
    const std::function<void(std::size_t, int)>* body_ = nullptr;
    std::atomic<std::size_t> next_{0};
    std::size_t count_ = 0, round_ = 0;
    int busy_ = 0;
    bool leaves_ = false;
    std::exception_ptr failure_;
};

}  // namespace studio
