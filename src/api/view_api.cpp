// Entry points: views.
#include "api/call.h"
#include "api/structs.h"

using namespace lightwell;

namespace {

constexpr std::uint32_t kMaxViewSide = 16384;

void checkSize(std::uint32_t width, std::uint32_t height, std::uint32_t maxWidth,
               std::uint32_t maxHeight, const char* name) {
    if (width == 0 || height == 0 || width > maxWidth || height > maxHeight)
        fail(LW_ERROR_INVALID_ARGUMENT, name, ": expected 1 .. ", maxWidth, " x 1 .. ", maxHeight,
             ", got ", width, " x ", height);
}

}  // namespace

LWStatus lwCreateView(LWDevice device, const LWViewDesc* desc, LWView* view) {
    return enter("lwCreateView", [&](Call& call) {
        call.device(device);
        if (!view) fail(LW_ERROR_INVALID_ARGUMENT, "view: expected an address for the handle, got null");
        *view = nullptr;
        const LWViewDesc own = readStruct(desc, "desc");
        checkSize(own.maxWidth, own.maxHeight, kMaxViewSide, kMaxViewSide,
                  "desc.maxWidth, desc.maxHeight");
        auto object = std::make_shared<ViewObject>(call.owner(), own.maxWidth, own.maxHeight);
        const std::shared_ptr<View> made = object->view;
        *view = static_cast<LWView>(addHandle(HandleKind::kView, std::move(object)));
        made->handle = *view;
    });
}

LWStatus lwRetainView(LWView view) {
    return enter("lwRetainView", [&](Call&) { retainHandle(HandleKind::kView, view, "view"); });
}

LWStatus lwReleaseView(LWView view) {
    return enter("lwReleaseView", [&](Call& call) {
        auto object =
            std::static_pointer_cast<ViewObject>(releaseHandle(HandleKind::kView, view, "view"));
        if (object) call.dispose(std::move(object));
    });
}

LWStatus lwSetViewSize(LWView view, std::uint32_t width, std::uint32_t height) {
    return enter("lwSetViewSize", [&](Call& call) {
        const auto object = call.view(view);
        checkSize(width, height, object->view->maxWidth, object->view->maxHeight, "width, height");
        object->view->width = width;
        object->view->height = height;
    });
}

LWStatus lwGetViewSize(LWView view, std::uint32_t* width, std::uint32_t* height) {
    return enter("lwGetViewSize", [&](Call& call) {
        const auto object = call.view(view);
        if (width) *width = object->view->width;
        if (height) *height = object->view->height;
    });
}
