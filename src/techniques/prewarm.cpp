#include "techniques/prewarm.h"

#include <array>

#include "compute/device.h"
#include "inputs/output_target.h"

namespace lightwell {
namespace {

constexpr std::uint32_t kSize = 16;  // pixels along each side
using Pixels = std::array<float, kSize * kSize * 3>;

LWImage imageOf(Pixels& pixels, LWFormat format) {
    LWImage image{};
    image.host = pixels.data();
    image.format = format;
    image.width = image.height = kSize;
    return image;
}

// A floor under a camera that looks down on it, as interleaved images: everything has to be unpacked.
struct Inputs {
    Pixels position{}, normal{}, flux{}, radiance{}, depth{}, receiveMask{}, irradiance{}, validity{}, ambient{}, specular{}, refracted{},
        shadow{};
    LWCamera camera{};
    // One triangle that fills a map, and slivers: kernels may tell large ones from small ones.
    std::array<float, 27> vertices{{-9, 1, -9, 9, 1, -9, 0, 1, 9, 0, 0.5f, 0, 0.001f, 0.5f, 0, 0, 0.5f, 0.001f,
                                    1, 0.5f, 0, 1.001f, 0.5f, 0, 1, 0.5f, 0.001f}};

    Inputs() {
        for (std::uint32_t i = 0; i < kSize * kSize; ++i) {
            position[3 * i] = float(i % kSize) / kSize;
            position[3 * i + 2] = float(i / kSize) / kSize;
            normal[3 * i + 1] = 1.0f;
            flux[3 * i] = flux[3 * i + 1] = flux[3 * i + 2] = 1.0f;
            depth[i] = 0.5f;
        }
        // Looks along -y, up = -z; orthographic, one unit wide, depth 0..1.
        const float view[16] = {1, 0, 0, -0.5f, 0, 0, -1, 0.5f, 0, 1, 0, -1, 0, 0, 0, 1};
        const float projection[16] = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1};
        for (int i = 0; i < 16; ++i) {
            camera.view[i] = view[i];
            camera.projection[i] = projection[i];
        }
    }

    std::array<LWStaticVpl, 2> staticVpls{};
    LWBlocker blocker{};
    void addStaticVpls(LWFrame& frame) {
        for (std::size_t i = 0; i < staticVpls.size(); ++i) {
            staticVpls[i].position[0] = float(i);
            staticVpls[i].normal[1] = 1.0f;
            for (float& part : staticVpls[i].reflectance) part = 0.5f;
        }
        blocker.center[1] = 0.5f;
        blocker.radius = 0.1f;
        frame.staticVpls = staticVpls.data();
        frame.staticVplCount = std::uint32_t(staticVpls.size());
        frame.blockers = &blocker;
        frame.blockerCount = 1;
    }

    // The first row of pixels.
    LWImage row(Pixels& pixels, LWFormat format) {
        LWImage image = imageOf(pixels, format);
        image.height = 1;
        return image;
    }
};

// The device reads and writes the inputs until it is idle, also when an exception cuts the frames short.
struct IdleAtEnd {
    Device& device;
    ~IdleAtEnd() { clFinish(device.queue()); }
};

}  // namespace

void exerciseTechnique(Executor& executor, Technique& technique, std::uint32_t kinds, bool spots) {
    Inputs inputs;
    const IdleAtEnd idle{executor.device()};
    const auto view = std::make_shared<View>(kSize, kSize);
    for (const bool byDepth : {false, true}) {
        LWRsm rsm{};
        rsm.structSize = sizeof rsm;
        rsm.normal = imageOf(inputs.normal, LW_FORMAT_FLOAT3);
        rsm.flux = imageOf(inputs.flux, LW_FORMAT_FLOAT3);
        rsm.camera = inputs.camera;
        LWGBuffer gbuffer{};
        gbuffer.structSize = sizeof gbuffer;
        gbuffer.normal = imageOf(inputs.normal, LW_FORMAT_FLOAT3);
        gbuffer.directRadiance = imageOf(inputs.radiance, LW_FORMAT_FLOAT3);
        gbuffer.receiveMask = imageOf(inputs.receiveMask, byDepth ? LW_FORMAT_UINT8 : LW_FORMAT_FLOAT1);
        if (kinds & (kMakesSpecular | kMakesRefracted)) gbuffer.roughness = imageOf(inputs.radiance, LW_FORMAT_FLOAT1);
        gbuffer.camera = inputs.camera;
        if (byDepth) {
            rsm.depth = gbuffer.depth = imageOf(inputs.depth, LW_FORMAT_FLOAT1);
        } else {
            rsm.position = gbuffer.position = imageOf(inputs.position, LW_FORMAT_FLOAT3);
        }
        LWLight light{};
        light.structSize = sizeof light;
        light.kind = LW_LIGHT_DIRECTIONAL;
        light.direction[1] = -1.0f;
        light.rsmCount = 1;
        light.rsms = &rsm;
        LWGeometry geometry{};
        geometry.structSize = sizeof geometry;
        geometry.vertices = inputs.vertices.data();
        geometry.vertexCount = std::uint32_t(inputs.vertices.size() / 3);
        geometry.triangleCount = geometry.vertexCount / 3;
        geometry.version = byDepth ? 1 : 2;
        if (!byDepth) {  // triangles in both, surfels in one
            geometry.surfelCount = kSize;
            geometry.surfelPosition = inputs.row(inputs.position, LW_FORMAT_FLOAT3);
            geometry.surfelNormal = inputs.row(inputs.normal, LW_FORMAT_FLOAT3);
            geometry.surfelArea = inputs.row(inputs.depth, LW_FORMAT_FLOAT1);
        }
        // Views are told apart by their images alone.
        const LWSourceView source{nullptr, &gbuffer};
        LWFrame frame{};
        frame.structSize = sizeof frame;
        frame.geometry = &geometry;
        frame.sourceViews = &source;
        frame.sourceViewCount = 1;
        frame.lightCount = 1;
        frame.lights = &light;
        if (spots) {
            inputs.addStaticVpls(frame);
            // The map from a lamp above its middle; its light is not for what is baked.
            light.kind = LW_LIGHT_SPOT;
            light.position[1] = 1.0f;
            light.outerConeAngle = 1.0f;
            for (float& part : light.radiantIntensity) part = 1.0f;
            light.receivers = LW_RECEIVERS_UNBAKED;
            const float perspective[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1.001f, -0.01f, 0, 0, -1, 0};
            for (int i = 0; i < 16; ++i) rsm.camera.projection[i] = perspective[i];
            gbuffer.bakedMask = gbuffer.receiveMask;
        }
        LWOutput output{};
        output.structSize = sizeof output;
        output.irradiance = imageOf(inputs.irradiance, LW_FORMAT_FLOAT3);
        output.validity = imageOf(inputs.validity, LW_FORMAT_FLOAT1);
        if (kinds & kMakesAmbient) output.ambientOcclusion = imageOf(inputs.ambient, LW_FORMAT_FLOAT1);
        if (kinds & kMakesSpecular) output.specularRadiance = imageOf(inputs.specular, LW_FORMAT_FLOAT3);
        if (kinds & kMakesRefracted) output.refractedRadiance = imageOf(inputs.refracted, LW_FORMAT_FLOAT3);
        if (kinds & kMakesShadow) output.shadow = imageOf(inputs.shadow, LW_FORMAT_FLOAT1);
        executor.setWorldOrigin({});  // whatever one that failed before this left
        technique.update(executor, frame);
        technique.render(executor, view, gbuffer, output);
        for (const DebugView& debug : technique.debugViews(view.get()))
            if (debug.fill && debug.planes.width && debug.planes.height) {
                Planes planes = debug.planes;
                const Buffer made(executor.device(), std::size_t(planes.planeStride) * planes.count * sizeof(float),
                                  debug.name);
                planes.memory = made.get();
                debug.fill(executor, planes);
            }
        executor.device().finish();
        // The same view with every light out.
        LWFrame dark{};
        dark.structSize = sizeof dark;
        dark.geometry = &geometry;
        // From another origin: what was kept has to be brought there.
        dark.worldOrigin[0] = 1.0;
        executor.setWorldOrigin({1.0, 0.0, 0.0});
        technique.update(executor, dark);
        output.shadow = LWImage{};  // of which light?
        technique.render(executor, view, gbuffer, output);
        if (kinds) {
            output.irradiance = output.validity = LWImage{};
            technique.render(executor, view, gbuffer, output);
            LWOutput alone{};
            alone.structSize = sizeof alone;
            alone.irradiance = imageOf(inputs.irradiance, LW_FORMAT_FLOAT3);
            technique.render(executor, view, gbuffer, alone);
            alone.irradiance = LWImage{};
            alone.validity = imageOf(inputs.validity, LW_FORMAT_FLOAT1);
            technique.render(executor, view, gbuffer, alone);
        }
        executor.setWorldOrigin({});
        executor.device().finish();
    }
}

void exercisePoints(Executor& executor, Technique& technique) {
    Inputs inputs;
    const IdleAtEnd idle{executor.device()};
    Points points;
    points.count = kSize;
    points.positions = inputs.row(inputs.position, LW_FORMAT_FLOAT3);
    points.normals = inputs.row(inputs.normal, LW_FORMAT_FLOAT3);
    points.output.structSize = sizeof points.output;
    points.output.irradiance = inputs.row(inputs.irradiance, LW_FORMAT_FLOAT3);
    points.output.validity = inputs.row(inputs.validity, LW_FORMAT_FLOAT1);
    points.output.harmonics = imageOf(inputs.radiance, LW_FORMAT_FLOAT3);
    points.output.harmonics.height = 4;
    technique.renderPoints(executor, points);
    points.output.irradiance = points.output.harmonics = LWImage{};  // validity as at surfaces
    technique.renderPoints(executor, points);
    executor.device().finish();
}

}  // namespace lightwell
