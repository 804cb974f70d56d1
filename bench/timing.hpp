// The clock, what it has measured, and the progress bar of benchmarks.
#pragma once

#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

namespace bench {

/// CPU time of this thread: what else runs on the machine costs others, not us.
class stopwatch {
public:
    [[nodiscard]] double ns() const { return now() - start_; }

private:
    static double now() {
        timespec t;
        clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
        return static_cast<double>(t.tv_sec) * 1e9 + static_cast<double>(t.tv_nsec);
    }
    double start_ = now();
};

using samples = std::vector<double>;

inline double mean(const samples& s) {
    double sum = 0;
    for (const double x : s) sum += x;
    return sum / static_cast<double>(s.size());
}
inline double median(samples s) {
    std::nth_element(s.begin(), s.begin() + static_cast<std::ptrdiff_t>(s.size() / 2), s.end());
    return s[s.size() / 2];
}
inline double minimum(const samples& s) { return *std::min_element(s.begin(), s.end()); }

/// Says on a terminal what is being measured, and how much is done.
class progress {
public:
    int total = 0;

    void show(const std::string& what, int steps = 1) {
        done_ += steps;
        if (!isatty(2)) return;
        const int width = total > 0 ? std::min(30, 30 * (done_ - 1) / total) : 0;
        std::fprintf(stderr, "\r\033[K[%-30s] %d/%d %s", std::string(static_cast<std::size_t>(width), '#').c_str(),
                     done_, total, what.c_str());
    }
    void clear() const {
        if (isatty(2)) std::fprintf(stderr, "\r\033[K");
    }

private:
    int done_ = 0;
};

}  // namespace bench
