// A frame's images as copies that plants may change.
#pragma once

#include <algorithm>
#include <vector>

#include "render_inputs.h"

namespace cli {

// Copies of a frame's images that may be changed; the structs point to them.
class PlantedInputs {
public:
    explicit PlantedInputs(const RenderInputs& inputs);
    PlantedInputs(const PlantedInputs&) = delete;
    PlantedInputs& operator=(const PlantedInputs&) = delete;

    // Interleaved float pixels of a copied image.
    struct Pixels {
        int width = 0, height = 0, channels = 0;
        std::vector<float> values;
        float* at(int x, int y) { return &values[std::size_t((y * width + x) * channels)]; }
        glm::vec3 triple(int x, int y) {
            const float* v = at(x, y);
            return {v[0], v[1], v[2]};
        }
        void set(int x, int y, const glm::vec3& v) { std::copy_n(&v[0], 3, at(x, y)); }
        LWImage image() const;
    };
    struct Map {
        Pixels position, normal, flux;
    };

    Pixels position, normal, albedo, direct, motion, depth;  // depth: empty until a plant makes it
    LWGBuffer gbuffer{};
    std::vector<LWLight> lights;
    std::vector<std::vector<LWRsm>> rsms;  // of each light
    std::vector<std::vector<Map>> maps;
    float environment[3] = {};
    // Lays the images into the structs; after the last change.
    void describe();
    LWFrame frame() const;
};

}  // namespace cli
