// What measured figures depend on besides their inputs: the machine code and the kernels that ran.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace cli {

// A hash of this program, of Lightwell's library, and of the kernel folder where LIGHTWELL_KERNEL_DIR
// names one: other code, another identity.
std::string buildIdentity();

// "lightwell", "embree", "openimageio", "compiler", "cpu", "threads": what a table's head states.
std::vector<std::pair<std::string, std::string>> buildVersions();

}  // namespace cli
