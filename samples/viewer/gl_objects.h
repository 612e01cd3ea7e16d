// OpenGL objects that are deleted with their owners. All belong to the context that was current when they were made.
#pragma once

#include <epoxy/gl.h>

#include <cstddef>
#include <glm/glm.hpp>
#include <initializer_list>
#include <string>
#include <utility>

namespace viewer {

// A name that `remove` deletes; moved, never copied.
template <void (*remove)(GLuint)>
class GlName {
public:
    GlName() = default;
    explicit GlName(GLuint name) : name_(name) {}
    GlName(GlName&& other) noexcept : name_(std::exchange(other.name_, 0u)) {}
    GlName& operator=(GlName&& other) noexcept {
        std::swap(name_, other.name_);
        return *this;
    }
    ~GlName() {
        if (name_ != 0) remove(name_);
    }
    GLuint get() const { return name_; }

private:
    GLuint name_ = 0;
};

void removeTexture(GLuint name);
void removeBuffer(GLuint name);
void removeFramebuffer(GLuint name);
void removeVertexArray(GLuint name);
void removeProgram(GLuint name);

using Buffer = GlName<removeBuffer>;
using VertexArray = GlName<removeVertexArray>;
Buffer makeBuffer();
VertexArray makeVertexArray();

// How pixels of a texture lie in host memory, beside how the driver keeps them.
struct PixelFormat {
    GLint internal;
    GLenum format, type;
    int byteCount;  // of a pixel in host memory
};

// A 2D texture of one level, or an array of `layers` of them; nearest look-ups, clamped, until told otherwise.
class Texture {
public:
    Texture() = default;
    Texture(const PixelFormat& format, int width, int height, int layers = 0);
    GLuint get() const { return name_.get(); }
    GLenum target() const { return layers_ > 0 ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D; }
    int width() const { return width_; }
    int height() const { return height_; }
    int layers() const { return layers_; }
    const PixelFormat& format() const { return format_; }
    void bind(int unit) const;

private:
    GlName<removeTexture> name_;
    PixelFormat format_{};
    int width_ = 0, height_ = 0, layers_ = 0;
};

class Framebuffer {
public:
    Framebuffer() = default;
    // Colour attachments in order, then depth (null: none). std::runtime_error where the driver can't draw into them.
    Framebuffer(std::initializer_list<const Texture*> colours, const Texture* depth, int depthLayer = 0);
    GLuint get() const { return name_.get(); }
    void bind(int width, int height) const;  // and its whole area as viewport

private:
    GlName<removeFramebuffer> name_;
};

class Program {
public:
    Program() = default;
    // `name` for errors: std::runtime_error with the compiler's log.
    Program(const std::string& name, const std::string& vertex, const std::string& fragment);
    void use() const;
    // Of the program in use; a name that the compiler has removed is ignored.
    void set(const char* name, int value) const;
    void set(const char* name, float value) const;
    void set(const char* name, const glm::vec2& value) const;
    void set(const char* name, const glm::vec3& value) const;
    void set(const char* name, const glm::vec4& value) const;
    void set(const char* name, const glm::mat4& value) const;
    void set(const char* name, int unit, const Texture& texture) const;  // binds it there

private:
    GLint at(const char* name) const;
    GlName<removeProgram> name_;
};

// Nearest surfaces win between construction and destruction, the bound framebuffer's depth cleared. Depth falls from 1 at the
// near plane to 0 at the far one, where floats lie densest, with GL_ARB_clip_control (OpenGL 4.5's), which most drivers of 3.3 have.
class DepthTest {
public:
    DepthTest();
    ~DepthTest();
    DepthTest(const DepthTest&) = delete;
    DepthTest& operator=(const DepthTest&) = delete;
    static bool isReversed();
};

// One triangle that covers the viewport; the vertex shader of all passes over whole images.
extern const char* const kWholeImageVertex;
void drawWholeImage();

}  // namespace viewer
