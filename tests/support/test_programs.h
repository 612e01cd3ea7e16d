// Kernels that only tests use, embedded from tests/kernels like the library's own.
#pragma once

#include "compute/program.h"

namespace lightwell {

extern const EmbeddedProgram kTestPrograms[];
extern const std::size_t kTestProgramsCount;

}  // namespace lightwell
