// The way between OpenGL's images and Lightwell's: pixel buffers that the driver copies images into, or out of, and
// whose memory Lightwell then uses, through its address or, where the device shares it, as cl_mem. One copy each way, none in
// the program itself.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "gl_objects.h"
#include "gl_sharing.h"
#include "lightwell/lightwell.h"

namespace viewer {

// Rows of 16 pixels or a multiple, planes 64 bytes apart or a multiple: what Lightwell uses in place.
int paddedWidth(int width);

// Reads images back. Between map() and unmap() the images described are Lightwell's to read.
class ReadBack {
public:
    ReadBack() : buffer_(makeBuffer()) {}
    void share(const std::shared_ptr<GlSharing>& sharing) { sharing_ = sharing; }  // before the first read(); null: host memory
    void begin() { planes_.clear(), byteCount_ = 0; }
    // What image() will describe: asked for in order, numbered from 0.
    std::size_t add(const Texture& texture, LWFormat format);
    void read();  // enqueues the copies
    void map();   // waits for them
    void unmap();
    LWImage image(std::size_t index) const;
    std::uint64_t byteCount() const { return byteCount_; }

private:
    struct Plane {
        const Texture* texture;
        LWFormat format;
        std::size_t byteOffset;
    };
    Buffer buffer_;
    std::shared_ptr<GlSharing> sharing_;
    std::optional<SharedBuffer> shared_;
    std::vector<Plane> planes_;
    std::size_t byteCount_ = 0, allocated_ = 0;
    const char* memory_ = nullptr;
};

// What Lightwell writes: three planes of irradiance (W/m^2) and one of validity, as layers of one texture.
class IndirectImages {
public:
    IndirectImages() : buffer_(makeBuffer()) {}
    void share(const std::shared_ptr<GlSharing>& sharing) { sharing_ = sharing; }  // before resize(); null: host memory
    void resize(int width, int height);
    void map();
    LWImage irradiance() const;
    LWImage validity() const;
    void unmap();
    void upload();  // enqueues the copy into the texture
    const Texture& texture() const { return texture_; }
    std::uint64_t byteCount() const { return 4 * planeBytes(); }

private:
    std::size_t planeBytes() const;
    void place(LWImage& image, std::size_t byteOffset) const;
    Buffer buffer_;
    std::shared_ptr<GlSharing> sharing_;
    std::optional<SharedBuffer> shared_;
    Texture texture_;
    char* memory_ = nullptr;
};

}  // namespace viewer
