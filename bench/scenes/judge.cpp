// What judge.hpp says.
#include "judge.hpp"

#include <algorithm>
#include <cstdio>

namespace bench {

judge::judge(const scene& s) : scene_(s) {
    for (std::size_t i = 0; i < s.bodies.size(); ++i) {
        for (const shape& part : s.bodies[i].shapes)
            for (piece& p : pieces_of(part, s.dimension)) {
                p.body = static_cast<int>(i);
                p.pushed = s.bodies[i].kind == role::free;
                pieces_.push_back(std::move(p));
            }
        masses_.push_back(mass_of(s.bodies[i], s.dimension));
    }
    for (const joint& j : s.joints) joined_.insert(std::minmax(j.a, j.b));
}

void judge::watch(const std::vector<state>& states) {
    const auto point = [&](int body, const triple& in_it) {
        const state& s = states[static_cast<std::size_t>(body)];
        return s.at + rotated(s.rotation, in_it);
    };
    for (const joint& j : scene_.joints) {
        if (static_cast<std::size_t>(std::max(j.a, j.b)) >= states.size()) break;
        const double gap = length(point(j.b, j.point_b) - point(j.a, j.point_a));
        // What has no numbers any more is as far apart as can be.
        result_.gap = gap >= 0 ? std::max(result_.gap, gap) : 1e300;
        gaps_ += gap;
        ++seen_;
    }
    if (seen_ > 0) result_.mean_gap = gaps_ / static_cast<double>(seen_);
}

std::string judge::complaint(const std::vector<state>& states, const triple& gravity) const {
    char text[160];
    if (length(gravity - scene_.gravity) > 1e-4) return "has another gravity";
    for (std::size_t i = 0; i < states.size(); ++i) {
        const body& b = scene_.bodies[i];
        const state& s = states[i];
        double off = length(s.at - b.at);
        for (const triple& axis : {triple{1, 0, 0}, triple{0, 1, 0}})
            off += length(rotated(s.rotation, axis) - rotated(b.rotation, axis));
        if (!(off < 1e-4 * (1 + length(b.at)))) {
            std::snprintf(text, sizeof text, "puts body %zu elsewhere, by %g", i, off);
            return text;
        }
        if (b.kind != role::free) continue;
        if (!(std::fabs(s.mass - masses_[i].value) < 1e-3 * masses_[i].value)) {
            std::snprintf(text, sizeof text, "gives body %zu %g kg instead of %g", i, s.mass, masses_[i].value);
            return text;
        }
        if (!(length(s.velocity - b.velocity) < 1e-4 * (1 + length(b.velocity))))
            return "lets bodies start with other velocities";
    }
    return {};
}

void judge::sample(const std::vector<state>& states) {
    struct boxed {
        triple lower, upper;
        piece it;
    };
    std::vector<boxed> all;
    for (const piece& p : pieces_) {
        if (static_cast<std::size_t>(p.body) >= states.size()) continue;
        boxed b = {{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}, moved(p, states[static_cast<std::size_t>(p.body)])};
        for (const triple& q : b.it.points)
            for (std::size_t k = 0; k < 3; ++k) {
                b.lower[k] = std::min(b.lower[k], q[k] - p.radius - p.disc);
                b.upper[k] = std::max(b.upper[k], q[k] + p.radius + p.disc);
            }
        // Not so of what has no numbers any more.
        if (b.lower[0] <= b.upper[0]) all.push_back(std::move(b));
    }
    std::sort(all.begin(), all.end(), [](const boxed& a, const boxed& b) { return a.lower[0] < b.lower[0]; });

    verdict& v = result_;
    v.last = v.mean = v.energy = v.sag = v.drift = 0;
    v.deep = v.lost = 0;
    int touching = 0;
    for (std::size_t i = 0; i < all.size(); ++i)
        for (std::size_t j = i + 1; j < all.size() && all[j].lower[0] <= all[i].upper[0]; ++j) {
            const boxed &a = all[i], &b = all[j];
            if (a.it.body == b.it.body || !(a.it.pushed || b.it.pushed)) continue;
            if (joined_.count(std::minmax(a.it.body, b.it.body)) > 0) continue;
            if (a.lower[1] > b.upper[1] || b.lower[1] > a.upper[1]) continue;
            if (a.lower[2] > b.upper[2] || b.lower[2] > a.upper[2]) continue;
            const double depth = overlap(a.it, b.it, scene_.dimension);
            if (!(depth > 0)) continue;
            v.last = std::max(v.last, depth);
            v.mean += depth;
            ++touching;
            v.deep += depth > 0.005;
        }
    if (touching > 0) v.mean /= touching;
    v.worst = std::max(v.worst, v.last);
    for (std::size_t i = 0; i < states.size(); ++i) {
        if (scene_.bodies[i].kind != role::free) continue;
        const state& s = states[i];
        bool inside = true;
        for (std::size_t k = 0; k < static_cast<std::size_t>(scene_.dimension); ++k)
            inside = inside && s.at[k] >= scene_.lower[k] && s.at[k] <= scene_.upper[k];
        v.lost += !inside;
        const triple w = rotated(inverse(s.rotation), s.spin);
        v.energy += masses_[i].value * dot(s.velocity, s.velocity) / 2;
        for (std::size_t k = 0; k < 3; ++k) v.energy += w[k] * dot(masses_[i].inertia[k], w) / 2;
    }
    for (const int top : scene_.tops) {
        const auto i = static_cast<std::size_t>(top);
        if (i >= states.size()) continue;
        const triple away = states[i].at - scene_.bodies[i].at;
        v.sag = std::max(v.sag, -away[1]);
        v.drift = std::max(v.drift, std::hypot(away[0], away[2]));
    }
}

}  // namespace bench
