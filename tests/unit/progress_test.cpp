// The progress line, with a clock and a file of the test's own.
#include <catch2/catch.hpp>

#include <cstdio>
#include <string>

#include "progress.h"

namespace {

struct Recorder {
    std::FILE* file = std::tmpfile();
    double now = 100.0;
    ~Recorder() { std::fclose(file); }
    studio::ProgressLine::Sink sink(bool terminal) {
        return {file, terminal, [this] { return now; }};
    }
    std::string text() const {
        std::rewind(file);
        std::string all;
        for (int c = std::fgetc(file); c != EOF; c = std::fgetc(file)) all += char(c);
        return all;
    }
};

}  // namespace

TEST_CASE("durations") {
    CHECK(studio::formatDuration(0.4) == "0:00");
    CHECK(studio::formatDuration(65.0) == "1:05");
    CHECK(studio::formatDuration(59.7) == "1:00");
    CHECK(studio::formatDuration(2 * 3600 + 3 * 60 + 4) == "2:03:04");
}

TEST_CASE("on a terminal the line is rewritten, with the time left, and ended once") {
    Recorder r;
    {
        studio::ProgressLine line("reference", r.sink(true));
        line.update(0.0);
        r.now += 10.0;
        line.update(0.25, "relMSE 0.01");
        r.now += 0.05;
        line.update(0.26);  // too soon after the last
        r.now += 20.0;
        line.finish();
    }
    CHECK(r.text() == "\rreference  25 %, 0:30 left, relMSE 0.01\x1b[K\rreference done in 0:30\x1b[K\n");
}

TEST_CASE("a resumed run counts only what it did itself") {
    Recorder r;
    studio::ProgressLine line("x", r.sink(true));
    line.update(0.5);
    r.now += 10.0;
    line.update(0.75);  // a quarter in ten seconds: another ten
    CHECK(r.text() == "\rx  75 %, 0:10 left\x1b[K");
}

TEST_CASE("an unfinished terminal line is ended when it goes") {
    Recorder r;
    {
        studio::ProgressLine line("x", r.sink(true));
        line.update(0.0);
        r.now += 1.0;
        line.update(0.0);  // nothing done yet: no time left is told
    }
    CHECK(r.text() == "\rx   0 %\x1b[K\n");
}

TEST_CASE("elsewhere whole lines, at most one a minute, and none for quick work") {
    Recorder r;
    studio::ProgressLine line("x", r.sink(false));
    for (int second = 0; second < 150; ++second, r.now += 1.0) line.update(second / 150.0);
    line.finish("relMSE 1e-4");
    CHECK(r.text() == "x  40 %, 1:30 left\nx  80 %, 0:30 left\nx done in 2:30, relMSE 1e-4\n");

    Recorder quick;
    studio::ProgressLine("y", quick.sink(false)).finish();
    CHECK(quick.text().empty());
}
