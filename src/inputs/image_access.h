// A checked image made reachable for kernels: in place where the device can, uploaded where it must.
#pragma once

#include <string>

#include "compute/buffer.h"
#include "compute/executor.h"
#include "inputs/image_check.h"
#include "inputs/view.h"
#include "shared/unproject_types.h"

namespace lightwell {

// The work-group of kernels that run one work-item per LW_WIDTH pixels of a row, and their grid. One
// local size per device: drivers may compile a kernel anew for each.
Range rowGroup(const Device& device);
Range rowGrid(const Device& device, std::uint32_t width, std::uint32_t height);

// A host's image in device memory, as bytes; as planes too where its layout allows.
struct DeviceImage {
    Buffer memory;
    LwPixels pixels{};        // offsets from the start of `memory`
    Planes planes;            // set when usable without unpacking
    const char* choice = "";  // for the report: what was done and why
    int decode = LW_ROLE_VALUE;
};

// Opens an image for reading. On a device without shared memory host pixels are uploaded (`uploadPass`) to
// `staging`, which the caller keeps from frame to frame: it grows on need, and a later upload waits in the
// queue for what reads the one before.
DeviceImage openForReading(Executor& executor, const CheckedImage& checked, const ImageRole& role,
                           const char* uploadPass, Buffer& staging);
// Bytes of `staging` for this image; 0 where none is needed.
std::size_t stagingBytes(const Device& device, const CheckedImage& checked);
// Makes room for this image, and for the next in its format up to the view's largest size: a changed size must
// not allocate.
void reserveStaging(Buffer& staging, Device& device, const CheckedImage& checked, const View& view);

// Unpacks into planes of ours.
void unpack(Executor& executor, const char* pass, const DeviceImage& image, const Planes& to);

// World position and normal from depth.
void unproject(Executor& executor, const char* pass, const DeviceImage& depth, const DeviceImage& normal,
               const LwUnprojection& unprojection, const Planes& position, const Planes& normals);

// The planes of a part of an image: `count` planes from `first` on.
Planes subPlanes(const Planes& planes, std::uint32_t first, std::uint32_t count);

}  // namespace lightwell
