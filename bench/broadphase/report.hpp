// The table and the CSV of the broadphase benchmark.
#pragma once

#include <malloc.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "../timing.hpp"
#include "scene.hpp"

namespace bench {

inline double held_bytes() {
    const struct mallinfo2 m = mallinfo2();
    return static_cast<double>(m.uordblks + m.hblkhd);
}

inline std::string grouped(std::uint32_t n) {
    std::string s = std::to_string(n);
    for (std::size_t i = s.size(); i > 3;) s.insert(i -= 3, ",");
    return s;
}

struct figures {
    samples build, frame_1, frame_10, frame_100, ray, region;
};

class report {
public:
    explicit report(const char* csv) : csv_(std::fopen(csv, "w")) {
        if (csv_) std::fputs("layout,dimension,proxies,contestant,scalar,what,mean,median,minimum,unit\n", csv_);
    }
    report(const report&) = delete;
    report& operator=(const report&) = delete;
    ~report() {
        if (csv_) std::fclose(csv_);
    }

    void complain(const std::string& what) { complaints_.push_back(what); }

    void add(const scene& s, const contestant& who, const figures& f, double bytes) {
        const std::string title = std::to_string(s.dimension) + "D, " + name_of(s.kind);
        if (titles_.empty() || titles_.back() != title) {
            titles_.push_back(title);
            lines_.push_back("\n" + title);
        }
        const std::string name = who.name + (who.scalar == "float" ? "" : " " + who.scalar);
        char text[64];
        const std::string count = grouped(static_cast<std::uint32_t>(s.boxes.size()));
        std::snprintf(text, sizeof text, "%-20s %10s", name.c_str(), count.c_str());
        std::string line = text + cell(f.build, false);
        for (const samples* frame : {&f.frame_1, &f.frame_10, &f.frame_100}) line += " |" + cell(*frame, true);
        line += " |" + cell(f.ray, false) + cell(f.region, false);
        std::snprintf(text, sizeof text, "%7.0f", bytes);
        lines_.push_back(line + text);
        row(s, who, "build", f.build);
        row(s, who, "frame 1 %", f.frame_1);
        row(s, who, "frame 10 %", f.frame_10);
        row(s, who, "frame 100 %", f.frame_100);
        row(s, who, "ray", f.ray);
        row(s, who, "region", f.region);
        row(s, who, "memory", {bytes});
    }
    /// Returns the exit code.
    int print() const {
        std::puts(
            "ns of CPU time: build and frames a proxy of the world, queries each; bytes a proxy. Build and queries\n"
            "are medians. Frames are mean, median, minimum: with margins, a frame in which hardly anybody leaves its\n"
            "box is nearly free, and now and then a tree is packed anew, so only the mean is the price. Bullet's rays\n"
            "visit all boxes on their way; Box2D hands out candidates and keeps no pairs; Embree is for rays alone.");
        std::printf("\n%-31s%7s |%21s |%21s |%21s |%7s%7s%7s\n", "", "build", "1 % move", "10 % move", "100 % move",
                    "ray", "region", "bytes");
        for (const std::string& line : lines_) std::puts(line.c_str());
        for (const std::string& what : complaints_) std::printf("DISAGREEMENT: %s\n", what.c_str());
        if (complaints_.empty()) std::puts("\nAll rays, regions and checked pairs agree.");
        return complaints_.empty() ? 0 : 1;
    }

private:
    /// Two digits and more.
    static std::string number(double x) {
        char text[32];
        std::snprintf(text, sizeof text, x < 9.95 ? "%7.1f" : "%7.0f", x);
        return text;
    }
    static std::string cell(const samples& s, bool all) {
        if (s.empty()) return std::string(all ? 20 : 6, ' ') + "-";
        return all ? number(mean(s)) + number(median(s)) + number(minimum(s)) : number(median(s));
    }
    void row(const scene& s, const contestant& who, const char* what, const samples& of) {
        if (!csv_ || of.empty()) return;
        std::fprintf(csv_, "%s,%d,%zu,%s,%s,%s,%.4g,%.4g,%.4g,%s\n", name_of(s.kind), s.dimension, s.boxes.size(),
                     who.name.c_str(), who.scalar.c_str(), what, mean(of), median(of), minimum(of),
                     what == std::string("memory") ? "bytes" : "ns");
    }

    std::FILE* csv_;
    std::vector<std::string> titles_, lines_, complaints_;
};

}  // namespace bench
