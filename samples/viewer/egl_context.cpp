// A context without any window system: EGL on Mesa's surfaceless platform, else on EGL's default display with a small
// pbuffer. GLFW 3.3 can't do that. Everything is drawn into framebuffer objects.
#include <dlfcn.h>
#include <epoxy/egl.h>

#include <stdexcept>

#include <fmt/format.h>

#include "context.h"

namespace viewer {
namespace {

bool hasClientExtension(const char* name) {
    const char* extensions = eglQueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);  // null before EGL 1.5
    return extensions != nullptr && epoxy_extension_in_string(extensions, name);
}

class EglContext final : public Context {
public:
    EglContext(int width, int height) : width_(width), height_(height) {
        // libepoxy opens it at the first call, and aborts where it isn't there.
        if (dlopen("libEGL.so.1", RTLD_LAZY | RTLD_LOCAL) == nullptr)
            throw std::runtime_error(fmt::format("--headless: expected libEGL.so.1 (Debian's libegl1), got: {}", dlerror()));
        if (!(hasClientExtension("EGL_MESA_platform_surfaceless") && open(true)) && !open(false))
            throw std::runtime_error(fmt::format(
                "--headless: expected EGL with desktop OpenGL 3.3 core, got EGL error 0x{:x}; install a driver, e.g. Debian's "
                "libegl1 and libgl1-mesa-dri, or use a window under Xvfb",
                error_));
    }
    ~EglContext() override { close(); }
    EglContext(const EglContext&) = delete;
    EglContext& operator=(const EglContext&) = delete;

    std::string description() const override { return isSurfaceless_ ? "EGL, surfaceless" : "EGL, pbuffer"; }
    void size(int& width, int& height) const override {
        width = width_;
        height = height_;
    }

private:
    // False, with everything closed and the error kept, where there is no such context.
    bool open(bool surfaceless) {
        isSurfaceless_ = surfaceless;
        display_ = surfaceless ? eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr)
                               : eglGetDisplay(EGL_DEFAULT_DISPLAY);
        const bool isOpen = display_ != EGL_NO_DISPLAY && eglInitialize(display_, nullptr, nullptr) == EGL_TRUE &&
                            eglBindAPI(EGL_OPENGL_API) == EGL_TRUE && makeCurrent();
        if (isOpen) return true;
        error_ = eglGetError();
        close();
        return false;
    }

    bool makeCurrent() {
        const EGLint configWords[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_NONE};
        EGLConfig config = nullptr;
        EGLint count = 0;
        if (eglChooseConfig(display_, configWords, &config, 1, &count) != EGL_TRUE || count < 1) return false;
        const EGLint contextWords[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                       EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
        context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, contextWords);
        if (context_ == EGL_NO_CONTEXT) return false;
        if (!isSurfaceless_) {
            const EGLint surfaceWords[] = {EGL_WIDTH, 1, EGL_HEIGHT, 1, EGL_NONE};
            surface_ = eglCreatePbufferSurface(display_, config, surfaceWords);
        }
        return eglMakeCurrent(display_, surface_, surface_, context_) == EGL_TRUE;
    }

    void close() {
        if (display_ == EGL_NO_DISPLAY) return;
        eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        if (surface_ != EGL_NO_SURFACE) eglDestroySurface(display_, surface_);
        if (context_ != EGL_NO_CONTEXT) eglDestroyContext(display_, context_);
        eglTerminate(display_);
        display_ = EGL_NO_DISPLAY;
        surface_ = EGL_NO_SURFACE;
        context_ = EGL_NO_CONTEXT;
    }

    int width_, height_;
    bool isSurfaceless_ = false;
    EGLint error_ = 0;
    EGLDisplay display_ = EGL_NO_DISPLAY;
    EGLSurface surface_ = EGL_NO_SURFACE;
    EGLContext context_ = EGL_NO_CONTEXT;
};

}  // namespace

std::unique_ptr<Context> makeHeadlessContext(int width, int height) {
    return std::make_unique<EglContext>(width, height);
}

}  // namespace viewer
