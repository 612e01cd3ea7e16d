// Whether an address of the host's can be touched at all: catches offsets and strides that leave the
// process's memory, before a kernel does.
#pragma once

namespace lightwell {

// False when the page of `address` is certainly not mapped. (True proves nothing; on systems without
// mincore it is always true.)
bool maybeMapped(const void* address);

}  // namespace lightwell
