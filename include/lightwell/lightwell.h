/* Lightwell: real-time indirect light for any renderer, on any OpenCL device.
 *
 * Copyright 2026 The Lightwell authors. Licensed under the Apache License, Version 2.0.
 *
 * This is the whole API, in C99. A host hands over what it has already drawn (G-buffers of its
 * views, reflective shadow maps of its lights) and gets indirect diffuse irradiance back:
 *
 *     lwCreateDevice -> lwCreateView -> lwCreateTechnique
 *     each frame:  lwUpdate(technique, &frame)                    the world part, once
 *                  lwRender(technique, view, &gbuffer, &output)   once per view
 *                  lwFinish(device)                               or wait on the signalled event
 *
 * UNITS AND CONVENTIONS, the same for every function:
 *  - lengths in one unit of the host's choice (metres unless it says otherwise; no result depends on
 *    it); angles in radians; colours linear RGB, scene-referred.
 *  - flux W, irradiance W/m^2, radiance W/(sr m^2), radiant intensity W/sr.
 *  - world space is right-handed in the documentation; every computation is free of handedness.
 *  - matrices are row-major and multiply column vectors: clip = projection * view * (x, y, z, 1).
 *    Clip space has +y up; row 0 of an image is its top row (clip y = +1) unless the row stride is
 *    negative.
 *  - normals are unit vectors in world space, on the visible (G-buffer) or lit (RSM) side. A zero
 *    normal marks a pixel without a surface: it receives and sends exactly zero.
 *  - G-buffer `directRadiance` is the *diffuse* outgoing radiance L_d = albedo / pi * E_direct.
 *  - RSM `flux` is albedo * incident flux through the texel, in W.
 *  - the host composites L = L_d + albedo / pi * irradiance.
 *  - positions lie within 1e9 units of the origin: a VPL beyond refuses its frame, a pixel or an RSM texel
 *    counts as rejected and is no surface (a depth beyond is background).
 *  - large worlds: a float has 24 bits, which are 8 mm at 1e5 m. All positions and matrices of a frame are
 *    therefore relative to LWFrame::worldOrigin, a point of the host's world in double, which may move from frame to frame
 *    (docs/integration.md). The light does not depend on it.
 *
 * VERSIONING: structs that may grow begin with `structSize`; set it to sizeof(struct), which lwDefault*
 * and the LW_INIT macro do. The others (LWImage, LWCamera, LWVpl, LWStaticVpl, LWBlocker, LWSourceView, and what the
 * library hands out in arrays) keep their layout. Zero in any other field means "absent" or "the
 * default", unless the field says what else.
 *
 * THREADS: calls on one device are serialised by a lock of that device and may come from any thread;
 * devices are independent of each other. lwFinish, lwGetStats, lwReadLightList, lwReadDebugView, lwPlan and lwListPlans wait with the
 * lock open for what was enqueued before them, so that other threads' frames go on meanwhile; lwPrewarm, lwProbeDevice
 * and lwCheckInputs keep it to their end. A log callback must not call Lightwell (it gets LW_ERROR_REENTRANT), nor
 * throw.
 *
 * OWNERSHIP: handles are reference-counted; lwCreate* gives one reference. A child (view, technique)
 * keeps its device alive. A released or foreign handle is refused with LW_ERROR_INVALID_HANDLE.
 * Structs and the arrays they point to are read during the call only; *pixels* (host memory and
 * cl_mem) must stay valid and unchanged until the signalled event, or lwFinish. (Until lwFinish also where
 * the call failed for want of memory or for the device: some of its commands may be on their way.)
 *
 * ERRORS: every fallible call returns an LWStatus. The first failure since the last lwGetLastError is
 * kept with a message that names the argument, what was expected and what came. After a failed call
 * the objects are as they were before it, unless memory or the device failed: after an lwUpdate a technique then asks
 * for another one (LW_ERROR_NOT_UPDATED); lwRender may be repeated, and what techniques keep from frame to frame starts
 * anew with the next lwUpdate. Errors of the device's execution surface at the calls that wait,
 * and at the next lwUpdate or lwRender; whose command it was is not known, so all of the device's techniques
 * then ask for another lwUpdate.
 */
#ifndef LIGHTWELL_LIGHTWELL_H
#define LIGHTWELL_LIGHTWELL_H

#include <stddef.h>
#include <stdint.h>

#define LW_VERSION_MAJOR 0
#define LW_VERSION_MINOR 1
#define LW_VERSION_PATCH 0

#if defined(_WIN32)
#if defined(LIGHTWELL_BUILDING)
#define LW_API __declspec(dllexport)
#else
#define LW_API __declspec(dllimport)
#endif
#else
#define LW_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** Zeroes a struct and sets its `structSize`: `LWFrame frame; LW_INIT(frame);` */
#define LW_INIT(object)                               \
    do {                                              \
        static const char lwZero_[sizeof(object)] = {0}; \
        const char* lwFrom_ = lwZero_;                \
        char* lwTo_ = (char*)&(object);               \
        size_t lwByte_;                               \
        for (lwByte_ = 0; lwByte_ < sizeof(object); ++lwByte_) lwTo_[lwByte_] = lwFrom_[lwByte_]; \
        (object).structSize = (uint32_t)sizeof(object); \
    } while (0)

/* ------------------------------------------------------------------------------ status, handles */

typedef enum LWStatus {
    LW_SUCCESS = 0,
    LW_ERROR_INVALID_ARGUMENT = 1, /**< a value outside its range; the message names it */
    LW_ERROR_INVALID_HANDLE = 2,   /**< null, released, or a handle of another kind or device */
    LW_ERROR_OUT_OF_MEMORY = 3,    /**< host or device memory is exhausted */
    LW_ERROR_UNSUPPORTED = 4,      /**< this device or build lacks a feature; the message says which */
    LW_ERROR_NO_DEVICE = 5,        /**< no OpenCL device matches the selector */
    LW_ERROR_BUILD_FAILED = 6,     /**< a kernel does not build; the message carries the log */
    LW_ERROR_DEVICE = 7,           /**< the OpenCL driver reported an error while executing */
    LW_ERROR_NOT_UPDATED = 8,      /**< lwRender before any successful lwUpdate, after one that memory or
                                        the device failed, or after the device failed to execute a command;
                                        refused arguments leave the last in force */
    LW_ERROR_REENTRANT = 9,        /**< called from inside a log callback */
    LW_ERROR_INTERNAL = 10         /**< a defect of Lightwell; please report the message */
} LWStatus;

typedef struct LWDeviceHandle* LWDevice;       /**< context, queue, program cache */
typedef struct LWViewHandle* LWView;           /**< one viewport: an eye, a monitor */
typedef struct LWTechniqueHandle* LWTechnique; /**< one method with its parameters and state */

/** The status's name, e.g. "LW_ERROR_DEVICE". Never null. */
LW_API const char* lwStatusName(LWStatus status);

/** The version as "major.minor.patch". */
LW_API const char* lwVersion(void);

/** Returns the first error since the last call of this function on `device`, and clears it.
 *  `device` null: the last failed call of this thread that had no (valid) device.
 *  `*message` (may be null) stays valid until this thread's next Lightwell call; never null. */
LW_API LWStatus lwGetLastError(LWDevice device, const char** message);

/* --------------------------------------------------------------------------------------- device */

typedef enum LWLogLevel { LW_LOG_INFO = 0, LW_LOG_WARNING = 1, LW_LOG_ERROR = 2 } LWLogLevel;

/** Called on the thread of the Lightwell call that logs. Must not call Lightwell. */
typedef void (*LWLogCallback)(void* user, LWLogLevel level, const char* message);

typedef struct LWDeviceDesc {
    uint32_t structSize;
    uint32_t maxComputeUnits; /**< 0: all; else a sub-device of so many, where the device can be split */
    const char* selector; /**< null: LIGHTWELL_DEVICE, else the best. "gpu", "cpu", "P:D" (indices of
                               platform and device) or a part of the platform's or device's name */
    uint32_t width;       /**< lanes per work-item 1, 4, 8, 16; 0: LIGHTWELL_WIDTH, else by probe */
    uint32_t noProfiling; /**< 1: no event timing; LWStats then reports "unavailable" (-1) */
    void* clContext;      /**< cl_context to adopt (with clQueue), or null */
    void* clQueue;        /**< cl_command_queue to adopt, in-order or out-of-order, or null. Lightwell's
                               commands run in the order of the calls in both: in an out-of-order queue each
                               is followed by a barrier, so that what is enqueued later, by the host too,
                               starts after it. What the host enqueued there *before* a call is not waited
                               for unless its events are among LWSync's */
    const char* cacheDirectory; /**< program binaries; null: LIGHTWELL_CACHE_DIR, else the user's cache
                                     directory; "" : no cache on disk */
    LWLogCallback log; /**< null: warnings and errors go to stderr */
    void* logUser;
} LWDeviceDesc;

typedef struct LWDeviceInfo {
    uint32_t structSize;
    uint32_t computeUnits;
    uint32_t width;                 /**< lanes per work-item in use */
    uint32_t isGpu, hostUnifiedMemory, hasProfiling;
    uint64_t globalMemoryBytes, maxAllocationBytes;
    uint64_t allocatedBytes;        /**< device memory that Lightwell holds now */
    uint64_t programsBuilt;         /**< programs compiled from source since creation */
    uint64_t programsLoaded;        /**< programs read from the disk cache since creation */
    uint64_t kernelsSpecialised;    /**< first launches of a (kernel, local size) since creation */
    char name[128], platform[128], driver[128], openclVersion[64];
} LWDeviceInfo;

/** Measured by lwProbeDevice. */
typedef struct LWRoofline {
    uint32_t structSize;
    uint32_t width;               /**< lanes per work-item of the probe */
    double multiplyAddGflops;     /**< 10^9 operations per second; one multiply-add counts two */
    double bandwidthGBps;         /**< 10^9 bytes per second, read + written, of a streaming triad */
    double launchMicroseconds;    /**< per dependent small kernel in one queue */
} LWRoofline;

/** Fills the descriptor with defaults (best device, own context and queue). */
LW_API void lwDefaultDevice(LWDeviceDesc* desc);

/** Creates a device. `desc` null: defaults. Blocks (context creation, width probe when not cached).
 *  Errors: NO_DEVICE, INVALID_ARGUMENT, UNSUPPORTED, OUT_OF_MEMORY, BUILD_FAILED. */
LW_API LWStatus lwCreateDevice(const LWDeviceDesc* desc, LWDevice* device);
LW_API LWStatus lwRetainDevice(LWDevice device);
/** Compiled kernels are written to the cache at lwFinish, lwGetStats, lwReadDebugView and lwPrewarm, and when
 *  the last reference to the device (its children's too) is released after all of its commands have ended.
 *  Releasing never waits. */
LW_API LWStatus lwReleaseDevice(LWDevice device);
LW_API LWStatus lwGetDeviceInfo(LWDevice device, LWDeviceInfo* info);

/** Number of OpenCL devices on this machine, and a description of each without creating it
 *  (`width`, memory and counters held are 0). */
LW_API LWStatus lwCountDevices(uint32_t* count);
LW_API LWStatus lwDescribeDevice(uint32_t index, LWDeviceInfo* info);

/** Measures the device's peak rates, and has lwPlan know them from now on. Blocks for less than two seconds. */
LW_API LWStatus lwProbeDevice(LWDevice device, LWRoofline* roofline);

/** Waits until everything enqueued on the device before this call has finished, and reports errors of its
 *  execution. */
LW_API LWStatus lwFinish(LWDevice device);

/* --------------------------------------------------------------------------------------- images */

typedef enum LWFormat {
    LW_FORMAT_NONE = 0,
    LW_FORMAT_FLOAT1 = 1,         /**< one float32: depth, validity, occlusion */
    LW_FORMAT_FLOAT2 = 2,         /**< two float32: motion */
    LW_FORMAT_FLOAT3 = 3,         /**< three float32, interleaved */
    LW_FORMAT_FLOAT4 = 4,         /**< four float32, interleaved; the fourth is ignored, or written 1 */
    LW_FORMAT_HALF4 = 5,          /**< four float16, interleaved */
    LW_FORMAT_UNORM8X4 = 6,       /**< 0..255 -> 0..1; a normal is stored as n/2 + 1/2 */
    LW_FORMAT_UNORM8X4_SRGB = 7,  /**< the same with the sRGB curve, for albedo */
    LW_FORMAT_OCT16X2 = 8,        /**< octahedral unit vector, two snorm16; both -32768: no surface */
    LW_FORMAT_PLANAR_FLOAT2 = 9,  /**< float32 planes, bytePlaneStride apart */
    LW_FORMAT_PLANAR_FLOAT3 = 10, /**< float32 planes, bytePlaneStride apart */
    LW_FORMAT_UINT8 = 11          /**< one byte: masks; zero or not */
} LWFormat;

/** A view of pixels: never owned by Lightwell. Exactly one of `host` and `clMem` is set.
 *
 *  Used in place, without copy or conversion: LW_FORMAT_PLANAR_* and LW_FORMAT_FLOAT1 whose rows are
 *  16 pixels long or a multiple of it (byteRowStride % 64 == 0), whose start is 64-byte aligned, with
 *  all rows' padding allocated, on a device that shares memory with the host (or as cl_mem). Padding up
 *  to the next multiple of 16 pixels may hold anything. An output is written in place only when that
 *  padding is its own (the row stride is the width rounded up to 16 pixels) or there is none; it is then
 *  overwritten. Everything else is unpacked, or packed, on the device; the cost stands in the stats as
 *  `gbuffer_input.*`, `rsm_input.*` and `output.*`. */
typedef struct LWImage {
    const void* host;         /**< address of pixel (0, 0) less byteOffset; written for outputs */
    void* clMem;              /**< cl_mem of the device's context, or null */
    LWFormat format;
    uint32_t width, height;   /**< pixels */
    uint64_t byteOffset;      /**< from the start of memory to pixel (0, 0) */
    int64_t bytePixelStride;  /**< 0: packed */
    int64_t byteRowStride;    /**< 0: width * pixel stride; negative: rows run bottom-up */
    int64_t bytePlaneStride;  /**< PLANAR_*: 0: height * row stride */
} LWImage;

/** Optional synchronisation with the host's own commands (cl_event each). */
typedef struct LWSync {
    uint32_t structSize;
    uint32_t waitEventCount;
    void* const* waitEvents;  /**< the call's commands start after these */
    void** signalEvent;       /**< receives an event of the call's last command; release it with
                                   clReleaseEvent */
} LWSync;

typedef enum LWDepthKind {
    LW_DEPTH_ZERO_TO_ONE = 0,     /**< clip z / w in [0,1]: Direct3D, Vulkan, Metal; reversed or not */
    LW_DEPTH_GL = 1,              /**< OpenGL's window depth in [0,1] = (clip z / w + 1) / 2 */
    LW_DEPTH_AXIAL = 2,           /**< distance along the camera axis, in world units */
    LW_DEPTH_RADIAL = 3           /**< distance from the eye, in world units (orthographic: as AXIAL, from
                                       the plane through the origin of view space) */
} LWDepthKind;

typedef struct LWCamera {
    float view[16];        /**< world -> view, row-major */
    float projection[16];  /**< view -> clip, row-major; perspective or orthographic */
} LWCamera;

/* -------------------------------------------------------------------------- what the host gives */

/** One view's G-buffer. `normal` is required, and `position` or `depth`; a technique that needs more
 *  says so in its page and refuses a G-buffer without it. All images have the view's current size. */
typedef struct LWGBuffer {
    uint32_t structSize;
    LWDepthKind depthKind;
    LWImage position;        /**< world position; 3 channels */
    LWImage depth;           /**< instead of `position`: 1 channel, with `camera` */
    LWImage normal;          /**< world normal; 3 channels; zero = no surface. With depth, pixels whose
                                  depth does not unproject to a point within reach have none either */
    LWImage albedo;          /**< diffuse reflectance in [0,1] */
    LWImage directRadiance;  /**< L_d, W/(sr m^2) */
    LWImage roughness;       /**< 1 channel, [0,1]; GGX alpha is its square. What is no number is 1 */
    LWImage motion;          /**< 2 channels: this pixel's position of the previous frame less this
                                  frame's, in pixels, +x right, +y down */
    LWImage receiveMask;     /**< 1 channel: nonzero pixels receive indirect light but send none */
    LWCamera camera, previousCamera; /**< both relative to this frame's worldOrigin */
    LWImage bakedMask;       /**< 1 channel: nonzero pixels are LW_RECEIVERS_BAKED, others LW_RECEIVERS_UNBAKED (all, where it
                                  is absent); "static_vpl" */
} LWGBuffer;

typedef enum LWLightKind {
    LW_LIGHT_DIRECTIONAL = 0,
    LW_LIGHT_POINT = 1,
    LW_LIGHT_SPOT = 2
} LWLightKind;

/** Who gets a light's or a VPL's indirect light in technique "static_vpl", where a host has baked some of it for what stands still:
 *  bits, joined by |; 0: all. A light in the baked maps has LW_RECEIVERS_UNBAKED, so that what has maps does not get it twice. */
typedef enum LWReceivers {
    LW_RECEIVERS_ALL = 0,
    LW_RECEIVERS_UNBAKED = 1, /**< what has no baked light: mostly what moves */
    LW_RECEIVERS_BAKED = 2    /**< what has (LWGBuffer::bakedMask, LWPointOutput::baked) */
} LWReceivers;

/** One reflective shadow map. Images of one size; rows and columns as the camera projects them. */
typedef struct LWRsm {
    uint32_t structSize;
    LWDepthKind depthKind;
    LWImage position;  /**< world position, or */
    LWImage depth;     /**< depth with `camera` */
    LWImage normal;    /**< world normal on the lit side; zero = nothing lit */
    LWImage flux;      /**< reflected flux of the texel, W, 0 .. 1e30: texels outside count as rejected and
                            carry nothing, as do texels whose area the camera makes infinite */
    LWCamera camera;   /**< orthographic for a directional light, perspective otherwise */
    uint64_t version;  /**< 0: read in every frame. Else a number that stands for these pixels alone: another one when they change,
                            and never the same for another map that may come to lie at the same address (one counter for all maps
                            does). A map that has version, camera and memory of the one at its place in the technique's last frame
                            is not read again, unless worldOrigin moved or a map came, went or changed its size. Technique ssvp
                            keeps its VPLs and their clusters and maps, too, once no map and no occluder has changed for 16 frames for
                            each bounce with clusters, 48 where these have more than 2,048 VPLs */
} LWRsm;

/** A light, and the surfaces it lights as RSMs: none (analytic only), one, six faces of a point light,
 *  or nested cascades of a directional light, finest first. A coarser cascade's texel whose centre
 *  lies inside a finer cascade's footprint carries no flux. */
typedef struct LWLight {
    uint32_t structSize;
    LWLightKind kind;
    float position[3];         /**< point, spot */
    float direction[3];        /**< directional, spot: the way the light travels; need not be unit */
    float irradiance[3];       /**< directional: E_perp on a plane facing the light, W/m^2 */
    float radiantIntensity[3]; /**< point, spot (on its axis): W/sr */
    float innerConeAngle, outerConeAngle; /**< spot: half angles; the intensity falls between them as
                                   glTF's KHR_lights_punctual says */
    uint32_t rsmCount;
    const LWRsm* rsms;
    uint32_t mask;             /**< which static VPLs it lights: those whose lightMask has one of these bits; 0: all. "static_vpl" */
    uint32_t receivers;        /**< LWReceivers of its indirect light */
    uint32_t profileCount;     /**< 0, or 2 .. 1024 */
    const float* profile;      /**< point, spot: factors on the intensity by the angle to `direction`, at even steps from 0 to pi,
                                    linear in between, as an IES file's vertical angles give them for a lamp that is round about its
                                    axis; host memory; or null (1). "static_vpl" */
    const float* hit;          /**< spot: xyz of where its axis first meets the scene, host memory; or null. "static_vpl" takes the
                                    middle of the light's RSM otherwise */
} LWLight;

/** A small Lambertian emitter made by the host: intensity flux / pi * cos. */
typedef struct LWVpl {
    float position[3];
    float area;       /**< m^2; bounds the light near the emitter; 0: a point */
    float normal[3];  /**< unit */
    float reserved;
    float flux[3];    /**< W, 0 .. 1e30: more would make sums overflow; lwUpdate refuses the frame */
    float reserved2;
} LWVpl;

/** A place of the scene that reflects light: what technique "static_vpl" turns into a VPL by each frame's lights. */
typedef struct LWStaticVpl {
    float position[3];
    float weight;         /**< how much surface it stands for, of LWStaticVplDesc::unitArea, to 1e18 m^2 in all; 0: a disc that reaches
                               half-way to the nearest other one */
    float normal[3];      /**< unit */
    uint32_t lightMask;   /**< which lights light it, see LWLight::mask; 0: all */
    float reflectance[3]; /**< diffuse, 0 .. 1 */
    uint32_t receivers;   /**< LWReceivers of its light */
} LWStaticVpl;

/** A sphere that dims the light passing it softly ("static_vpl"): its share is (distance of the light's path from the
 *  centre / radius)^2, all of it farther away. */
typedef struct LWBlocker {
    float center[3];
    float radius;
} LWBlocker;

/** Optional geometry: an array of surfels (small oriented discs that cover the surfaces between them), triangles, or
 *  both. Surfels with a zero normal are none; with anything else that cannot be used they are left out and counted
 *  ("rejected_surfels"). */
typedef struct LWGeometry {
    uint32_t structSize;
    uint32_t surfelCount, triangleCount;
    LWImage surfelPosition;     /**< world position; 3 channels; all images of surfels: surfelCount x 1 pixels */
    LWImage surfelNormal;       /**< world normal; 3 channels; either side blocks */
    LWImage surfelAlbedo;       /**< diffuse reflectance in [0,1]; or absent (0.5) */
    LWImage surfelEmission;     /**< radiance; or absent (0) */
    LWImage surfelArea;         /**< 1 channel, m^2, above 0: of the surface that the surfel stands for */
    const float* vertices;      /**< xyz, host memory */
    const uint32_t* indices;    /**< three per triangle; null: consecutive vertices */
    const float* triangleAlbedo;   /**< rgb per triangle, or null (0.5) */
    const float* triangleEmission; /**< rgb radiance per triangle, or null (0) */
    uint32_t vertexCount;
    uint64_t version;           /**< raise it when anything above changes; a worldOrigin that moved counts as that */
} LWGeometry;

typedef struct LWSourceView {
    LWView view;
    const LWGBuffer* gbuffer;
} LWSourceView;

typedef struct LWFrame {
    uint32_t structSize;
    uint32_t reset;            /**< 1: the scene changed discontinuously (cut, teleport); drop history */
    uint64_t frameIndex;       /**< the host's; comes back in the stats */
    uint32_t lightCount, vplCount, blockerCount, sourceViewCount;
    const LWLight* lights;
    const LWVpl* vpls;
    const LWBlocker* blockers;
    const LWSourceView* sourceViews; /**< views whose pixels feed the world part */
    const LWGeometry* geometry;
    float environment[3];      /**< radiance from infinity, constant over directions */
    const LWSync* sync;
    const float* focus;        /**< xyz in world space, host memory: what grids that do not hold all of the scene lie around,
                                    the eye or a point ahead of it ("lpv", "cone_tracing"); or null */
    const LWStaticVpl* staticVpls; /**< "static_vpl": the same places in every frame in the same order, moved or not; another
                                    count is another scene */
    uint32_t staticVplCount;   /**< 4096 at most */
    double worldOrigin[3];     /**< where the origin that all of the frame's positions and matrices are relative to lies in the world,
                                    also those of G-buffers and points until the next lwUpdate: near what is lit, and 0 in worlds of a few
                                    km. Finite, to 1e12. It may move from frame to frame: what is kept moves along */
} LWFrame;

/** Where results go; each image optional (format LW_FORMAT_NONE), at least one given. Writable host
 *  memory or cl_mem of the view's current size. A technique refuses an output it cannot make. */
typedef struct LWOutput {
    uint32_t structSize;
    LWImage irradiance;        /**< indirect diffuse irradiance, 3 channels, W/m^2; finite and 0 or more whatever
                                    the inputs hold: above 1e36 it is brought down ("saturated_pixels") */
    LWImage validity;          /**< 1 channel in [0,1]: share of the hemisphere accounted for */
    LWImage ambientOcclusion;  /**< 1 channel in [0,1]: 1 = open */
    LWImage specularRadiance;  /**< mean of the indirect radiance that arrives over the GGX lobe of alpha = roughness^2 about the mirrored
                                    view direction, weighted by n.l, before any reflectance; 3 channels, W/(sr m^2). Takes
                                    LWGBuffer::camera and `roughness` (0.5 where absent); "lpv", "cone_tracing" */
    LWImage shadow;            /**< 1 channel in [0,1]: share of one light's direct light that arrives; 1 = all; "cone_tracing" */
    const LWSync* sync;
    LWImage refractedRadiance; /**< the indirect radiance that arrives along the refracted view direction, about as wide as
                                    `roughness` makes it, before any transmittance; 3 channels, W/(sr m^2). Takes
                                    LWGBuffer::camera and `roughness`; "cone_tracing" */
} LWOutput;

/** Where the light at points goes (lwRenderPoints): writable host memory or cl_mem; each image optional, at least one of the
 *  three given. */
typedef struct LWPointOutput {
    uint32_t structSize;
    LWImage irradiance; /**< indirect diffuse irradiance at each point's normal, 3 channels, count x 1 pixels, W/m^2 */
    LWImage harmonics;  /**< the indirect radiance that arrives, in two bands of spherical harmonics, 3 channels, count x 4 pixels:
                             rows c0, c1.x, c1.y, c1.z of L(d) = Y0 c0 + Y1 (c1 . d), d towards the light,
                             Y0 = 1 / (2 sqrt(pi)), Y1 = sqrt(3 / (4 pi)). Irradiance of a normal n:
                             max(0, pi Y0 c0 + (2 pi / 3) Y1 (c1 . n)) */
    LWImage validity;   /**< 1 channel in [0,1], count x 1 pixels */
    const LWSync* sync;
    uint32_t baked;     /**< 1: the points are LW_RECEIVERS_BAKED; "static_vpl" */
} LWPointOutput;

/* ---------------------------------------------------------------------------------------- views */

typedef struct LWViewDesc {
    uint32_t structSize;
    uint32_t maxWidth, maxHeight; /**< 1 .. 16384 each; memory is reserved for this size */
} LWViewDesc;

/** Creates a view whose current size is the maximum. Errors: INVALID_ARGUMENT, OUT_OF_MEMORY. */
LW_API LWStatus lwCreateView(LWDevice device, const LWViewDesc* desc, LWView* view);
LW_API LWStatus lwRetainView(LWView view);
LW_API LWStatus lwReleaseView(LWView view);

/** Changes the current size, up to the maximum, without allocating (dynamic resolution). */
LW_API LWStatus lwSetViewSize(LWView view, uint32_t width, uint32_t height);
LW_API LWStatus lwGetViewSize(LWView view, uint32_t* width, uint32_t* height);

/* ----------------------------------------------------------------------------------- techniques */

/** Of the pixels that a technique gathers; what lies between them is up-sampled along surfaces. */
typedef enum LWResolution {
    LW_RESOLUTION_FULL = 0,
    LW_RESOLUTION_HALF = 1,   /**< every second pixel and row */
    LW_RESOLUTION_QUARTER = 2 /**< every fourth pixel and row: of "rsm", "ssvp" and "static_vpl" alone */
} LWResolution;

typedef enum LWVplSampling {
    LW_SAMPLING_FLUX = 0,    /**< Hammersley set warped by the flux distribution of all RSMs */
    LW_SAMPLING_UNIFORM = 1, /**< Hammersley set over the texels */
    LW_SAMPLING_VIEW = 2     /**< several times as many by flux, and of those a choice by what they bring the surfaces that
                                  LWFrame::sourceViews show (not which of those they see); lwUpdate fails without such a view */
} LWVplSampling;

/** What stands between a VPL of technique "rsm" and a pixel. */
typedef enum LWRsmVisibility {
    LW_RSM_VISIBILITY_NONE = 0, /**< nothing */
    LW_RSM_VISIBILITY_VOXEL = 1 /**< the voxels that LWGeometry's triangles, else its surfels, else all texels of RSMs and pixels
                                     of LWFrame::sourceViews occupy */
} LWRsmVisibility;

/** Technique "rsm": virtual point lights from reflective shadow maps, gathered without visibility or with that of a grid. */
typedef struct LWRsmDesc {
    uint32_t structSize;
    uint32_t vpls;           /**< drawn from all RSMs together; 0: every texel */
    LWVplSampling sampling;
    uint32_t interleave;     /**< n of n x n: each pixel takes 1/n^2 of the VPLs, then a filter; 1, 2, 4, 8 */
    uint32_t filter;         /**< 1: the edge-aware n x n filter; 0: the raw interleaved image */
    LWResolution resolution; /**< HALF, QUARTER: gathered on every second or fourth pixel and row, then up-sampled */
    uint32_t seed;           /**< shifts the sample set (Cranley-Patterson); 0: unshifted */
    uint32_t history;        /**< 0: each frame alone; else the light is a mean over up to so many frames (64 at most), and
                                  their sample sets differ. Needs LWGBuffer::camera; takes LWGBuffer::motion, if given */
    float historyClamp;      /**< how far a pixel's history may lie from its frame's light, in deviations of that light over
                                  time and in its neighbourhood; 0: as far as it likes */
    LWRsmVisibility visibility;
    uint32_t voxels;         /**< of visibility VOXEL: a side of the grid, fitted to the scene; 32, 64, 128, 256 */
    float autoResolution;    /**< above 0: gathered as HALF, whatever `resolution` says; then pixels around which the light found there
                                  differs by more than this share of it, or has no sample on their surface, are gathered by
                                  themselves, of all VPLs: at most a 32nd of the pixels. 0: never; 0 .. 10 */
} LWRsmDesc;

LW_API void lwDefaultRsm(LWRsmDesc* desc);

typedef enum LWVisibility {
    LW_VISIBILITY_NONE = 0, /**< every VPL lights every surface that faces it */
    LW_VISIBILITY_HARD = 1, /**< the nearest texel of the cluster's map decides */
    LW_VISIBILITY_SOFT = 2, /**< the share of its four nearest texels (percentage-closer) */
    LW_VISIBILITY_VOXEL = 3, /**< instead of maps, the voxels that the occluders occupy, between each VPL and the pixel */
    LW_VISIBILITY_STRICT = 4, /**< as HARD; light past the rims of what stands before it counts as far as the rest of a place's light bears it out */
    LW_VISIBILITY_CAREFUL = 5 /**< ssvp's: as STRICT; where 2 <= shadowedBounces < bounces, later ones count as far as shadowed light bears out, or a quarter */
} LWVisibility;

typedef enum LWDirections {
    LW_DIRECTIONS_COSINE = 0, /**< by the cosine at the cluster: every VPL carries the same share of its flux */
    LW_DIRECTIONS_DISC = 1,   /**< evenly over the map's disc (Aranha et al. 2020) */
    LW_DIRECTIONS_SQUARE = 2  /**< evenly over the square about it: a fifth of the VPLs is lost */
} LWDirections;

/** What the maps of technique "ssvp" show. Asking for what a frame does not bring is an error of lwUpdate. */
typedef enum LWOccluders {
    LW_OCCLUDERS_AUTO = 0,      /**< the frame's triangles, else its surfels, else as SCREEN; the stats say which */
    LW_OCCLUDERS_TRIANGLES = 1, /**< LWGeometry's triangles, exactly */
    LW_OCCLUDERS_SURFELS = 2,   /**< LWGeometry's surfels as discs; without any, its triangles sampled to surfels */
    LW_OCCLUDERS_SCREEN = 3     /**< the texels of all RSMs and the pixels of LWFrame::sourceViews as discs, in every
                                     frame anew; what neither shows blocks nothing */
} LWOccluders;

/** Technique "ssvp": VPLs in clusters, each cluster's visibility in a paraboloid map of what stands around it
 *  (LWOccluders), a second bounce drawn from the maps. */
typedef struct LWSsvpDesc {
    uint32_t structSize;
    uint32_t vpls;           /**< of the first bounce, drawn from all RSMs together */
    LWVplSampling sampling;
    uint32_t clusters;       /**< 1 .. 64; 0: every VPL its own, with a map each */
    uint32_t mapSize;        /**< texels a side of a cluster's map: 64 .. 512, a multiple of 16 */
    LWVisibility visibility;
    uint32_t bounces;        /**< 1 .. 4 */
    uint32_t shadowedBounces; /**< 1 .. 4: bounces whose light `visibility` shadows; the VPLs of each but the first are put into as
                                  many clusters (64 where `clusters` is 0) with maps of their own. Light of later bounces
                                  goes through walls, a quarter or more of it with LW_VISIBILITY_CAREFUL and 2 or more here */
    uint32_t secondVpls;     /**< of the second and of each further bounce, for each cluster of the bounce before */
    LWDirections directions; /**< in which a cluster's second-bounce VPLs are drawn */
    uint32_t warmStart;      /**< 1: clusters start where they were in the frame before */
    uint32_t interleave;     /**< as LWRsmDesc's */
    uint32_t clusterGroups;  /**< 1, 2, 4, .. 64: a pixel is lit by one of so many groups of clusters, and its neighbours in the
                                  interleave's window by the others. Look-ups fall in proportion; what the filter does not mix
                                  shows. More than the window has pixels: as many as that */
    uint32_t filter;         /**< as LWRsmDesc's */
    LWResolution resolution; /**< as LWRsmDesc's */
    uint32_t seed;           /**< shifts the sample sets; 0: unshifted */
    LWOccluders occluders;   /**< what the maps show */
    float autoError;         /**< above 0: `vpls`, `clusters` and `bounces` are the most there may be, and each frame takes
                                  as many as an error of the picture of this much (relative, root mean square) asks for;
                                  the stats say how many, and why. 0: always the most */
    uint32_t history;        /**< as LWRsmDesc's */
    float historyClamp;      /**< as LWRsmDesc's */
    uint32_t compensation;   /**< 0 .. 64: samples a pixel of the surfaces around it on the screen, which make up for near light
                                  that VPLs of some size lack; 0: none. Above 0 the G-buffer needs `directRadiance`, of the
                                  lights that have RSMs, and `camera`. Not with LW_SAMPLING_VIEW */
    uint32_t voxels;         /**< as LWRsmDesc's */
    float autoResolution;    /**< as LWRsmDesc's; not with `compensation` */
} LWSsvpDesc;

LW_API void lwDefaultSsvp(LWSsvpDesc* desc);

/** Technique "fallback": E = E1 + (1 - v1) E2, where v1 is the share of a pixel's hemisphere that the first technique
 *  vouches for (its output `validity`) and E2 is what the second one would make of the whole hemisphere: its light is
 *  taken to come evenly from all directions. Validity of the sum: v1 + (1 - v1) v2.
 *
 *  It keeps both alive, and drives them: its lwUpdate and lwRender are theirs with the same arguments. A host that updates
 *  or renders them itself in between changes what the next lwRender sees. Should the second refuse a frame that the first
 *  has accepted, or lwUpdate of either fail half-way, lwRender answers LW_ERROR_NOT_UPDATED until both have accepted one. Stats and debug views have their names
 *  behind "first." and "second.". */
typedef struct LWFallbackDesc {
    uint32_t structSize;
    LWTechnique first, second; /**< of the same device; different ones, that share no part. Neither has a default */
} LWFallbackDesc;

LW_API void lwDefaultFallback(LWFallbackDesc* desc);

/** Resolution of the first level that technique "screen_space" gathers. */
typedef enum LWStart { LW_START_FULL = 0, LW_START_HALF = 1, LW_START_QUARTER = 2 } LWStart;

/** Technique "screen_space": light between the surfaces that the camera sees, from LWGBuffer::directRadiance, without
 *  visibility. Needs the G-buffer's camera, also with positions. Pixels of `receiveMask` receive and send nothing. */
typedef struct LWScreenSpaceDesc {
    uint32_t structSize;
    LWStart start;           /**< each level has half the columns and rows of the one before */
    uint32_t levels;         /**< 1 .. 6. Reach in pixels: 2 radius * 2^(levels - 1) * (1, 2, 4 by `start`) */
    uint32_t samples;        /**< per texel and level: 8, 16, 32, 64, 128, 256 */
    float radius;            /**< 1 .. 64: inner radius of the ring that a level samples, the outer one being twice that, in
                                  texels of the level for an image 720 rows high; of another, in proportion to its rows */
    uint32_t interleave;     /**< n of n x n: so many texels along each axis have sample patterns of their own, then a filter
                                  of that size; 1, 2, 4 */
    uint32_t bounded;        /**< 1: form factors of discs; 0: of points, with spikes */
    uint32_t cameras;        /**< 1: also the light between what each of LWFrame::sourceViews shows; the larger of both where
                                  it shows the view's own surface. A view takes nothing from a source with its own handle */
    uint32_t seed;           /**< shifts the sample patterns; 0: unshifted */
    uint32_t history;        /**< as LWRsmDesc's, of irradiance and validity; takes LWGBuffer::motion, if given */
    float historyClamp;      /**< as LWRsmDesc's */
    float autoError;         /**< above 0: `samples` and `levels` are the most and `start` is the finest there may be, and each
                                  frame takes what this relative error of the picture asks for, against the picture with the
                                  most; 0: always the most; 0 .. 1 */
} LWScreenSpaceDesc;

LW_API void lwDefaultScreenSpace(LWScreenSpaceDesc* desc);

/** What ambient occlusion counts of the hemisphere's directions. */
typedef enum LWAmbientWeighting {
    LW_AMBIENT_COSINE = 0, /**< by their cosine: the share of an evenly bright sky's irradiance that arrives */
    LW_AMBIENT_UNIFORM = 1 /**< all alike */
} LWAmbientWeighting;

/** Technique "horizon": ambient occlusion and light of one bounce from what the view itself shows, in slices of the
 *  hemisphere with a visibility bitmask each. Needs the G-buffer's camera, and directRadiance for irradiance or
 *  validity; makes ambientOcclusion too. Validity is the share of the cosine-weighted hemisphere whose
 *  light the view shows. Lengths are shares of the image's height at the pixel's own depth. */
typedef struct LWHorizonDesc {
    uint32_t structSize;
    uint32_t directions;     /**< slices: 4, 8, 16, 24, 40, 48 */
    uint32_t steps;          /**< along each side of a slice, every time that the distance doubles: 1, 2, 4, 8 */
    uint32_t interleave;     /**< rows of pixels that share out the slices, then a filter over them; 1, 2, 4, 8, 16; or the most that do so evenly */
    uint32_t filter;         /**< 1: the edge-aware filter over those rows; 0: the raw image */
    LWResolution resolution; /**< HALF: gathered on every second pixel and row, then up-sampled */
    float reach;             /**< how far a pixel looks; above 0 .. 4 */
    float thickness;         /**< of everything along the view: what passes behind it is light; 0 .. 10 */
    float ambientRadius;     /**< what ambient occlusion counts lies nearer; above 0 .. 1e6 */
    LWAmbientWeighting weighting; /**< of ambient occlusion; light is always weighted by the cosine */
    uint32_t history;        /**< frames in a mean of all three outputs, each with another pattern; 0 .. 64. More than 0 needs
                                  LWGBuffer::motion where things move */
    float historyClamp;      /**< as LWRsmDesc's */
} LWHorizonDesc;

LW_API void lwDefaultHorizon(LWHorizonDesc* desc);

typedef enum LWAoMethod {
    LW_AO_SSAO = 0, /**< ambient occlusion alone */
    LW_AO_SSDO = 1  /**< and one bounce from what occludes */
} LWAoMethod;

/** Technique "ao": ambient occlusion from points in the hemisphere that the view shows to be hidden (SSAO), and light of
 *  one bounce from the surfaces that hide them (SSDO): the older estimators that "horizon" is measured against. Needs the
 *  G-buffer's camera; with SSDO directRadiance too, for irradiance or validity. */
typedef struct LWAoDesc {
    uint32_t structSize;
    LWAoMethod method;
    uint32_t samples;        /**< points in each pixel's hemisphere; 4 .. 64 */
    float radius;            /**< of the hemisphere, in image heights at the pixel's depth; above 0 .. 10 */
    uint32_t packing;        /**< 1: points crowd towards the pixel, with the square of their number; 0: all at the radius */
    uint32_t rangeCheck;     /**< 1: what lies nearer to the eye than the point by more than the radius does not hide it */
    uint32_t filter;         /**< 1: the edge-aware 4 x 4 blur that the 4 x 4 rotations of the points need */
    LWResolution resolution; /**< HALF: on every second pixel and row, then up-sampled */
    LWAmbientWeighting weighting; /**< how points are spread over directions */
    uint32_t history;        /**< frames in a mean of all three outputs, each with another pattern; 0 .. 64. More than 0 needs
                                  LWGBuffer::motion where things move */
    float historyClamp;      /**< as LWRsmDesc's */
} LWAoDesc;

LW_API void lwDefaultAo(LWAoDesc* desc);

/** What blocks light between the cells of technique "lpv". Asking for what a frame does not bring is an error of lwUpdate. */
typedef enum LWGeometryVolume {
    LW_GEOMETRY_VOLUME_OFF = 0,       /**< nothing: light goes through walls */
    LW_GEOMETRY_VOLUME_AUTO = 1,      /**< the frame's triangles, else its surfels, else as SCREEN; the stats say which */
    LW_GEOMETRY_VOLUME_TRIANGLES = 2, /**< LWGeometry's triangles: as surfels sampled from them, of cascades on each grid's lattice */
    LW_GEOMETRY_VOLUME_SURFELS = 3,   /**< LWGeometry's surfels; without any, its triangles */
    LW_GEOMETRY_VOLUME_SCREEN = 4     /**< the texels of all RSMs and the pixels of LWFrame::sourceViews */
} LWGeometryVolume;

/** How technique "lpv" carries light through its grid. */
typedef enum LWLpvTransport {
    LW_LPV_TRANSPORT_PROPAGATE = 0, /**< from cell to cell, as light propagation volumes do: short range */
    LW_LPV_TRANSPORT_SWEEP = 1,     /**< straight through the grid in a fixed set of directions, stopped by LWGeometry's triangles,
                                         else its surfels, else the RSMs' texels; `size` at most 64 */
    LW_LPV_TRANSPORT_COARSE_TO_FINE = 2 /**< from cell to cell on a pyramid of grids, a few steps on each */
} LWLpvTransport;

/** Technique "lpv": the light of RSMs and authored VPLs spread through a cubic grid of cells, as two bands of spherical
 *  harmonics, step by step (light propagation volumes). Pixels outside of the grid have validity 0. */
typedef struct LWLpvDesc {
    uint32_t structSize;
    uint32_t size;    /**< cells a side: 16, 32, 64, 128 */
    uint32_t steps;   /**< of propagation, 1 .. 1024; 0: twice `size` */
    float extent;     /**< length of the grid's sides, to 1e9; 0: fitted to the surfaces that RSMs see (lit or not), authored
                           VPLs and the vertices of the frame's triangles. A fitted grid stays from frame to frame as long as
                           they lie in it and fill three quarters of it; LWFrame::reset fits anew */
    float center[3];  /**< of the grid where `extent` is above 0 and the frame has no focus: a point of the world, not relative to
                           LWFrame::worldOrigin */
    LWGeometryVolume geometryVolume; /**< what blocks light between cells, of propagation; sweeps choose as LWLpvTransport says */
    uint32_t damping; /**< 1: light that grows weaker away from a surface is taken for light from behind it, and damped */
    LWLpvTransport transport;
    uint32_t directions; /**< of sweeps: 24, 48, 96, 216, 384, 864, 1536 */
    uint32_t bounces;    /**< of sweeps: 1 .. 8, from the second on by what the triangles or surfels send on */
    uint32_t frames;     /**< that each bounce of a sweep is spread over: 1, 2, 4, 6, 8, 12, 24; the last result shows meanwhile */
    LWResolution resolution; /**< HALF: light is read on every second pixel and row, then up-sampled; validity of every pixel */
    uint32_t cascades;   /**< 1 .. 6 grids of `size` cells, each half as large as the one around it, `extent` the largest one's;
                              the finer ones lie around LWFrame::focus, else in the middle, at whole cells of their own */
    float autoError;     /**< of propagation, above 0: `steps` is the most, and light that is still on its way is dropped once it
                              is less than this share of all; 0: always all steps; 0 .. 1 */
    uint32_t rests;      /**< 1: light that is as it was in the frame before is not carried again, with the same result; of one grid
                              in one frame. 0: always */
} LWLpvDesc;

LW_API void lwDefaultLpv(LWLpvDesc* desc);

/** What the voxels of technique "cone_tracing" hold above the finest level. */
typedef enum LWVoxelMode {
    LW_VOXEL_MODE_ISOTROPIC = 0,   /**< one radiance and opacity for all directions */
    LW_VOXEL_MODE_ANISOTROPIC = 1, /**< one for each of the six axis directions */
    LW_VOXEL_MODE_SH2 = 2          /**< radiance in two bands of spherical harmonics, opacity for all directions */
} LWVoxelMode;

/** What is made voxels of by technique "cone_tracing". Asking for what a frame does not bring is an error of lwUpdate. */
typedef enum LWVoxelSource {
    LW_VOXEL_SOURCE_AUTO = 0,      /**< the frame's triangles, else its surfels, else as SCREEN; the stats say which */
    LW_VOXEL_SOURCE_TRIANGLES = 1, /**< LWGeometry's triangles, every voxel that they touch */
    LW_VOXEL_SOURCE_SURFELS = 2,   /**< LWGeometry's surfels */
    LW_VOXEL_SOURCE_SCREEN = 3     /**< the texels of all RSMs and the pixels of LWFrame::sourceViews, in every frame anew */
} LWVoxelSource;

/** On which pixels technique "cone_tracing" traces. */
typedef enum LWConeResolution {
    LW_CONE_RESOLUTION_FULL = 0,
    LW_CONE_RESOLUTION_HALF = 1,       /**< on every second pixel and row, then up-sampled */
    LW_CONE_RESOLUTION_QUARTER = 2,    /**< on every fourth pixel and row, then up-sampled */
    LW_CONE_RESOLUTION_INTERLEAVED = 3, /**< on all, a share of the cones each, then a filter over the pixels that have all:
                                             3 x 3 for 9 cones */
    LW_CONE_RESOLUTION_HALF_INTERLEAVED = 4 /**< on every second pixel and row, a share of the cones each, filtered, then
                                                 up-sampled */
} LWConeResolution;

/** Between how many voxels the samples of technique "cone_tracing" are interpolated. */
typedef enum LWConeInterpolation {
    LW_CONE_INTERPOLATION_TRILINEAR = 0,  /**< eight */
    LW_CONE_INTERPOLATION_TETRAHEDRAL = 1 /**< the four of the tetrahedron that a sample lies in: less time, a little more error */
} LWConeInterpolation;

/** What ambient occlusion from voxels dims of the light of technique "cone_tracing". */
typedef enum LWConeOcclusion {
    LW_CONE_OCCLUSION_OFF = 0, /**< nothing: the light has come past the voxels already */
    LW_CONE_OCCLUSION_ALL = 1, /**< all of it, so that what is hidden counts twice: the source's */
    LW_CONE_OCCLUSION_NEAR = 2 /**< all of it, by what stands nearer than where light's cones begin */
} LWConeOcclusion;

/** Technique "cone_tracing": the scene as voxels, lit by the RSMs, followed from each pixel in a few cones (voxel cone
 *  tracing). Makes irradiance, validity, ambientOcclusion, specularRadiance, refractedRadiance and shadow. */
typedef struct LWConeTracingDesc {
    uint32_t structSize;
    uint32_t size;           /**< voxels a side: 32, 64, 128, 256 */
    LWVoxelMode mode;
    uint32_t cones;          /**< of diffuse light: 6, 9; 16, 64, 256: narrower ones, all of the same weight */
    LWConeResolution resolution;
    uint32_t cascades;       /**< 1 .. 4 grids of `size` voxels, each half as large as the one around it, `extent` the largest
                                  one's; the finer ones lie around LWFrame::focus, else in the middle, at multiples of an eighth of
                                  their own sides */
    float extent;            /**< as LWLpvDesc's */
    float center[3];         /**< as LWLpvDesc's */
    LWVoxelSource source;
    uint32_t bounces;        /**< 1; or 0: all of them, each frame adding to the voxels what the last one's send on */
    uint32_t sparse;         /**< 1: only bricks of voxels that hold something are stored and filtered; 0: all */
    float nudge;             /**< where cones begin, in voxels along the normal; 0 .. 8 */
    float step;              /**< of a cone, in the cells that it reads; 0.125 .. 1. Less: time, fewer bands */
    float distance;          /**< that cones reach, in sides of the largest grid; above 0 .. 2 */
    uint32_t opacityCorrection;  /**< 1: opacity follows the length of steps; 0: each step takes its voxel's as it is */
    uint32_t directionalOpacity; /**< 1: the finest voxels too have an opacity for each axis, of what they show that way */
    uint32_t apertureOffset;     /**< 1: cones begin further off the wider they are, so that none takes light from its own surface */
    uint32_t normalAware;        /**< 1: a voxel whose surfaces all face away from a cone sends it nothing, nor stops it; 2: it stops it */
    LWConeOcclusion occlusion;
    float occlusionDistance; /**< within which ambient occlusion counts what it meets, less with distance; in sides of the
                                  largest grid, above 0 .. 2 */
    uint32_t shadowLight;    /**< index in LWFrame::lights of the one whose `shadow` is asked for */
    float shadowAngle;       /**< full angle of its cone, in radians; above 0 .. 1.5: the angle that the light's source fills */
    float refractiveIndex;   /**< of what `refractedRadiance` is seen through, to that around it; 1 .. 4 */
    LWConeInterpolation interpolation;
} LWConeTracingDesc;

LW_API void lwDefaultConeTracing(LWConeTracingDesc* desc);

/** What spot lights light in technique "static_vpl"; lights of other kinds always light the static VPLs. */
typedef enum LWStaticVplVariant {
    LW_STATIC_VPL_STATIC = 0, /**< LWFrame::staticVpls */
    LW_STATIC_VPL_PHANTOM = 1 /**< one VPL each, where its axis first meets the scene (LWLight::hit, else the middle texel of its
                                   first RSM), with normal, reflectance and area of the static VPLs around. One that has
                                   neither lights the static VPLs */
} LWStaticVplVariant;

/** Technique "static_vpl": places of the scene that the host chose (LWFrame::staticVpls) become VPLs by the frame's lights, past
 *  soft spheres (LWFrame::blockers, 1024 at most). Needs no RSM. Also as a list of lights: lwReadLightList. */
typedef struct LWStaticVplDesc {
    uint32_t structSize;
    LWStaticVplVariant variant;
    uint32_t bounces;         /**< 1; or 2: the light of VPLs comes back once more, from one VPL opposite all of the static ones
                                   and one opposite each phantom */
    float averageReflectance; /**< of what lies opposite, 0 .. 1 */
    float secondDistance;     /**< of the VPL opposite the static ones from their middle, m, to 1e9; 0: a mean side of their bounding box.
                                   One opposite a phantom lies at 1.5 times its light's distance */
    float secondArea;         /**< m^2 of what lies opposite, to 1e18: it catches min(1, secondArea / (pi distance^2)) of the light; 0: all */
    float unitArea;           /**< m^2 that a weight of 1 stands for, above 0 .. 1e18 */
    uint32_t automaticWeights; /**< 1: as if all weights were 0 */
    uint32_t comparisons;     /**< of weights that are 0: distances looked at a frame, 1 .. 2^24. A whole number of VPLs is done in each
                                   frame, 16 at least; after one round at rest all are exact. New VPLs are done at once */
    float cullRelative;       /**< VPLs weaker than this share of the strongest are left out, the strongest as if nothing blocked
                                   its light; 0 .. 1 */
    float cullAbsolute;       /**< above 0: instead, those weaker than this, W/sr; to 1e30 */
    float hysteresis;         /**< how much stronger than that a VPL must be to come back, a factor of 1 .. 100 */
    float smoothing;          /**< share of its last frame's place and look that a phantom keeps; 0 .. 0.99 */
    uint32_t lights;          /**< that lwReadLightList hands out at most, 1 .. 64 */
    uint32_t interleave;      /**< as LWRsmDesc's */
    uint32_t filter;          /**< as LWRsmDesc's */
    LWResolution resolution;  /**< as LWRsmDesc's */
    LWVisibility visibility;  /**< what stands between VPLs and what they light: nothing (the default), or LWFrame::geometry in paraboloid
                                   maps or voxels, as LWSsvpDesc's but CAREFUL. A frame without geometry is then an error of lwUpdate */
    uint32_t clusters;        /**< VPLs of a frame up to this many see for themselves; more are put into so many clusters, and a
                                   cluster's share what its middle one sees. 1 .. 64; 0: every VPL sees for itself */
    uint32_t mapSize;         /**< as LWSsvpDesc's */
    LWOccluders occluders;    /**< AUTO, TRIANGLES or SURFELS, as LWSsvpDesc's */
    float lift;               /**< how far off its surface a VPL looks from, as a share of the radius of the disc that it stands for: one
                                   that lies a little inside is not in the dark for it. 0 .. 1 */
    uint32_t shadowedBounces; /**< 1: light of the VPLs opposite goes through walls, as these lie where nothing may be; 2: it does not */
    uint32_t voxels;          /**< as LWRsmDesc's */
} LWStaticVplDesc;

LW_API void lwDefaultStaticVpl(LWStaticVplDesc* desc);

/** The name of the technique that chooses others; "auto" for lwCreateTechnique. */
#define LW_TECHNIQUE_AUTO "auto"

/** Technique "auto": in each frame the technique and parameters that lwPlan finds best for what the frame brings (without VPLs drawn for source views), kept until
 *  another is clearly better or the budget is broken; changes are cross-faded. Stats say which, and why. The first on a device measures its rates, as lwPlan. */
typedef struct LWAutoDesc {
    uint32_t structSize;
    float budgetMs;          /**< of a frame: lwUpdate and all of its lwRender, on the device's clock (the host's, where the device has none
                                  for it); 0: no limit */
    float errorTarget;       /**< relMSE against all bounces: no dearer than what is predicted to reach it; 0: the least error that the
                                  budget buys */
    uint32_t views;          /**< that a frame renders: 2 for stereo */
    uint32_t fade;           /**< frames over which a change of technique is spread, 3 at most where the budget has no room for its time; 0: at once */
    uint32_t patience;       /**< frames for which something better must have been better; what breaks the budget goes sooner */
    float gain;              /**< how much better: the predicted error of the new one is less than the old one's divided by 1 plus this */
} LWAutoDesc;

LW_API void lwDefaultAuto(LWAutoDesc* desc);

/* A technique's parameters, described for tools: the command line's --set and every chart read them
 * here, so a new technique needs no other registration. */
typedef enum LWParameterKind {
    LW_PARAMETER_UINT = 0,  /**< uint32_t */
    LW_PARAMETER_FLOAT = 1, /**< float */
    LW_PARAMETER_ENUM = 2,  /**< int32_t; `choices` lists the names, the value is the index */
    LW_PARAMETER_BOOL = 3,  /**< uint32_t, 0 or 1 */
    LW_PARAMETER_TECHNIQUE = 4 /**< LWTechnique; `choices` lists techniques that a tool may make for it, `defaultValue` is
                                    the index of the one to begin with */
} LWParameterKind;

typedef struct LWParameter {
    const char* name;          /**< the descriptor's field in snake_case */
    const char* description;   /**< one line: meaning, unit, what raising it buys and costs */
    LWParameterKind kind;
    uint32_t byteOffset;       /**< of the field in the descriptor */
    double minimum, maximum, defaultValue;
    const char* const* choices; /**< ENUM, TECHNIQUE: null-terminated names; BOOL, UINT, FLOAT: null */
    const double* allowed;     /**< UINT: the only valid values, or null for the whole range */
    uint32_t allowedCount;
    const double* sweep;       /**< values worth charting (of an ENUM or TECHNIQUE the indices), or null: the default */
    uint32_t sweepCount;
} LWParameter;

/** A set of parameters worth naming in charts: a paper's own, a usual compromise. */
typedef struct LWSetting {
    const char* name;          /**< whose or what for, a few words */
    const char* assignments;   /**< "vpls=400 interleave=1": what differs from the defaults, separated by
                                    spaces; enumerations by name, BOOL by on and off */
} LWSetting;

typedef struct LWTechniqueInfo {
    uint32_t structSize;
    uint32_t descSize;         /**< sizeof the descriptor */
    const char* name;          /**< "rsm", ... */
    const char* summary;       /**< one line */
    const LWParameter* parameters;
    uint32_t parameterCount;
    void (*setDefaults)(void* desc); /**< lwDefaultRsm and its kin */
    uint32_t bounces;          /**< indirect bounces that it models, 0: all of them; where there is a
                                    parameter `bounces`, that parameter says it */
    const LWSetting* settings; /**< beside the sweeps of the parameters; or null */
    uint32_t settingCount;
    uint32_t points;           /**< 1: lwRenderPoints can have its light */
    uint32_t lightList;        /**< 1: lwReadLightList can have its light */
} LWTechniqueInfo;

LW_API uint32_t lwCountTechniques(void);
/** Strings and arrays in `info` live as long as the library. */
LW_API LWStatus lwDescribeTechnique(uint32_t index, LWTechniqueInfo* info);

/** Creates a technique by name with its descriptor (null: defaults).
 *  Errors: INVALID_ARGUMENT (unknown name: the message lists the valid ones; a parameter out of range),
 *  OUT_OF_MEMORY, BUILD_FAILED. */
LW_API LWStatus lwCreateTechnique(LWDevice device, const char* name, const void* desc,
                                  LWTechnique* technique);
LW_API LWStatus lwCreateRsm(LWDevice device, const LWRsmDesc* desc, LWTechnique* technique);
LW_API LWStatus lwCreateSsvp(LWDevice device, const LWSsvpDesc* desc, LWTechnique* technique);
LW_API LWStatus lwCreateFallback(LWDevice device, const LWFallbackDesc* desc, LWTechnique* technique);
LW_API LWStatus lwCreateScreenSpace(LWDevice device, const LWScreenSpaceDesc* desc, LWTechnique* technique);
LW_API LWStatus lwCreateHorizon(LWDevice device, const LWHorizonDesc* desc, LWTechnique* technique);
LW_API LWStatus lwCreateAo(LWDevice device, const LWAoDesc* desc, LWTechnique* technique);
LW_API LWStatus lwCreateLpv(LWDevice device, const LWLpvDesc* desc, LWTechnique* technique);
LW_API LWStatus lwCreateConeTracing(LWDevice device, const LWConeTracingDesc* desc, LWTechnique* technique);
LW_API LWStatus lwCreateStaticVpl(LWDevice device, const LWStaticVplDesc* desc, LWTechnique* technique);
LW_API LWStatus lwCreateAuto(LWDevice device, const LWAutoDesc* desc, LWTechnique* technique);
/** Creates a technique by name from text: "vpls=256 interleave=4", as LWSetting and LWPlan have it; what it does not name has its
 *  default (null or "": all). Of a technique that joins others: "first=horizon second=ssvp second.vpls=256", which makes those too.
 *  Errors: as lwCreateTechnique; INVALID_ARGUMENT names the key and what is valid. */
LW_API LWStatus lwCreateTechniqueFromText(LWDevice device, const char* name, const char* settings, LWTechnique* technique);
LW_API LWStatus lwRetainTechnique(LWTechnique technique);
LW_API LWStatus lwReleaseTechnique(LWTechnique technique);

/** Device bytes that the technique will hold for one view of this size at its maximum and one square RSM of
 *  `rsmTexels` texels, without creating anything: the most it can be, for inputs and outputs that all have to
 *  be unpacked (and, on a device that does not share memory with the host, copied; without gaps between their
 *  rows). More texels than frames may have are refused alike. */
LW_API LWStatus lwEstimateMemory(LWDevice device, const char* name, const void* desc,
                                 const LWViewDesc* view, uint64_t rsmTexels, uint64_t* bytes);
/** The same for this frame's RSMs, whose sizes are those of their flux images, and its own VPLs. The frame is
 *  checked as lwUpdate checks it, images and cameras apart: pixels are not read and may be absent. */
LW_API LWStatus lwEstimateFrameMemory(LWDevice device, const char* name, const void* desc,
                                      const LWViewDesc* view, const LWFrame* frame, uint64_t* bytes);

/** Builds and launches once every kernel that the technique can need for this view, so that no later
 *  frame compiles anything, of whatever size. Blocks. */
LW_API LWStatus lwPrewarm(LWTechnique technique, LWView view);

/** Enqueues the world part of a frame: draws VPLs, fills volumes. Errors: INVALID_*, OUT_OF_MEMORY. */
LW_API LWStatus lwUpdate(LWTechnique technique, const LWFrame* frame);

/** Enqueues one view's indirect light from the last lwUpdate. The G-buffer's images must have the
 *  view's current size. Errors: INVALID_*, NOT_UPDATED, OUT_OF_MEMORY. */
LW_API LWStatus lwRender(LWTechnique technique, LWView view, const LWGBuffer* gbuffer,
                         const LWOutput* output);

/** Enqueues the indirect light at `count` points from the last lwUpdate: of objects that are lit forward, particles, probes.
 *  `positions`, `normals`: 3 channels, world space, count x 1 pixels, 4194240 at most. `normals` may be null where irradiance is not
 *  asked for; given, "lpv" reads half a cell off the surface, else at the point. A point without a finite position or with a zero
 *  normal gets 0 and validity 0, and is counted ("rejected_points"). LWTechniqueInfo::points says who can. docs/points.md has more.
 *  Errors: INVALID_*, UNSUPPORTED, NOT_UPDATED, OUT_OF_MEMORY. */
LW_API LWStatus lwRenderPoints(LWTechnique technique, const LWImage* positions, const LWImage* normals, uint32_t count,
                               const LWPointOutput* output);

/** A light that stands for VPLs of "static_vpl", for renderers that light with their own shaders. */
typedef struct LWListedLight {
    float position[3];      /**< mean of its VPLs' by flux */
    float area;             /**< m^2 that they stand for together */
    float axis[3];          /**< unit: mean of their normals by flux */
    uint32_t id;            /**< below LWStaticVplDesc::lights; stays with a light from frame to frame */
    float flux[3];          /**< W, for LW_RECEIVERS_UNBAKED; intensity on the axis flux / pi, falling with the cosine to it */
    uint32_t vpls;          /**< how many */
    float bakedFlux[3];     /**< W, for LW_RECEIVERS_BAKED */
    float coneAngle;        /**< half angle of the spot light of 170 degrees: 85 degrees in radians */
    float spotIntensity[3]; /**< W/sr: of an evenly bright spot light of that cone with flux `flux` */
    float reserved;
} LWListedLight;

/** The light of the last lwUpdate as lights, no more than the technique's `lights`: VPLs beyond are merged with near ones that face the
 *  same way, and all flux is kept. Waits for the update, and copies once. `lights`: room for `capacity` of them, LWStaticVplDesc::lights
 *  always being enough. LWTechniqueInfo::lightList says who can. Errors: INVALID_*, UNSUPPORTED, NOT_UPDATED, OUT_OF_MEMORY. */
LW_API LWStatus lwReadLightList(LWTechnique technique, LWListedLight* lights, uint32_t capacity, uint32_t* count);

/* ------------------------------------------------------------------------------------- planning */

typedef struct LWPlanDesc {
    uint32_t structSize;
    float budgetMs;    /**< of a frame: lwUpdate and all of its lwRender, from the host's images to its output; 0: no limit */
    float errorTarget; /**< relMSE against all bounces (docs/accuracy.md); the cheapest that is predicted to reach it, else the most
                            accurate within the budget. 0: the most accurate within the budget */
    uint32_t views;    /**< that a frame renders, 64 at most; 0: 1 */
    uint32_t atRest;   /**< 1: of frames whose light and geometry have long stood still, of a host that tells so (LWRsm::version of all
                            maps, LWGeometry::version; no VPLs of its own): what is kept then takes no time. The view's camera may move;
                            worldOrigin and the maps' cameras must not. 0: of frames in which light is read and VPLs are made */
} LWPlanDesc;

/** What lwPlan measures of a frame in order to predict errors; where it has nothing to measure it by, a figure is NaN. */
typedef struct LWPlanProbes {
    float indirectShare;     /**< of the picture's light, roughly: that of a gather without visibility from a few points */
    float fluxOnScreen;      /**< share of the RSMs' flux from surfaces that the view shows */
    float fluxConcentration; /**< 1: all flux in a point; towards 0: spread evenly over the RSMs' texels */
    float depthComplexity;   /**< share of neighbouring pixels that do not lie on one surface */
    float extent;            /**< of what the view shows, relative to the extent of what the RSMs show */
    float albedo;            /**< mean of what the view shows, in [0,1]: the worth of another bounce */
    float facing;            /**< share of pairs of a pixel and a lit texel that face each other */
    float hidden;            /**< share of those pairs between which the view shows something */
} LWPlanProbes;

/** What to run, and what to expect of it. */
typedef struct LWPlan {
    uint32_t structSize;
    uint32_t withinBudget;       /**< 0: nothing that the frame allows is predicted to be; this is the most accurate of the quickest */
    uint32_t reachesError;       /**< 0: nothing within the budget is predicted to reach the target (1 where there is none) */
    float predictedMs;
    float predictedError;        /**< relMSE against all bounces */
    float confidence;            /**< 0 .. 1: the chance that the true error is within a factor of two of the predicted one, from how
                                      far predictions of scenes that the model did not know were off */
    char technique[32];
    char parameters[256];        /**< for lwCreateTechniqueFromText */
    char reason[256];            /**< one sentence */
    LWPlanProbes probes;
    float coverage;              /**< share of the view's pixels that show a surface, measured with the probes: sky takes little time */
} LWPlan;

/** Picks technique and parameters for what this frame brings and what may be spent: what is possible by the inputs given; how long it
 *  takes by a model calibrated on this device (in less than two seconds at the first call, with the lock held, then kept in the device's cache); how wrong it
 *  is by a model fitted to `lightwell chart`'s results and probes of the frame. docs/planner.md says how, and how good it is.
 *  Maps of clusters are taken for drawn already; VPLs drawn for source views cost more under a camera that moves. `view`, `gbuffer`: of the view that is to be lit.
 *  Waits for the probes: a few milliseconds. Changes nothing.
 *  Errors: INVALID_*, as lwUpdate and lwRender, and where no technique can light such a frame; OUT_OF_MEMORY. */
LW_API LWStatus lwPlan(LWView view, const LWFrame* frame, const LWGBuffer* gbuffer, const LWPlanDesc* desc, LWPlan* plan);

/** What lwPlan chooses from: all that the frame allows, quickest first, each against the same budget and target, without a reason.
 *  `plans`: room for `capacity` of them, structSize set in each; null where that is 0. `*count` gets how many there are, which may
 *  be more. Errors: as lwPlan. */
LW_API LWStatus lwListPlans(LWView view, const LWFrame* frame, const LWGBuffer* gbuffer, const LWPlanDesc* desc, LWPlan* plans,
                            uint32_t capacity, uint32_t* count);

/* ------------------------------------------------------------------------------ checking inputs */

/** What can be wrong with what a host hands over. docs/checking-inputs.md says how each is found, from
 *  which size on, and what cures it. */
typedef enum LWInputFault {
    LW_FAULT_NOT_FINITE = 0,       /**< NaN, infinity or a position beyond reach on a surface */
    LW_FAULT_NEGATIVE = 1,         /**< negative albedo, radiance or flux */
    LW_FAULT_NO_SURFACES = 2,      /**< every normal is zero, or no depth leads to a place: validity will
                                        be zero everywhere */
    LW_FAULT_NORMAL_MISSING = 3,   /**< zero normals where position or depth shows a surface */
    LW_FAULT_NORMAL_LENGTH = 4,    /**< normals that are not unit */
    LW_FAULT_NORMAL_ENCODED = 5,   /**< normals still stored as n/2 + 1/2 */
    LW_FAULT_NORMAL_SPACE = 6,     /**< normals in view space, or with other axes than the positions */
    LW_FAULT_NORMAL_FLIPPED = 7,   /**< normals that face away from camera or light */
    LW_FAULT_NORMAL_DISAGREES = 8, /**< normals that do not fit the positions, for no known reason */
    LW_FAULT_CAMERA_INVALID = 9,   /**< matrices that no camera can have */
    LW_FAULT_CAMERA_TRANSPOSED = 10, /**< column-major matrices */
    LW_FAULT_CAMERA_PREVIOUS = 11, /**< the G-buffer was drawn with `previousCamera` */
    LW_FAULT_IMAGE_FLIPPED = 12,   /**< rows bottom-up, or columns mirrored */
    LW_FAULT_POSITION_SPACE = 13,  /**< positions in view or light space, relative to the eye, or with
                                        other axes than the camera */
    LW_FAULT_POSITION_UNITS = 14,  /**< positions in another unit of length than their camera */
    LW_FAULT_POSITION_CAMERA = 15, /**< positions that do not project to their pixels, for no known reason */
    LW_FAULT_DEPTH_REVERSED = 16,  /**< 1 - depth is what the projection makes */
    LW_FAULT_DEPTH_KIND = 17,      /**< another LWDepthKind fits */
    LW_FAULT_MOTION_SIGN = 18,     /**< this frame less the previous one */
    LW_FAULT_MOTION_FLIPPED_Y = 19, /**< +y up */
    LW_FAULT_MOTION_UNITS = 20,    /**< in [0,1] or [-1,1] over the image, not in pixels */
    LW_FAULT_MOTION_ZERO = 21,     /**< all zero while the camera moves */
    LW_FAULT_MOTION_STATIC = 22,   /**< the cameras are equal while nearly all pixels move */
    LW_FAULT_MOTION_DISAGREES = 23, /**< motion that does not fit the cameras, for no known reason */
    LW_FAULT_ALBEDO_RANGE = 24,    /**< albedo above 1 */
    LW_FAULT_ALBEDO_SRGB = 25,     /**< albedo still sRGB-encoded, or decoded twice, in one of two buffers */
    LW_FAULT_DIRECT_SCALE = 26,    /**< directRadiance is off by a factor: mostly pi */
    LW_FAULT_FLUX_PI = 27,         /**< flux is off by a factor of pi, 2 pi or 4 pi */
    LW_FAULT_FLUX_TEXELS = 28,     /**< flux is off by the number of texels */
    LW_FAULT_FLUX_SCALE = 29,      /**< flux is off by another factor, or more than the light sends */
    LW_FAULT_RSM_EMPTY = 30,       /**< a lamp that shines, and no texel with flux */
    LW_FAULT_RSM_ELSEWHERE = 31,   /**< RSMs far from everything the camera sees */
    LW_FAULT_SPACES_DIFFER = 32,   /**< RSM and G-buffer do not lie in one space */
    LW_FAULT_UNITS_DIFFER = 33,    /**< RSM and G-buffer are in different units of length */
    LW_FAULT_LIGHT_CAMERA = 34,    /**< an RSM's camera is not where its point or spot light is */
    LW_FAULT_FAR_FROM_ORIGIN = 35  /**< positions so far from their origin that they are coarser than what is seen:
                                        LWFrame::worldOrigin cures it */
} LWInputFault;

typedef enum LWSeverity {
    LW_SEVERITY_NOTE = 0,    /**< worth knowing; may be meant */
    LW_SEVERITY_WARNING = 1, /**< probably wrong, or wrong in a part of the picture */
    LW_SEVERITY_ERROR = 2    /**< the light will be wrong */
} LWSeverity;

typedef struct LWInputFaultInfo {
    uint32_t structSize;
    LWInputFault fault;
    const char* name;     /**< "normal-space", ... */
    const char* summary;  /**< one line */
    float colour[3];      /**< in overlays, linear RGB in [0,1] */
} LWInputFaultInfo;

typedef struct LWInputFinding {
    LWInputFault fault;
    LWSeverity severity;
    uint64_t affected, examined;  /**< pixels or texels; of large images every second, third, ... is examined */
    double measured, expected;    /**< the figure that the message speaks of, and what it should have been */
    double confidence;            /**< 0 .. 1 that this is the cause and not another */
    float colour[3];              /**< of the affected pixels in the overlay */
    char argument[68];            /**< "gbuffer.normal", "frame.lights[0].rsms[1].flux", ... */
    char message[512];            /**< what was found, its likely cause and the cure */
} LWInputFinding;

LW_API uint32_t lwCountInputFaults(void);
/** Strings in `info` live as long as the library. */
LW_API LWStatus lwDescribeInputFault(uint32_t index, LWInputFaultInfo* info);

/** Names what is wrong with a frame's inputs: each G-buffer and RSM against its own camera, motion
 *  against both cameras, RSMs against the G-buffer, flux against the light. A debugging aid: it reads all
 *  images back, blocks, and takes a good part of a second for each million pixels; nothing else changes.
 *  `frame` or `gbuffer` may be null: what needs both is then left out, as is what needs a camera
 *  whose matrices are all zero, or a light without intensity. `sourceViews` of the frame are checked like
 *  `gbuffer`, against their own cameras.
 *  `findings`: room for `capacity` of them, the most severe first; null where that is 0. `*count` gets the
 *  number found, which may be more.
 *  `overlay`: null, or 3 channels of the view's size: the G-buffer shaded grey, affected pixels in their
 *  finding's colour, linear RGB in [0,1]; needs `gbuffer`, whose faults alone it shows.
 *  What lwUpdate or lwRender would refuse is refused with the same error. `frame->sync` is honoured. */
LW_API LWStatus lwCheckInputs(LWView view, const LWFrame* frame, const LWGBuffer* gbuffer,
                              LWInputFinding* findings, uint32_t capacity, uint32_t* count,
                              const LWImage* overlay);

/* ------------------------------------------------------------------------- statistics, debugging */

typedef struct LWPassTime {
    const char* name;    /**< "<pass>.<verb>", e.g. "interleaved_gather.gather" */
    double milliseconds; /**< device time, summed over the pass's launches; -1: unavailable */
    uint32_t launches;
} LWPassTime;

typedef struct LWCount {
    const char* name;    /**< "vpls", "rejected_pixels", "rejected_texels", "saturated_pixels", ... */
    uint64_t value;
} LWCount;

typedef struct LWChoice {
    const char* name;    /**< what was decided, e.g. "position" */
    const char* reason;  /**< e.g. "planar, used in place" */
} LWChoice;

typedef struct LWStats {
    uint32_t structSize;
    uint32_t passCount, countCount, choiceCount;
    uint64_t frameIndex;          /**< of the last completed lwUpdate */
    const LWPassTime* passes;     /**< of the last lwUpdate and all lwRender since, in order */
    const LWCount* counts;
    const LWChoice* choices;
    double totalMilliseconds;     /**< from the first pass's start to the last one's end; -1 */
    uint64_t deviceBytes;         /**< memory held by the technique and its views' buffers */
    uint64_t hostCopyBytes;       /**< bytes copied between host and device for the frame */
} LWStats;

/** Reports the technique's work as enqueued before this call, after waiting for it. Arrays stay valid until
 *  the next call of this function on the technique, or its release. */
LW_API LWStatus lwGetStats(LWTechnique technique, LWStats* stats);

typedef struct LWDebugView {
    uint32_t structSize;
    uint32_t width, height, channels;
    const char* name;
    const char* description; /**< with the unit of each channel */
} LWDebugView;

/** The technique's intermediate buffers of its last frame, e.g. "vpls", "gathered". `view` may be null
 *  for those of the world part. Counting and describing them are queries: they neither wait nor enqueue nor
 *  allocate. */
LW_API LWStatus lwCountDebugViews(LWTechnique technique, LWView view, uint32_t* count);
LW_API LWStatus lwDescribeDebugView(LWTechnique technique, LWView view, uint32_t index,
                                    LWDebugView* info);
/** Waits for what was enqueued before this call, then copies `channels` planes of width * height floats,
 *  packed; of a view without pixels nothing. `capacity` counts floats. Host memory that the last frame used
 *  in place (inputs and outputs) must still be valid. */
LW_API LWStatus lwReadDebugView(LWTechnique technique, LWView view, const char* name, float* pixels,
                                uint64_t capacity);

#ifdef __cplusplus
}
#endif
#endif
