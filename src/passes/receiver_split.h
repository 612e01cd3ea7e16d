// A view's surfaces dealt out to two images by a mask, and their light put together again.
#pragma once

#include "compute/buffer.h"
#include "compute/executor.h"

namespace lightwell {

class ReceiverSplit {
public:
    explicit ReceiverSplit(Device& device);

    // Pass "receiver_split.normals": normals where `marks` (1 plane) is zero to `first`, the others to
    // `second`, with zeros elsewhere.
    void recordNormals(Executor& executor, const Planes& normal, const Planes& marks,
                       const Planes& first, const Planes& second);
    // Pass "receiver_split.join": what was made of the first where `marks` is zero, of the second
    // elsewhere.
    void recordJoin(Executor& executor, const Planes& marks, const Planes& first, const Planes& second,
                    const Planes& joined);

private:
    Device& device_;
    Kernel &normals_, &join_;
};

}  // namespace lightwell
