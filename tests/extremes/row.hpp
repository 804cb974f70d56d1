// A row of the stability table: an extreme, what is measured of it, and how good is good enough.
#pragma once

namespace extremes {

/// What a world may spend on a scene.
struct work {
    int substeps = 4;
};

enum class verdict { pass, degrade, fail };

/// What a scene gives where the library refuses it.
constexpr double refused = -1;

template <class World>
struct row {
    /// As in the literature where it has a name there (M1, K2...); rows of one extreme share the first word.
    const char* name;
    const char* played;
    /// What is measured, from outside and in double, with its unit. Less is better; never negative.
    const char* metric;
    /// Up to where the target is met, and up to where a user would still call the scene stable.
    double pass, degrade;
    /// Where both are from.
    const char* why;
    double (*measure)(double parameter, const work& with);
    double parameter;
    /// The most substeps with which the target counts as met.
    int budget = 64;
    /// Another row, which shows that this one does not pass since nothing moves at all: where that fails, so does this.
    const char* probe = "";
    /// The most substeps that are tried, of scenes that take long.
    int most = 64;
    /// In which dimension it is played; 0: in both.
    int dimension = 0;
};

/// What a figure is worth; NaN, infinity and refusals fail.
inline verdict judge(double value, double pass, double degrade) {
    if (!(value >= 0) || !(value <= degrade)) return verdict::fail;
    return value <= pass ? verdict::pass : verdict::degrade;
}

}  // namespace extremes
