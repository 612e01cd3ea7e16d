#include "gl_objects.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

namespace viewer {
namespace {

GLuint compileShader(const std::string& name, GLenum kind, const std::string& source) {
    const GLuint shader = glCreateShader(kind);
    const char* text = source.c_str();
    glShaderSource(shader, 1, &text, nullptr);
    glCompileShader(shader);
    GLint isCompiled = 0, length = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &isCompiled);
    if (isCompiled == GL_TRUE) return shader;
    glGetShaderiv(shader, GL_INFO_LOG_LENGTH, &length);
    std::vector<char> log(std::size_t(length) + 1);
    glGetShaderInfoLog(shader, length, nullptr, log.data());
    glDeleteShader(shader);
    throw std::runtime_error(
        fmt::format("{} shader of {}: {}", kind == GL_VERTEX_SHADER ? "vertex" : "fragment", name, log.data()));
}

}  // namespace

void removeTexture(GLuint name) {
    glDeleteTextures(1, &name);
}
void removeBuffer(GLuint name) {
    glDeleteBuffers(1, &name);
}
void removeFramebuffer(GLuint name) {
    glDeleteFramebuffers(1, &name);
}
void removeVertexArray(GLuint name) {
    glDeleteVertexArrays(1, &name);
}
void removeProgram(GLuint name) {
    glDeleteProgram(name);
}

Buffer makeBuffer() {
    GLuint name = 0;
    glGenBuffers(1, &name);
    return Buffer(name);
}

VertexArray makeVertexArray() {
    GLuint name = 0;
    glGenVertexArrays(1, &name);
    return VertexArray(name);
}

Texture::Texture(const PixelFormat& format, int width, int height, int layers)
    : format_(format), width_(width), height_(height), layers_(layers) {
    GLuint name = 0;
    glGenTextures(1, &name);
    name_ = GlName<removeTexture>(name);
    glBindTexture(target(), name);
    if (layers > 0)
        glTexImage3D(target(), 0, format.internal, width, height, layers, 0, format.format, format.type, nullptr);
    else
        glTexImage2D(target(), 0, format.internal, width, height, 0, format.format, format.type, nullptr);
    glTexParameteri(target(), GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(target(), GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexParameteri(target(), GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    glTexParameteri(target(), GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    const GLenum error = glGetError();
    if (error == GL_OUT_OF_MEMORY) throw std::runtime_error(fmt::format("OpenGL has no memory for an image of {}x{}", width, height));
    if (error == GL_INVALID_VALUE)
        throw std::runtime_error(fmt::format("this OpenGL driver has no images of {}x{} in {} layers", width, height, std::max(1, layers)));
}

void Texture::bind(int unit) const {
    glActiveTexture(GLenum(GL_TEXTURE0 + unit));
    glBindTexture(target(), get());
}

Framebuffer::Framebuffer(std::initializer_list<const Texture*> colours, const Texture* depth, int depthLayer) {
    GLuint name = 0;
    glGenFramebuffers(1, &name);
    name_ = GlName<removeFramebuffer>(name);
    glBindFramebuffer(GL_FRAMEBUFFER, name);
    std::vector<GLenum> targets;
    for (const Texture* colour : colours) {
        targets.push_back(GLenum(GL_COLOR_ATTACHMENT0 + targets.size()));
        glFramebufferTexture2D(GL_FRAMEBUFFER, targets.back(), GL_TEXTURE_2D, colour->get(), 0);
    }
    if (depth != nullptr && depth->layers() > 0)
        glFramebufferTextureLayer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, depth->get(), 0, depthLayer);
    else if (depth != nullptr)
        glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth->get(), 0);
    glDrawBuffers(GLsizei(targets.size()), targets.data());
    if (targets.empty()) glReadBuffer(GL_NONE);
    const GLenum status = glCheckFramebufferStatus(GL_FRAMEBUFFER);
    if (status != GL_FRAMEBUFFER_COMPLETE)
        throw std::runtime_error(fmt::format("this OpenGL driver can't draw into the viewer's images: status 0x{:x}", status));
}

void Framebuffer::bind(int width, int height) const {
    glBindFramebuffer(GL_FRAMEBUFFER, get());
    glViewport(0, 0, width, height);
}

Program::Program(const std::string& name, const std::string& vertex, const std::string& fragment)
    : name_(glCreateProgram()) {
    for (const GLuint shader :
         {compileShader(name, GL_VERTEX_SHADER, vertex), compileShader(name, GL_FRAGMENT_SHADER, fragment)}) {
        glAttachShader(name_.get(), shader);
        glDeleteShader(shader);  // goes with the program
    }
    glLinkProgram(name_.get());
    GLint isLinked = 0;
    glGetProgramiv(name_.get(), GL_LINK_STATUS, &isLinked);
    if (isLinked == GL_TRUE) return;
    std::vector<char> log(4096);
    glGetProgramInfoLog(name_.get(), GLsizei(log.size()), nullptr, log.data());
    throw std::runtime_error(fmt::format("linking {}: {}", name, log.data()));
}

void Program::use() const {
    glUseProgram(name_.get());
}
GLint Program::at(const char* name) const {
    return glGetUniformLocation(name_.get(), name);
}
void Program::set(const char* name, int value) const {
    glUniform1i(at(name), value);
}
void Program::set(const char* name, float value) const {
    glUniform1f(at(name), value);
}
void Program::set(const char* name, const glm::vec2& value) const {
    glUniform2fv(at(name), 1, &value[0]);
}
void Program::set(const char* name, const glm::vec3& value) const {
    glUniform3fv(at(name), 1, &value[0]);
}
void Program::set(const char* name, const glm::vec4& value) const {
    glUniform4fv(at(name), 1, &value[0]);
}
void Program::set(const char* name, const glm::mat4& value) const {
    glUniformMatrix4fv(at(name), 1, GL_FALSE, &value[0][0]);
}
void Program::set(const char* name, int unit, const Texture& texture) const {
    texture.bind(unit);
    glUniform1i(at(name), unit);
}

bool DepthTest::isReversed() {
    static const bool isThere = epoxy_has_gl_extension("GL_ARB_clip_control");  // of the one context that there is
    return isThere;
}

DepthTest::DepthTest() {
    glEnable(GL_DEPTH_TEST);
    if (isReversed()) {
        glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
        glDepthFunc(GL_GREATER);
    }
    const float farthest = isReversed() ? 0.0f : 1.0f;
    glClearBufferfv(GL_DEPTH, 0, &farthest);
}

DepthTest::~DepthTest() {
    if (isReversed()) {
        glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
        glDepthFunc(GL_LESS);
    }
    glDisable(GL_DEPTH_TEST);
}

const char* const kWholeImageVertex = R"(#version 330 core
void main() {
    vec2 corner = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2);
    gl_Position = vec4(corner * 2.0 - 1.0, 0.0, 1.0);
}
)";

void drawWholeImage() {
    // Core profiles draw nothing without one. It goes with its context, which ends before static objects do.
    static const GLuint none = [] {
        GLuint name = 0;
        glGenVertexArrays(1, &name);
        return name;
    }();
    glBindVertexArray(none);
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace viewer
