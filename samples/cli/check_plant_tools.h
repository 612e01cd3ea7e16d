// What plants do to pixels and matrices.
#pragma once

#include "planted_inputs.h"

namespace cli {

glm::mat4 matrixOf(const float (&rows)[16]);
void storeMatrix(const glm::mat4& m, float (&rows)[16]);
void transpose(float (&rows)[16]);
void scaleFlux(PlantedInputs& in, float (*factor)(const PlantedInputs::Map&));
void scaleMotion(PlantedInputs& in, float x, float y);
void scaleView(LWCamera& camera, float factor);
glm::vec3 eyeOf(const LWCamera& camera);
glm::mat3 rotationOf(const LWCamera& camera);
glm::vec3 toView(const LWCamera& camera, const glm::vec3& p);
float middleDistance(PlantedInputs& in);
// All positions and cameras moved so far from the origin that positions are rounded to half a pixel's width.
void moveFar(PlantedInputs& in);
// The G-buffer with depth instead of positions, drawn with clip planes that suit the picture.
void useDepth(PlantedInputs& in, bool openGl, bool reversedMatrix);
void flipRows(PlantedInputs::Pixels& pixels);
// Flux over that of a white surface is the albedo: encoded in its place.
void encodeFlux(PlantedInputs::Pixels& flux, const LWLight& light, const LWCamera& camera);

template <class Change>
void eachPixel(PlantedInputs::Pixels& pixels, const Change& change) {
    for (int y = 0; y < pixels.height; ++y)
        for (int x = 0; x < pixels.width; ++x) change(x, y);
}
// Surfaces only: background keeps its zeros.
template <class Change>
void changeNormals(PlantedInputs::Pixels& normal, const Change& change) {
    eachPixel(normal, [&](int x, int y) {
        const glm::vec3 n = normal.triple(x, y);
        if (n != glm::vec3(0.0f)) normal.set(x, y, change(n));
    });
}
template <class Change>
void changePlaces(PlantedInputs::Pixels& position, PlantedInputs::Pixels& normal, const Change& change) {
    eachPixel(position, [&](int x, int y) {
        if (normal.triple(x, y) != glm::vec3(0.0f)) position.set(x, y, change(position.triple(x, y)));
    });
}
template <class Change>
void eachMap(PlantedInputs& in, const Change& change) {
    for (std::size_t l = 0; l < in.maps.size(); ++l)
        for (std::size_t r = 0; r < in.maps[l].size(); ++r) change(in.maps[l][r], in.rsms[l][r]);
}

}  // namespace cli
