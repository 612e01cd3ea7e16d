// What the input checker has found, in the making.
#pragma once

#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

#include "lightwell/lightwell.h"

namespace lightwell {

struct Found {
    LWInputFinding finding{};
    // Affected pixels of the first view, x + y * width, each standing for a block of `step` a side.
    std::vector<std::uint32_t> pixels;
    std::uint32_t step = 1;
};

struct Figures {
    std::uint64_t affected = 0, examined = 0;
    double measured = 0.0, expected = 0.0, confidence = 1.0;
};

class Findings {
public:
    // The message is what the parts stream to.
    template <class... Parts>
    Found& add(LWInputFault fault, LWSeverity severity, const std::string& argument,
               const Figures& figures, const Parts&... parts) {
        std::ostringstream message;
        message.precision(4);
        (message << ... << parts);
        return addFinding(fault, severity, argument, figures, message.str());
    }
    bool any() const { return !found_.empty(); }
    std::vector<Found> takeSorted();  // the most severe, then the surest, then the first found

private:
    Found& addFinding(LWInputFault fault, LWSeverity severity, const std::string& argument,
                      const Figures& figures, const std::string& message);
    std::vector<Found> found_;
};

// "12.3 %"
std::string percent(std::uint64_t part, std::uint64_t whole);
double shareOf(std::uint64_t part, std::uint64_t whole);
// The value that splits the sorted ones in half; 0 of none.
double medianOf(std::vector<double> values);

}  // namespace lightwell
