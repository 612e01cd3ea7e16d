// The channels of an EXR that another program wrote: one part or several, any layers, read as they are asked for.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "image.h"

namespace studio {

class ExrLayers {
public:
    // Errors (std::runtime_error, naming the path): not an image; not floating point; deep; parts of different sizes; a data window
    // that lacks pixels of the display window (a cropped picture). Of one that reaches beyond it (overscan) the display window is read, which is
    // the camera's picture.
    explicit ExrLayers(const std::string& path);
    ~ExrLayers();
    ExrLayers(const ExrLayers&) = delete;
    ExrLayers& operator=(const ExrLayers&) = delete;

    const std::string& path() const { return path_; }
    int width() const { return width_; }
    int height() const { return height_; }
    // By full name, in the file's order; in a file of several parts "part.channel" where the channel's own name does not begin with its
    // part's already.
    const std::vector<std::string>& names() const { return names_; }
    bool has(const std::string& name) const;
    bool isHalf(const std::string& name) const;  // held as half floats; false where there is none of that name
    // Each row after row, the top one first. Throws where there is none of a name, or the file is damaged. One call for channels that belong
    // together: the file is decompressed anew for each.
    std::vector<std::vector<float>> planes(const std::vector<std::string>& names) const;

private:
    struct File;
    std::unique_ptr<File> file_;
    std::string path_;
    int width_ = 0, height_ = 0;
    std::vector<std::string> names_;
};

}  // namespace studio
