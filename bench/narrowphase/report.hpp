// The tables and the CSV of the narrowphase benchmark.
#pragma once

#include <algorithm>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "../timing.hpp"
#include "scene.hpp"

namespace bench {

/// How good the answers are. A failure is none at all: NaN, an exception, contact where there is none or the other way
/// round; it does not count if the true distance is within 0.2 mm.
struct quality {
    int asked = 0, failures = 0;
    /// Those with a distance, or a normal along which they are apart by as much less than they could, off by over 1 mm.
    int off = 0;
    /// The largest errors (m) of distances or depths, and of normals as above.
    double error = 0, of_normal = 0;

    void judge(task t, const pair_set& s, int k, std::size_t pair, const outcome& o) {
        const double exact = static_cast<double>(s.answers[k][pair].distance);
        const bool clear = exact > 2e-4 || exact<-2e-4, told_apart = o.distance> 0;
        const oracle::point n{o.normal[0], o.normal[1], o.normal[2]};
        const oracle::real length = size(n);
        ++asked;
        if (!(o.distance == o.distance) || length != length || (clear && told_apart != (exact > 0))) {
            ++failures;
            return;
        }
        // Only penetration() tells by how much they are apart where contact was asked for.
        if (t == task::boolean || told_apart != (t == task::distance) || (exact > 0) != told_apart) return;
        const double wrong = std::abs(o.distance - exact);
        const double less = t == task::distance || length == 0 ? 0 : exact - s.apart_along(k, pair, n * (1 / length));
        error = std::max(error, wrong);
        of_normal = std::max(of_normal, less);
        off += wrong > 1e-3 || less > 1e-3;
    }
    friend quality operator+(const quality& a, const quality& b) {
        return {a.asked + b.asked, a.failures + b.failures, a.off + b.off, std::max(a.error, b.error),
                std::max(a.of_normal, b.of_normal)};
    }
};

class report {
public:
    explicit report(const char* csv) : csv_(std::fopen(csv, "w")) {
        if (csv_)
            std::fputs(
                "dimension,pair,state,task,contestant,scalar,memory,minimum,median,unit,error,normal,off,"
                "failures,asked\n",
                csv_);
    }
    report(const report&) = delete;
    report& operator=(const report&) = delete;
    ~report() {
        if (csv_) std::fclose(csv_);
    }

    void add(const pair_set& s, task t, const contestant& who, const samples& cold, const samples& warm,
             const quality& of_cold, const quality& of_warm) {
        const quality q = of_cold + of_warm;
        const std::string pair = s.first + "-" + s.second;
        const std::string title = std::to_string(s.dimension) + "D, " + name_of(t) + ", " + name_of(s.in);
        table& to = table_of(title);
        if (std::find(to.columns.begin(), to.columns.end(), pair) == to.columns.end()) to.columns.push_back(pair);
        const std::string name = who.name + (who.name == "physics" ? " " + who.scalar : "");
        if (std::find(to.rows.begin(), to.rows.end(), name) == to.rows.end()) to.rows.push_back(name);
        char text[64];
        if (warm.empty()) std::snprintf(text, sizeof text, "%.0f", minimum(cold));
        else std::snprintf(text, sizeof text, "%.0f/%.0f", minimum(cold), minimum(warm));
        to.times[{name, pair}] = text;
        if (t == task::boolean) std::snprintf(text, sizeof text, "-");
        else std::snprintf(text, sizeof text, "%.0e", q.error);
        std::string said = text;
        if (q.off) said += " ~" + percent(q.off, q.asked);
        if (q.failures) said += " !" + percent(q.failures, q.asked);
        to.errors[{name, pair}] = said;
        row(s, t, who, "cold", cold, of_cold);
        if (!warm.empty()) row(s, t, who, "warm", warm, of_warm);
        std::fflush(csv_);
    }
    void print() const {
        std::puts(
            "ns of CPU time a pair: the minimum of short rounds, cold, then with what is remembered of each pair over\n"
            "frames of 1 cm and 0.01 rad (medians are in the CSV). On the right the largest error (m) of distance or\n"
            "depth; after ~ the answers (%) whose depth or normal is off by over 1 mm, after ! those that are none:\n"
            "misclassified by over 0.2 mm, NaN, thrown. Normals are off by what they part two less than they could.");
        for (const table& t : tables_) {
            std::printf("\n%s\n%-17s", t.title.c_str(), "");
            for (const std::string& c : t.columns) std::printf("%16s", c.c_str());
            std::printf(" |");
            for (const std::string& c : t.columns) std::printf("%16s", c.c_str());
            std::puts("");
            for (const std::string& r : t.rows) {
                std::printf("%-17s", r.c_str());
                for (const std::string& c : t.columns) std::printf("%16s", cell(t.times, r, c));
                std::printf(" |");
                for (const std::string& c : t.columns) std::printf("%16s", cell(t.errors, r, c));
                std::puts("");
            }
        }
    }

private:
    using cells = std::map<std::pair<std::string, std::string>, std::string>;
    struct table {
        std::string title;
        std::vector<std::string> rows, columns;
        cells times, errors;
    };
    static std::string percent(int part, int of) {
        char text[16];
        std::snprintf(text, sizeof text, "%.2g", 100.0 * part / of);
        return text;
    }
    static const char* cell(const cells& of, const std::string& row, const std::string& column) {
        const auto it = of.find({row, column});
        return it == of.end() ? "-" : it->second.c_str();
    }
    table& table_of(const std::string& title) {
        for (table& t : tables_)
            if (t.title == title) return t;
        tables_.push_back({title, {}, {}, {}, {}});
        return tables_.back();
    }
    void row(const pair_set& s, task t, const contestant& who, const char* memory, const samples& of,
             const quality& q) {
        if (!csv_) return;
        std::fprintf(csv_, "%d,%s-%s,%s,%s,%s,%s,%s,%.4g,%.4g,ns,%.3g,%.3g,%d,%d,%d\n", s.dimension, s.first.c_str(),
                     s.second.c_str(), name_of(s.in), name_of(t), who.name.c_str(), who.scalar.c_str(), memory,
                     minimum(of), median(of), q.error, q.of_normal, q.off, q.failures, q.asked);
    }

    std::FILE* csv_;
    std::vector<table> tables_;
};

}  // namespace bench
