// The scenes of the benchmark of features: of those of bench/scenes, and others.
#pragma once

#include "../scenes/parts.hpp"

namespace bench {

/// A scene, and how many of its steps go by before the clock runs.
struct timed_scene {
    const char* what;
    scene it;
    int before = 0;
};

inline const maker& maker_of(const char* name) {
    return *std::find_if(makers().begin(), makers().end(), [&](const maker& m) { return name == std::string(m.name); });
}
/// Boxes and balls in a box that turns.
inline scene drum3(bool quick) {
    scene s = named("drum3", 3, 0);
    const int side = quick ? 7 : 12;
    const double half = 0.75 * side;
    body drum;
    drum.kind = role::driven;
    drum.spin = {0, 0, 0.45};
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (const double way : {-1.0, 1.0}) {
            triple extents = {half + 1, half + 1, half + 1}, at = {};
            extents[axis] = 0.5;
            at[axis] = way * (half + 0.5);
            drum.shapes.push_back(placed(box(extents), at));
        }
    s.add(drum);
    shape ball;
    ball.kind = form::ball;
    ball.radius = 0.45;
    for (int i = 0; i < side; ++i)
        for (int j = 0; j < side; ++j)
            for (int k = 0; k < side; ++k)
                s.add(solid({1.1 * i - 0.55 * (side - 1), 1.1 * j - 0.55 * (side - 1), 1.1 * k - 0.55 * (side - 1)},
                            (i + j + k) % 4 == 0 ? ball : box({0.4, 0.45, 0.5})));
    return s;
}
/// Spinning boxes that fall for ever, none near another.
inline scene falling(int dimension, bool quick) {
    scene s = named("falling", dimension, 0);
    const int count = quick ? 1000 : 8000;
    dice d;
    for (int i = 0; i < count; ++i) {
        body b =
            solid({3.0 * (i % 20), 3.0 * (dimension == 2 ? i / 20 : i / 400), dimension == 2 ? 0 : 3.0 * (i / 20 % 20)},
                  box({0.4, 0.5, 0.6}));
        b.spin = {d.next(), d.next(), 3 * d.next()};
        if (dimension == 2) b.spin[0] = b.spin[1] = 0;
        s.add(b);
    }
    return s;
}

inline std::vector<timed_scene> feature_scenes(int dimension, bool quick) {
    std::vector<timed_scene> all = {
        {"resting pyramid", maker_of(dimension == 2 ? "pyramid" : "pyramid3").make(quick), 30},
        {"tumbling pile", dimension == 2 ? maker_of("tumbler").make(quick) : drum3(quick), 120},
        {"falling apart", falling(dimension, quick), 2},
    };
    for (timed_scene& s : all) s.it.steps = s.before + (quick ? 30 : 60);
    return all;
}

}  // namespace bench
