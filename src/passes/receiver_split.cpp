#include "passes/receiver_split.h"

#include "compute/device.h"
#include "inputs/image_access.h"

namespace lightwell {

ReceiverSplit::ReceiverSplit(Device& device)
    : device_(device),
      normals_(device.programs().kernel("receiver_split/receiver_split", "receiver_split_normals")),
      join_(device.programs().kernel("receiver_split/receiver_split", "receiver_split_join")) {}

void ReceiverSplit::recordNormals(Executor& executor, const Planes& normal, const Planes& marks,
                                  const Planes& first, const Planes& second) {
    executor.run("receiver_split.normals", normals_, rowGrid(device_, normal.width, normal.height),
                 rowGroup(device_), normal, marks, cl_int(normal.width), cl_int(normal.height), first,
                 second);
}

void ReceiverSplit::recordJoin(Executor& executor, const Planes& marks, const Planes& first,
                               const Planes& second, const Planes& joined) {
    executor.run("receiver_split.join", join_, rowGrid(device_, joined.width, joined.height),
                 rowGroup(device_), marks, first, second, cl_int(joined.width), cl_int(joined.height),
                 cl_int(joined.count), joined);
}

}  // namespace lightwell
