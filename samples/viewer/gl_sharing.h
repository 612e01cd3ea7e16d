// OpenGL's buffers as OpenCL's memory, without a way through host memory: cl_khr_gl_sharing, where both sides offer it.
#pragma once

#include <memory>
#include <string>

#include "lightwell/lightwell.h"

namespace viewer {

// A context of OpenCL that shares with the OpenGL context that was current when it was made, and its queue.
class GlSharing {
public:
    // On the first OpenCL device described so. Null where nothing can be shared, or shall not; `reason` says why.
    static std::shared_ptr<GlSharing> open(const LWDeviceInfo& device, bool wantsCopies, std::string& reason);
    ~GlSharing();
    GlSharing(const GlSharing&) = delete;
    GlSharing& operator=(const GlSharing&) = delete;
    void* context() const { return context_; }  // cl_context
    void* queue() const { return queue_; }      // cl_command_queue, in order

private:
    GlSharing(void* context, void* queue) : context_(context), queue_(queue) {}
    void *context_, *queue_;
};

// A buffer object of OpenGL's; it must keep its storage meanwhile.
class SharedBuffer {
public:
    SharedBuffer(std::shared_ptr<GlSharing> sharing, unsigned buffer, bool isWritten);  // std::runtime_error
    ~SharedBuffer();
    SharedBuffer(const SharedBuffer&) = delete;
    SharedBuffer& operator=(const SharedBuffer&) = delete;
    void* memory() const { return memory_; }  // cl_mem
    // Between these the memory is OpenCL's. Each waits for the other side. std::runtime_error, also for a release that failed.
    void acquire();
    void release() noexcept;

private:
    std::shared_ptr<GlSharing> sharing_;
    void* memory_ = nullptr;
    int releaseStatus_ = 0;
    bool isAcquired_ = false;
};

}  // namespace viewer
