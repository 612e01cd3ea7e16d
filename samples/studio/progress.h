// Progress of a long computation on stderr: one line, rewritten in place, with the time left.
//
// Ours, and small, because Debian 12 packages no progress-bar library for C++. On a terminal the line
// is redrawn a few times a second; elsewhere (a log, a pipe) a whole line comes at most once a minute.
#pragma once

#include <cstdio>
#include <functional>
#include <string>

namespace studio {

// "1:05", "2:03:04": minutes and seconds, with hours when there are any.
std::string formatDuration(double seconds);

class ProgressLine {
public:
    struct Sink {
        std::FILE* file = stderr;
        bool terminal = false;
        std::function<double()> seconds;  // a clock that never runs back
    };
    explicit ProgressLine(std::string label);  // to stderr
    ProgressLine(std::string label, Sink sink);
    ~ProgressLine();  // ends a line left open
    ProgressLine(const ProgressLine&) = delete;
    ProgressLine& operator=(const ProgressLine&) = delete;

    // `fraction` in [0,1] may start above 0 (a resumed run) and may fall (a better estimate of the
    // whole).
    void update(double fraction, const std::string& note = "");
    void finish(const std::string& note = "");  // the last line, with the time it took

private:
    void show(const std::string& text);

    std::string label_;
    Sink sink_;
    double start_ = 0.0, shown_ = 0.0;
    double firstFraction_ = -1.0;
    bool open_ = false;  // a terminal line without its end
};

}  // namespace studio
