// A host that lives in OpenCL: Lightwell works in the host's own context and queue, on the images that the host's kernels draw into,
// and the host's next kernel takes the light from where Lightwell has put it. No image is copied, and nobody waits before the end.
//
// A sun shines on a white wall; the floor at its foot receives what the wall gives back (samples/minimal.c). The result has the same
// bits as that of host memory, in a queue that keeps the order and in one that does not.
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <lightwell/lightwell.hpp>
#include <vector>

namespace {

constexpr std::uint32_t kSide = 64;  // pixels and texels a side: rows of a multiple of 16 floats are used in place
constexpr std::size_t kPlane = std::size_t(kSide) * kSide, kBytes = 3 * kPlane * sizeof(float);

void check(cl_int status, const char* what) {
    if (status == CL_SUCCESS) return;
    std::fprintf(stderr, "%s: OpenCL error %d\n", what, status);
    std::exit(1);
}

// The host's renderer: three planes of positions, normals and flux of the floor and of the wall; and its composition.
const char* const kHostKernels = R"(
__kernel void draw(__global float* position, __global float* normal, __global float* flux, int isWall) {
    const int x = get_global_id(0), y = get_global_id(1), w = get_global_size(0), n = w * w, i = y * w + x;
    const float u = (x + 0.5f) / w, v = (y + 0.5f) / w;
    for (int c = 0; c < 3; ++c) {
        position[c * n + i] = isWall ? (c == 0 ? 0.0f : c == 1 ? 1.0f - v : 1.0f - u) : (c == 0 ? u : c == 1 ? 0.0f : v);
        normal[c * n + i] = c == (isWall ? 0 : 1) ? 1.0f : 0.0f;
        if (isWall) flux[c * n + i] = 1.0f / n;
    }
}
__kernel void composite(__global const float* irradiance, __global float* picture) {
    const int i = get_global_id(0);
    picture[i] = 0.5f / M_PI_F * irradiance[i];  /* a grey floor */
}
)";

// The host's own context, queue, kernels and images.
struct Host {
    explicit Host(cl_command_queue_properties properties) {
        cl_int status = 0;
        check(clGetPlatformIDs(1, &platform, nullptr), "clGetPlatformIDs");
        check(clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &device, nullptr), "clGetDeviceIDs");
        context = clCreateContext(nullptr, 1, &device, nullptr, nullptr, &status);
        check(status, "clCreateContext");
        queue = clCreateCommandQueue(context, device, properties, &status);
        check(status, "clCreateCommandQueue");
        const char* text = kHostKernels;
        program = clCreateProgramWithSource(context, 1, &text, nullptr, &status);
        check(clBuildProgram(program, 1, &device, "", nullptr, nullptr), "clBuildProgram");
        draw = clCreateKernel(program, "draw", &status);
        composite = clCreateKernel(program, "composite", &status);
        check(status, "clCreateKernel");
        for (cl_mem& image : images) image = clCreateBuffer(context, CL_MEM_READ_WRITE, kBytes, nullptr, &status);
        check(status, "clCreateBuffer");
    }
    ~Host() {
        for (cl_mem image : images) clReleaseMemObject(image);
        clReleaseKernel(draw), clReleaseKernel(composite), clReleaseProgram(program);
        clReleaseCommandQueue(queue), clReleaseContext(context);
    }
    Host(const Host&) = delete;
    Host& operator=(const Host&) = delete;

    cl_event drawInto(cl_mem position, cl_mem normal, cl_mem flux, cl_int isWall) const {
        const std::size_t size[2] = {kSide, kSide};
        const cl_mem memory[3] = {position, normal, flux};
        for (cl_uint i = 0; i < 3; ++i) check(clSetKernelArg(draw, i, sizeof(cl_mem), &memory[i]), "clSetKernelArg");
        check(clSetKernelArg(draw, 3, sizeof isWall, &isWall), "clSetKernelArg");
        cl_event drawn = nullptr;
        check(clEnqueueNDRangeKernel(queue, draw, 2, nullptr, size, nullptr, 0, nullptr, &drawn), "draw");
        return drawn;
    }

    enum { kFloorPosition, kFloorNormal, kWallPosition, kWallNormal, kWallFlux, kIrradiance, kPicture, kImages };
    cl_platform_id platform = nullptr;
    cl_device_id device = nullptr;
    cl_context context = nullptr;
    cl_command_queue queue = nullptr;
    cl_program program = nullptr;
    cl_kernel draw = nullptr, composite = nullptr;
    cl_mem images[kImages] = {};
};

LWImage planar(const void* host, cl_mem memory) {
    LWImage image{};
    image.host = host;
    image.clMem = memory;
    image.format = LW_FORMAT_PLANAR_FLOAT3;
    image.width = image.height = kSide;
    return image;
}

// One frame of the sun on the wall. images: as Host's. Synchronises with what is given; null: by nothing.
void light(lightwell::Technique& technique, const lightwell::View& view, const LWImage (&images)[Host::kImages], const LWSync* before,
           const LWSync* after) {
    auto rsm = lightwell::make<LWRsm>();
    rsm.position = images[Host::kWallPosition];
    rsm.normal = images[Host::kWallNormal];
    rsm.flux = images[Host::kWallFlux];
    rsm.camera = {{0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, -2, 0, 0, 0, 1}, {2, 0, 0, 1, 0, 2, 0, -1, 0, 0, -.25f, 0, 0, 0, 0, 1}};
    auto sun = lightwell::make<LWLight>();
    sun.kind = LW_LIGHT_DIRECTIONAL;
    sun.direction[0] = -1;
    for (float& part : sun.irradiance) part = 1;
    sun.rsmCount = 1;
    sun.rsms = &rsm;
    auto frame = lightwell::make<LWFrame>();
    frame.lightCount = 1;
    frame.lights = &sun;
    frame.sync = before;  // the world part reads the wall: after the host has drawn
    auto gbuffer = lightwell::make<LWGBuffer>();
    gbuffer.position = images[Host::kFloorPosition];
    gbuffer.normal = images[Host::kFloorNormal];
    auto output = lightwell::make<LWOutput>();
    output.irradiance = images[Host::kIrradiance];
    output.sync = after;
    technique.update(frame);
    technique.render(view, gbuffer, output);
}

// What the floor receives, by the host's images on the device; and by host memory. Whether both are the same to the bit.
bool run(cl_command_queue_properties properties, const char* name) {
    const Host host(properties);
    LWDeviceDesc desc = lightwell::Device::defaults();
    desc.clContext = host.context;
    desc.clQueue = host.queue;
    lightwell::Device device(desc);
    const lightwell::View view(device, kSide, kSide);
    LWRsmDesc rsm;
    lwDefaultRsm(&rsm);
    rsm.vpls = 0;
    rsm.interleave = 1;  // every texel lights every pixel
    lightwell::Technique technique(device, "rsm", &rsm);

    // Drawn by the host's kernels, lit by Lightwell's, composited by the host's: all enqueued, nothing waited for. In a queue that
    // keeps no order the events alone do.
    LWImage images[Host::kImages];
    for (int i = 0; i < Host::kImages; ++i) images[i] = planar(nullptr, host.images[i]);
    void* drawn[2] = {host.drawInto(host.images[Host::kFloorPosition], host.images[Host::kFloorNormal], host.images[Host::kPicture], 0),
                      host.drawInto(host.images[Host::kWallPosition], host.images[Host::kWallNormal], host.images[Host::kWallFlux], 1)};
    void* lit = nullptr;
    auto before = lightwell::make<LWSync>(), after = lightwell::make<LWSync>();
    before.waitEventCount = 2;
    before.waitEvents = drawn;
    after.signalEvent = &lit;
    light(technique, view, images, &before, &after);
    cl_event wait = static_cast<cl_event>(lit), composited = nullptr;
    const std::size_t values = 3 * kPlane;
    check(clSetKernelArg(host.composite, 0, sizeof(cl_mem), &host.images[Host::kIrradiance]), "clSetKernelArg");
    check(clSetKernelArg(host.composite, 1, sizeof(cl_mem), &host.images[Host::kPicture]), "clSetKernelArg");
    check(clEnqueueNDRangeKernel(host.queue, host.composite, 1, nullptr, &values, nullptr, 1, &wait, &composited), "composite");
    std::vector<float> pixels[Host::kImages];
    for (int i = 0; i < Host::kImages; ++i) {
        pixels[i].resize(values);
        check(clEnqueueReadBuffer(host.queue, host.images[i], CL_TRUE, 0, kBytes, pixels[i].data(), 1, &composited, nullptr), "read");
    }
    for (cl_event event : {static_cast<cl_event>(drawn[0]), static_cast<cl_event>(drawn[1]), wait, composited}) clReleaseEvent(event);
    const std::uint64_t copied = technique.stats().hostCopyBytes;

    // The same frame from host memory.
    const std::vector<float> there = pixels[Host::kIrradiance];
    LWImage hosted[Host::kImages];
    for (int i = 0; i < Host::kImages; ++i) hosted[i] = planar(pixels[i].data(), nullptr);
    light(technique, view, hosted, nullptr, nullptr);
    device.finish();
    const bool isSame = std::memcmp(there.data(), pixels[Host::kIrradiance].data(), kBytes) == 0;
    double mean = 0.0, picture = 0.0;
    for (std::size_t i = 0; i < kPlane; ++i) {
        mean += double(there[i]) / kPlane;
        picture += double(pixels[Host::kPicture][i]) / kPlane;
    }
    std::printf("%s: the floor receives %.4f W/m^2 and shows %.4f W/(sr m^2), %llu bytes copied, %s bits as from host memory\n", name, mean,
                picture, static_cast<unsigned long long>(copied), isSame ? "the same" : "OTHER");
    return isSame && copied == 0 && std::abs(mean - 0.2) < 1e-3 && std::abs(picture - 0.5 / 3.14159265 * mean) < 1e-5;
}

bool keepsNoOrder() {
    cl_platform_id platform = nullptr;
    cl_device_id device = nullptr;
    cl_command_queue_properties supported = 0;
    check(clGetPlatformIDs(1, &platform, nullptr), "clGetPlatformIDs");
    check(clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 1, &device, nullptr), "clGetDeviceIDs");
    check(clGetDeviceInfo(device, CL_DEVICE_QUEUE_PROPERTIES, sizeof supported, &supported, nullptr), "clGetDeviceInfo");
    return supported & CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE;
}

}  // namespace

int main() try {
    bool isRight = run(0, "in order");
    if (keepsNoOrder()) isRight = run(CL_QUEUE_OUT_OF_ORDER_EXEC_MODE_ENABLE, "out of order") && isRight;
    else std::printf("out of order: this device has no such queues\n");
    return isRight ? 0 : 1;
} catch (const lightwell::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
