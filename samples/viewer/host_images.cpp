#include "host_images.h"

#include <stdexcept>

namespace viewer {
namespace {

constexpr int kRowPixels = 16;
constexpr std::size_t kPlaneAlignment = 64;

void* mapBuffer(GLenum target, std::size_t byteCount, GLbitfield access) {
    void* memory = glMapBufferRange(target, 0, GLsizeiptr(byteCount), access);
    if (memory == nullptr) throw std::runtime_error("OpenGL could not map a pixel buffer: out of memory?");
    return memory;
}

void unmapBuffer(GLenum target, const Buffer& buffer) {
    glBindBuffer(target, buffer.get());
    glUnmapBuffer(target);
    glBindBuffer(target, 0);
}

}  // namespace

int paddedWidth(int width) {
    return (width + kRowPixels - 1) / kRowPixels * kRowPixels;
}

std::size_t ReadBack::add(const Texture& texture, LWFormat format) {
    const std::size_t bytes = std::size_t(paddedWidth(texture.width())) * std::size_t(texture.height()) * std::size_t(texture.format().byteCount);
    planes_.push_back({&texture, format, byteCount_});
    byteCount_ += (bytes + kPlaneAlignment - 1) / kPlaneAlignment * kPlaneAlignment;
    return planes_.size() - 1;
}

void ReadBack::read() {
    glBindBuffer(GL_PIXEL_PACK_BUFFER, buffer_.get());
    if (allocated_ != byteCount_) {
        shared_.reset();  // of the storage that goes
        glBufferData(GL_PIXEL_PACK_BUFFER, GLsizeiptr(byteCount_), nullptr, sharing_ ? GL_STREAM_COPY : GL_STREAM_READ);
        allocated_ = byteCount_;
        if (sharing_ && byteCount_ > 0) shared_.emplace(sharing_, buffer_.get(), false);
    }
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    for (const Plane& plane : planes_) {
        const Texture& texture = *plane.texture;
        glPixelStorei(GL_PACK_ROW_LENGTH, paddedWidth(texture.width()));
        texture.bind(0);
        glGetTexImage(texture.target(), 0, texture.format().format, texture.format().type, reinterpret_cast<void*>(plane.byteOffset));
    }
    glPixelStorei(GL_PACK_ROW_LENGTH, 0);
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
}

void ReadBack::map() {
    if (byteCount_ == 0) return;  // a scene without lights has no maps
    if (shared_) return shared_->acquire();
    glBindBuffer(GL_PIXEL_PACK_BUFFER, buffer_.get());
    memory_ = static_cast<const char*>(mapBuffer(GL_PIXEL_PACK_BUFFER, byteCount_, GL_MAP_READ_BIT));
    glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
}

void ReadBack::unmap() {
    if (shared_) shared_->release();
    if (memory_ != nullptr) unmapBuffer(GL_PIXEL_PACK_BUFFER, buffer_);
    memory_ = nullptr;
}

LWImage ReadBack::image(std::size_t index) const {
    const Plane& plane = planes_.at(index);
    LWImage image{};
    if (shared_) {
        image.clMem = shared_->memory();
        image.byteOffset = plane.byteOffset;
    } else {
        image.host = memory_ + plane.byteOffset;
    }
    image.format = plane.format;
    image.width = std::uint32_t(plane.texture->width());
    image.height = std::uint32_t(plane.texture->height());
    image.byteRowStride = std::int64_t(paddedWidth(plane.texture->width())) * plane.texture->format().byteCount;
    return image;
}

void IndirectImages::resize(int width, int height) {
    texture_ = Texture({GL_R32F, GL_RED, GL_FLOAT, 4}, width, height, 4);
    shared_.reset();
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer_.get());
    const std::vector<char> zeros(byteCount());
    glBufferData(GL_PIXEL_UNPACK_BUFFER, GLsizeiptr(zeros.size()), zeros.data(), sharing_ ? GL_STREAM_COPY : GL_STREAM_DRAW);
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
    if (sharing_) shared_.emplace(sharing_, buffer_.get(), true);
}

std::size_t IndirectImages::planeBytes() const {
    return std::size_t(paddedWidth(texture_.width())) * std::size_t(texture_.height()) * sizeof(float);
}

void IndirectImages::map() {
    if (shared_) return shared_->acquire();
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer_.get());
    // Reading too: memory that is written only may be slow to touch in any other way.
    memory_ = static_cast<char*>(mapBuffer(GL_PIXEL_UNPACK_BUFFER, byteCount(), GL_MAP_READ_BIT | GL_MAP_WRITE_BIT));
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
}

void IndirectImages::place(LWImage& image, std::size_t byteOffset) const {
    if (shared_) {
        image.clMem = shared_->memory();
        image.byteOffset = byteOffset;
    } else {
        image.host = memory_ + byteOffset;
    }
}

LWImage IndirectImages::irradiance() const {
    LWImage image{};
    place(image, 0);
    image.format = LW_FORMAT_PLANAR_FLOAT3;
    image.width = std::uint32_t(texture_.width());
    image.height = std::uint32_t(texture_.height());
    image.byteRowStride = std::int64_t(paddedWidth(texture_.width())) * std::int64_t(sizeof(float));
    image.bytePlaneStride = std::int64_t(planeBytes());
    return image;
}

LWImage IndirectImages::validity() const {
    LWImage image = irradiance();
    place(image, 3 * planeBytes());
    image.format = LW_FORMAT_FLOAT1;
    image.bytePlaneStride = 0;
    return image;
}

void IndirectImages::unmap() {
    if (shared_) shared_->release();
    if (memory_ != nullptr) unmapBuffer(GL_PIXEL_UNPACK_BUFFER, buffer_);
    memory_ = nullptr;
}

void IndirectImages::upload() {
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer_.get());
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, paddedWidth(texture_.width()));
    texture_.bind(0);
    glTexSubImage3D(GL_TEXTURE_2D_ARRAY, 0, 0, 0, 0, texture_.width(), texture_.height(), 4, GL_RED, GL_FLOAT, nullptr);
    glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
    glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
}

}  // namespace viewer
