// The C++ header by itself, with every warning an error.
#include <lightwell/lightwell.hpp>

static_assert(sizeof(LWStatus) == sizeof(int), "the C enumerations keep their size in C++");
