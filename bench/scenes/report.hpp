// The tables, the CSV and the Markdown of the benchmark of scenes.
#pragma once

#include <cstdio>
#include <map>
#include <string>
#include <vector>

#include "../timing.hpp"
#include "engine.hpp"
#include "judge.hpp"

namespace bench {

/// What was found of one engine in one scene.
struct score {
    contestant who;
    /// CPU ms a step: that of each step of each round.
    std::vector<samples> rounds;
    verdict accuracy;
    int contacts = 0;
    double bytes = 0, contact_bytes = 0;
    std::vector<std::pair<std::string, double>> stages;
    std::string complaint;

    /// Every step's least over the rounds, on average: engines replay the same steps, so that the rest is noise.
    [[nodiscard]] double least() const {
        double sum = 0;
        for (std::size_t i = 0; i < rounds.front().size(); ++i) {
            double best = rounds.front()[i];
            for (const samples& round : rounds) best = std::min(best, round[i]);
            sum += best;
        }
        return sum / static_cast<double>(rounds.front().size());
    }
    [[nodiscard]] double middle() const {
        samples means;
        for (const samples& round : rounds) means.push_back(mean(round));
        return median(means);
    }
    [[nodiscard]] double slowest_step() const {
        double most = 0;
        for (std::size_t i = 0; i < rounds.front().size(); ++i) {
            double best = rounds.front()[i];
            for (const samples& round : rounds) best = std::min(best, round[i]);
            most = std::max(most, best);
        }
        return most;
    }
};

class report {
public:
    report(const std::string& csv, std::string markdown)
        : csv_(std::fopen(csv.c_str(), "w")), markdown_(std::move(markdown)) {
        if (csv_)
            std::fputs(
                "scene,dimension,bodies,steps,engine,ms,ms_median,ms_slowest,ratio,contacts,bytes_a_body,"
                "bytes_a_contact,worst_m,last_m,mean_m,deep,sag_m,drift_m,energy_J,lost,gap_m,mean_gap_m\n",
                csv_);
    }
    report(const report&) = delete;
    report& operator=(const report&) = delete;
    ~report() {
        if (csv_) std::fclose(csv_);
    }

    void add(const scene& s, const std::vector<score>& scores) {
        const int bodies = s.free_bodies();
        std::printf("\n%s: %dD, %d bodies, %zu joints, %d steps\n", s.name.c_str(), s.dimension, bodies,
                    s.joints.size(), s.steps);
        std::printf("%-16s%9s%9s%9s%7s%10s%8s%10s |%8s%8s%8s%7s%9s%9s%10s%6s", "", "ms", "median", "slowest", "ratio",
                    "contacts", "B/body", "B/contact", "worst", "last", "mean", ">5 mm", "sag", "drift", "energy",
                    "lost");
        if (s.joints.empty()) std::puts("");
        else std::printf("%9s%9s\n", "gap", "mean");
        double first = 0;
        for (const score& c : scores) {
            if (!c.complaint.empty()) {
                complaints_.push_back(s.name + ": " + c.who.name + " " + c.complaint);
                continue;
            }
            const double ms = c.least();
            if (first == 0) first = ms;
            const verdict& v = c.accuracy;
            char contact[32] = "";
            if (c.contact_bytes > 0) std::snprintf(contact, sizeof contact, "%.0f", c.contact_bytes);
            std::printf("%-16s%9.3f%9.3f%9.3f%7.2f%10d%8.0f%10s |%8.2f%8.2f%8.3f%7d", c.who.name.c_str(), ms,
                        c.middle(), c.slowest_step(), ms / first, c.contacts, c.bytes / bodies, contact, 1e3 * v.worst,
                        1e3 * v.last, 1e3 * v.mean, v.deep);
            if (s.tops.empty()) std::printf("%9s%9s", "-", "-");
            else std::printf("%9.1f%9.1f", 1e3 * v.sag, 1e3 * v.drift);
            std::printf("%10.3g%6d", v.energy, v.lost);
            if (s.joints.empty()) std::puts("");
            else std::printf("%9.4g%9.3g\n", 1e3 * v.gap, 1e3 * v.mean_gap);
            for (const auto& [name, ns] : c.stages)
                std::printf("    %-24s%9.3f ms\n", name.c_str(),
                            ns / 1e6 / s.steps / static_cast<double>(c.rounds.size()));
            if (csv_) {
                std::fprintf(
                    csv_,
                    "%s,%d,%d,%d,%s,%.5g,%.5g,%.5g,%.4g,%d,%.0f,%s,%.5g,%.5g,%.5g,%d,%.5g,%.5g,%.5g,%d,%.5g,%.5g\n",
                    s.name.c_str(), s.dimension, bodies, s.steps, c.who.name.c_str(), ms, c.middle(), c.slowest_step(),
                    ms / first, c.contacts, c.bytes / bodies, contact, v.worst, v.last, v.mean, v.deep, v.sag, v.drift,
                    v.energy, v.lost, v.gap, v.mean_gap);
                std::fflush(csv_);
            }
            char text[64];
            std::snprintf(text, sizeof text, ms < 10 ? "%.3g (%.1f)" : "%.1f (%.1f)", ms,
                          1e3 * (s.joints.empty() ? v.last : v.gap));
            cells_[key(s, bodies)][c.who.name] = text;
        }
        if (order_.empty() || order_.back() != key(s, bodies)) order_.push_back(key(s, bodies));
        std::fflush(stdout);
    }
    /// Returns the exit code.
    int print(const std::vector<contestant>& all) const {
        std::puts(
            "\nms: CPU time a step, each step's least over the rounds, on average; median: of the rounds' means;\n"
            "slowest: the slowest step's least. ratio: to the first line. contacts: that push, at the end. B/body:\n"
            "bytes held by the engine at the end, with its scratch, a body. B/contact: bytes of the state that lasts,\n"
            "less those of the same without contacts and memories of pairs, for each contact held, those that only\n"
            "come near included; where an engine tells. Overlaps in mm as the judge finds them: the worst ever\n"
            "sampled, the last and mean at the end, and how many are deeper than 5 mm. sag, drift: of tops of\n"
            "structures, at the end, in mm. energy: kinetic, at the end, in J. lost: bodies that left. gap: between "
            "points\n"
            "that a joint holds together, the largest of all steps, and the mean, in mm.");
        for (const contestant& c : all) std::printf("%-16s%s\n", c.name.c_str(), c.settings.c_str());
        write_markdown(all);
        for (const std::string& what : complaints_) std::printf("NOT THE SAME SCENE: %s\n", what.c_str());
        return complaints_.empty() ? 0 : 1;
    }

private:
    static std::string key(const scene& s, int bodies) {
        return s.name + ", " + std::to_string(s.dimension) + "D, " + std::to_string(bodies);
    }
    /// One row a scene, one column an engine: ms a step, and in brackets the deepest overlap at the end in mm; where
    /// there are joints, the largest gap of all steps.
    void write_markdown(const std::vector<contestant>& all) const {
        std::FILE* const out = std::fopen(markdown_.c_str(), "w");
        if (!out) return;
        std::fputs("| ms a step (mm of overlap, of joints where there are some) |", out);
        for (const contestant& c : all) std::fprintf(out, " %s |", c.name.c_str());
        std::fputs("\n|---|", out);
        for (std::size_t i = 0; i < all.size(); ++i) std::fputs("---|", out);
        std::fputs("\n", out);
        for (const std::string& row : order_) {
            std::fprintf(out, "| %s |", row.c_str());
            for (const contestant& c : all) {
                const auto cell = cells_.at(row).find(c.name);
                std::fprintf(out, " %s |", cell == cells_.at(row).end() ? "" : cell->second.c_str());
            }
            std::fputs("\n", out);
        }
        std::fclose(out);
    }

    std::FILE* csv_;
    std::string markdown_;
    std::vector<std::string> order_;
    std::map<std::string, std::map<std::string, std::string>> cells_;
    std::vector<std::string> complaints_;
};

}  // namespace bench
