// An OpenGL 3.3 core context, with or without a window: the rest of the viewer doesn't know which.
#pragma once

#include <memory>
#include <string>

struct GLFWwindow;

namespace viewer {

class Context {
public:
    virtual ~Context() = default;
    virtual std::string description() const = 0;  // what made it
    virtual GLFWwindow* window() const { return nullptr; }  // null: headless
    virtual bool wantsToClose() const { return false; }
    virtual void beginFrame() {}  // reads what mouse and keyboard did
    // GLFW's keys pressed since the last frame, also those that were let go before it: frames may be slow.
    virtual bool isPressed(int) const { return false; }
    virtual void endFrame() {}    // shows the default framebuffer
    // Of the default framebuffer, in pixels; a headless context has none.
    virtual void size(int& width, int& height) const = 0;
};

// Both make the context current on the calling thread. Errors: std::runtime_error that says what is missing and
// what to do.
std::unique_ptr<Context> makeWindow(int width, int height, const std::string& title);
std::unique_ptr<Context> makeHeadlessContext(int width, int height);

}  // namespace viewer
