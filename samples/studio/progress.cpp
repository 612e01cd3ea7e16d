#include "progress.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include <fmt/format.h>

namespace studio {
namespace {

constexpr double kTerminalInterval = 0.2;  // s between two drawings: readable, and costs nothing
constexpr double kLogInterval = 60.0;      // s between two lines of a log
// Share of the work after which a rate is worth telling; before it the time left jumps about.
constexpr double kTellingShare = 0.002;

double steadySeconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

std::string formatDuration(double seconds) {
    const long whole = long(std::max(0.0, seconds) + 0.5);
    const long hours = whole / 3600, minutes = whole / 60 % 60, rest = whole % 60;
    return hours > 0 ? fmt::format("{}:{:02}:{:02}", hours, minutes, rest)
                     : fmt::format("{}:{:02}", minutes, rest);
}

ProgressLine::ProgressLine(std::string label)
    : ProgressLine(std::move(label), {stderr, isatty(fileno(stderr)) != 0, steadySeconds}) {}

ProgressLine::ProgressLine(std::string label, Sink sink)
    : label_(std::move(label)), sink_(std::move(sink)), start_(sink_.seconds()), shown_(start_) {}

ProgressLine::~ProgressLine() {
    if (!open_) return;
    std::fputc('\n', sink_.file);
    std::fflush(sink_.file);
}

void ProgressLine::update(double fraction, const std::string& note) {
    fraction = std::clamp(fraction, 0.0, 1.0);
    const double now = sink_.seconds();
    if (firstFraction_ < 0.0) firstFraction_ = fraction;
    if (now - shown_ < (sink_.terminal ? kTerminalInterval : kLogInterval)) return;
    shown_ = now;

    std::string text = fmt::format("{} {:3.0f} %", label_, 100.0 * fraction);
    const double done = fraction - firstFraction_;
    if (done >= kTellingShare)
        text += ", " + formatDuration((now - start_) * (1.0 - fraction) / done) + " left";
    if (!note.empty()) text += ", " + note;
    show(text);
}

void ProgressLine::finish(const std::string& note) {
    const double took = sink_.seconds() - start_;
    if (!sink_.terminal && took < kLogInterval) return;  // quick work leaves logs alone
    show(fmt::format("{} done in {}{}{}", label_, formatDuration(took), note.empty() ? "" : ", ", note));
    if (open_) std::fputc('\n', sink_.file);
    open_ = false;
}

void ProgressLine::show(const std::string& text) {
    if (sink_.terminal) {
        fmt::print(sink_.file, "\r{}\x1b[K", text);  // back to the start, write, clear the rest
        open_ = true;
    } else {
        fmt::print(sink_.file, "{}\n", text);
    }
    std::fflush(sink_.file);
}

}  // namespace studio
