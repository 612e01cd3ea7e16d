// See exr_layers.h.
#include "exr_layers.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace studio {
namespace {

struct Place {
    int part = 0, channel = 0;
    bool isHalf = false;
};

// Where the picture lies in a part's data window, which may reach beyond it (overscan).
struct Window {
    int left = 0, top = 0, width = 0, height = 0;
};

void checkPart(const std::string& path, const OIIO::ImageSpec& spec, int part) {
    if (spec.deep || spec.depth > 1)
        throw std::runtime_error(path + ": expected a flat image, got a deep or volume image");
    if (!spec.format.is_floating_point())
        throw std::runtime_error(fmt::format("{}: expected floating-point channels (EXR), got {}", path, spec.format.c_str()));
    const bool isWhole = spec.x <= spec.full_x && spec.y <= spec.full_y && spec.x + spec.width >= spec.full_x + spec.full_width &&
                         spec.y + spec.height >= spec.full_y + spec.full_height;
    if (!isWhole)
        throw std::runtime_error(fmt::format("{}: part {}: expected all pixels of the picture of {}x{} at ({}, {}), got a data window of {}x{} at "
                                             "({}, {})",
                                             path, part, spec.full_width, spec.full_height, spec.full_x, spec.full_y, spec.width, spec.height,
                                             spec.x, spec.y));
}

std::string fullName(const OIIO::ImageSpec& spec, const std::string& channel, bool hasParts) {
    const std::string part(spec.get_string_attribute("oiio:subimagename"));
    if (!hasParts || part.empty() || channel.compare(0, part.size() + 1, part + ".") == 0) return channel;
    return part + "." + channel;
}

}  // namespace

struct ExrLayers::File {
    std::unique_ptr<OIIO::ImageInput> input;
    std::vector<Place> places;    // of each name
    std::vector<Window> windows;  // of each part
};

ExrLayers::ExrLayers(const std::string& path) : file_(std::make_unique<File>()), path_(path) {
    file_->input = OIIO::ImageInput::open(path);
    if (!file_->input) throw std::runtime_error(path + ": cannot read: " + OIIO::geterror());
    const bool hasParts = file_->input->seek_subimage(1, 0);
    for (int part = 0; file_->input->seek_subimage(part, 0); ++part) {
        const OIIO::ImageSpec spec = file_->input->spec();
        checkPart(path, spec, part);
        if (part > 0 && (spec.full_width != width_ || spec.full_height != height_))
            throw std::runtime_error(fmt::format("{}: expected all parts of the first one's {}x{} pixels, part {} has {}x{}", path, width_,
                                                 height_, part, spec.full_width, spec.full_height));
        width_ = spec.full_width;
        height_ = spec.full_height;
        file_->windows.push_back({spec.full_x - spec.x, spec.full_y - spec.y, spec.width, spec.height});
        for (int channel = 0; channel < spec.nchannels; ++channel) {
            const std::string name = fullName(spec, spec.channelnames[std::size_t(channel)], hasParts);
            if (has(name)) throw std::runtime_error(fmt::format("{}: expected channels of different names, got {} twice", path, name));
            names_.push_back(name);
            file_->places.push_back({part, channel, spec.channelformat(channel) == OIIO::TypeHalf});
        }
    }
}

ExrLayers::~ExrLayers() = default;

bool ExrLayers::has(const std::string& name) const {
    return std::find(names_.begin(), names_.end(), name) != names_.end();
}

bool ExrLayers::isHalf(const std::string& name) const {
    const auto found = std::find(names_.begin(), names_.end(), name);
    return found != names_.end() && file_->places[std::size_t(found - names_.begin())].isHalf;
}

std::vector<std::vector<float>> ExrLayers::planes(const std::vector<std::string>& names) const {
    std::vector<Place> places;
    for (const std::string& name : names) {
        const auto found = std::find(names_.begin(), names_.end(), name);
        if (found == names_.end()) throw std::runtime_error(path_ + ": no channel " + name);
        places.push_back(file_->places[std::size_t(found - names_.begin())]);
    }
    const std::size_t pixels = std::size_t(width_) * std::size_t(height_);
    std::vector<std::vector<float>> result(names.size(), std::vector<float>(pixels));
    for (std::size_t i = 0; i < places.size();) {
        // As many as follow each other in the file, at once.
        std::size_t end = i + 1;
        while (end < places.size() && places[end].part == places[i].part && places[end].channel == places[end - 1].channel + 1) ++end;
        const std::size_t count = end - i;
        const Window& window = file_->windows[std::size_t(places[i].part)];
        std::vector<float> values(std::size_t(window.width) * std::size_t(window.height) * count);
        if (!file_->input->read_image(places[i].part, 0, places[i].channel, places[i].channel + int(count), OIIO::TypeFloat, values.data()))
            throw std::runtime_error(path_ + ": cannot read: " + file_->input->geterror());
        for (std::size_t c = 0; c < count; ++c)
            for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
                const std::size_t x = pixel % std::size_t(width_), y = pixel / std::size_t(width_);
                const std::size_t from = (y + std::size_t(window.top)) * std::size_t(window.width) + x + std::size_t(window.left);
                result[i + c][pixel] = values[from * count + c];
            }
        i = end;
    }
    return result;
}

}  // namespace studio
