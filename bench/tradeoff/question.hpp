// A scene whose right answer is known, and how far what an engine did is from it.
#pragma once

#include <string>
#include <vector>

#include "../scenes/judge.hpp"
#include "../scenes/scene.hpp"

namespace bench {

/// What was seen of a scene, in double, at the same times of all engines.
struct film {
    /// Seconds from frame to frame; the first is the start.
    static constexpr double interval = 1.0 / 30;
    std::vector<std::vector<state>> frames;

    [[nodiscard]] const std::vector<state>& last() const { return frames.back(); }
};

struct question {
    std::string name;
    const char* about;
    /// What the error is, with its unit, and where the right answer is from.
    const char* metric;
    /// What is just visible, and from where on the scene has not been solved at all.
    double visible, broken;
    scene played;
    /// Null where no closed form or invariant is known: then it is the largest distance of any body from where a
    /// reference has it.
    double (*error)(const scene& s, const film& seen);
};

/// The largest distance between where bodies are in two films, at the same times.
double distance_of(const film& a, const film& b);

/// All of them, in the order of the page.
const std::vector<question>& questions();

}  // namespace bench
