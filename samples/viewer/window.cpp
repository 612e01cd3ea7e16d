// A window with its context, by GLFW.
#include <epoxy/gl.h>

#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include <bitset>
#include <cstddef>
#include <stdexcept>

#include "context.h"

namespace viewer {
namespace {

std::string lastGlfwError() {
    const char* text = nullptr;
    return glfwGetError(&text) != GLFW_NO_ERROR && text != nullptr ? text : "no reason given";
}

class Window final : public Context {
public:
    Window(int width, int height, const std::string& title) {
        if (glfwInit() != GLFW_TRUE)
            throw std::runtime_error(fmt::format("no window: {}; without a display, use --headless", lastGlfwError()));
        glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
        glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
        glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
        glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
        window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
        if (window_ == nullptr) {
            const std::string reason = lastGlfwError();
            glfwTerminate();
            throw std::runtime_error(fmt::format("no window of {}x{} with OpenGL 3.3 core: {}", width, height, reason));
        }
        glfwMakeContextCurrent(window_);
        glfwSwapInterval(0);  // frames last as long as they take: times mean something
        glfwSetWindowUserPointer(window_, this);
        // Dear ImGui's own call-back calls this one.
        glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int, int action, int) {
            if (action == GLFW_PRESS && key >= 0) static_cast<Window*>(glfwGetWindowUserPointer(window))->pressed_.set(std::size_t(key));
        });
    }
    ~Window() override {
        glfwDestroyWindow(window_);
        glfwTerminate();
    }
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    std::string description() const override { return fmt::format("GLFW {}", glfwGetVersionString()); }
    GLFWwindow* window() const override { return window_; }
    bool wantsToClose() const override { return glfwWindowShouldClose(window_) == GLFW_TRUE; }
    void beginFrame() override {
        pressed_.reset();
        glfwPollEvents();
    }
    bool isPressed(int key) const override { return pressed_.test(std::size_t(key)); }
    void endFrame() override { glfwSwapBuffers(window_); }
    void size(int& width, int& height) const override { glfwGetFramebufferSize(window_, &width, &height); }

private:
    GLFWwindow* window_ = nullptr;
    std::bitset<GLFW_KEY_LAST + 1> pressed_;  // a call-back of C must not throw: nothing is allocated
};

}  // namespace

std::unique_ptr<Context> makeWindow(int width, int height, const std::string& title) {
    return std::make_unique<Window>(width, height, title);
}

}  // namespace viewer
