#include "worker_pool.h"

#if defined(__SSE3__) || defined(__x86_64__)
#include <pmmintrin.h>
#endif

#include "parallel.h"

namespace studio {
namespace {

// Denormals as zero, while it lives: Embree asks for it, and sums of tiny weights stay fast.
class FlushDenormals {
public:
#if defined(__x86_64__)
    FlushDenormals() : before_(_mm_getcsr()) {
        _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
        _mm_setcsr(_mm_getcsr() | 0x0040u);  // denormals are zero
    }
    ~FlushDenormals() {
        _mm_setcsr(before_);
    }

private:
    unsigned before_;
#endif
};

}  // namespace

WorkerPool::WorkerPool(int threads) {
    for (int i = 1; i < threadCount(threads); ++i) helpers_.emplace_back([this, i] { help(i); });
}

WorkerPool::~WorkerPool() {
    {
        const std::lock_guard<std::mutex> guard(lock_);
        leaves_ = true;
    }
    begin_.notify_all();
    for (std::thread& helper : helpers_) helper.join();
}

void WorkerPool::work(int thread) {
    const FlushDenormals flush;
    try {
        for (std::size_t item = next_++; item < count_; item = next_++) (*body_)(item, thread);
    } catch (...) {
        next_ = count_;
        const std::lock_guard<std::mutex> guard(lock_);
        if (!failure_) failure_ = std::current_exception();
    }
}

void WorkerPool::help(int thread) {
    std::size_t seen = 0;
    for (;;) {
        {
            std::unique_lock<std::mutex> guard(lock_);
            begin_.wait(guard, [&] { return leaves_ || round_ != seen; });
            if (leaves_) return;
            seen = round_;
        }
        work(thread);
        const std::lock_guard<std::mutex> guard(lock_);
        if (--busy_ == 0) end_.notify_one();
    }
}

void WorkerPool::run(std::size_t count, const std::function<void(std::size_t, int)>& body) {
    {
        const std::lock_guard<std::mutex> guard(lock_);
        body_ = &body;
        count_ = count;
        next_ = 0;
        busy_ = int(helpers_.size());
        failure_ = nullptr;
        ++round_;
    }
    begin_.notify_all();
    work(0);
    std::unique_lock<std::mutex> guard(lock_);
    end_.wait(guard, [&] { return busy_ == 0; });
    if (failure_) std::rethrow_exception(failure_);
}

}  // namespace studio
