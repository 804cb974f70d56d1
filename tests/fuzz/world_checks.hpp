// What must hold of any world between two calls, and what its events must tell.
#pragma once

#include <algorithm>
#include <map>
#include <set>

#include "world_surfaces.hpp"

namespace fuzz {

using physics::body_id;
using physics::body_type;
using physics::joint_id;
using physics::shape_id;
using shape_pair = std::pair<shape_id, shape_id>;

template <class S>
double as_double(S x) {
    return static_cast<double>(x);
}
template <class S>
bool is_sound(S x) {
    return physics::scalar_traits<S>::is_finite(x) && physics::detail::is_in_range(x);
}
template <class S, int D>
bool is_sound(const physics::vec<S, D>& v) {
    for (int i = 0; i < D; ++i)
        if (!is_sound(v[i])) return false;
    return true;
}
template <class S, int D>
bool is_unit(const physics::vec<S, D>& v) {
    double square = 0;
    for (int i = 0; i < D; ++i) square += as_double(v[i]) * as_double(v[i]);
    return std::abs(square - 1) < 1e-3;
}

/// Every shape of a world.
template <class World>
std::vector<shape_id> shapes_of(const World& w) {
    std::vector<shape_id> all;
    for (const body_id b : w.bodies())
        for (const shape_id s : w.shapes(b)) all.push_back(s);
    std::sort(all.begin(), all.end());
    return all;
}
template <class World>
auto pose_of(const World& w, shape_id s) {
    return w.pose(w.body(s)) * w.local_pose(s);
}
/// How far a shape is from a convex one, less than nothing where they overlap; of what has parts not beyond a reach.
template <class A, class B, class S, int D>
double gap_between(const A& a, const B& b, const physics::transform<S, D>& b_in_a) {
    if constexpr (physics::detail::has_parts<A, D>) return as_double(separation(a, b, b_in_a, S(2)).distance);
    else return as_double(separation(a, b, b_in_a).distance);
}
/// How far apart two shapes are, less than nothing where they overlap; no number of surfaces, which may be one-sided.
template <class World>
double distance_of(const World& w, shape_id a, shape_id b) {
    const auto of_a = w.shape(a), of_b = w.shape(b);
    const auto at = relative(pose_of(w, a), pose_of(w, b));
    return of_a.visit([&](const auto& x) {
        return of_b.visit([&](const auto& y) {
            if constexpr (requires { separation(x, y, at); }) return gap_between(x, y, at);
            else return std::numeric_limits<double>::quiet_NaN();
        });
    });
}
/// The largest number that worlds compute with.
template <class S>
double largest_of() {
    return std::min(as_double(physics::scalar_traits<S>::max()), 1e75);
}
/// How far a shape reaches from the origin, or its frame is, at least 1; without the directions in which it is endless.
template <class World>
double size_of(const World& w, shape_id s) {
    using halfspace = typename World::halfspace;
    const auto [box, is_endless] = w.shape(s).visit([&]<class Shape>(const Shape& shape) {
        return std::pair(bounds(shape, pose_of(w, s)), std::same_as<Shape, halfspace>);
    });
    double most = 1;
    for (int i = 0; i < World::dimension; ++i) {
        most = std::max(most, std::abs(as_double(pose_of(w, s).position[i])));
        const double lower = as_double(box.lower[i]), upper = as_double(box.upper[i]);
        if (is_endless && upper / 2 - lower / 2 > 0.1 * largest_of<typename World::scalar>()) continue;
        most = std::max({most, std::abs(lower), std::abs(upper)});
    }
    return most;
}
/// Up to where a distance may be judged either way: roundings of what is far or large.
template <class World>
double slack_of(const World& w, shape_id s) {
    const double most = size_of(w, s);
    // So far out nothing is left of a shape's own size.
    return most > 1e7 ? std::numeric_limits<double>::infinity() : 2e-5 * most;
}
/// By how much contacts, and sensors with them, may deviate.
template <class World>
double deviation_of(const World& w, shape_id a, shape_id b) {
    double smaller = std::numeric_limits<double>::infinity();
    for (const shape_id s : {a, b}) {
        const auto box = w.shape(s).visit([](const auto& shape) { return bounds(shape, {}); });
        for (int i = 0; i < World::dimension; ++i)
            smaller = std::min(smaller, as_double(box.upper[i]) / 2 - as_double(box.lower[i]) / 2);
    }
    return smaller / (World::dimension == 2 ? 512 : 256);
}

/// What events have told of a world.
template <class World>
struct listener {
    std::map<shape_pair, std::pair<std::uint64_t, std::uint64_t>> touching, inside;
    std::set<body_id> asleep;
    std::map<joint_id, std::uint64_t> at_limits;

    void hear(const World& w) {
        for (const auto& e : w.joint_limit_end_events()) {
            FUZZ_REQUIRE(e.gone == !w.contains(e.joint) && at_limits.erase(e.joint) == 1);
        }
        for (const auto& e : w.joint_limit_begin_events()) {
            FUZZ_REQUIRE(w.body_a(e.joint) == e.body_a && w.user_data(e.joint) == e.user_data && !e.gone);
            FUZZ_REQUIRE(at_limits.try_emplace(e.joint, e.user_data).second);
        }
        end(w, w.contact_end_events(), touching, [](const auto& e) {
            FUZZ_REQUIRE(e.shape_a.index < e.shape_b.index);
            return std::tuple(e.shape_a, e.shape_b, e.shape_data_a, e.body_data_b);
        });
        for (const auto& e : w.contact_begin_events()) {
            FUZZ_REQUIRE(e.shape_a.index < e.shape_b.index && !e.gone);
            FUZZ_REQUIRE(w.body(e.shape_a) == e.body_a && w.body(e.shape_b) == e.body_b);
            FUZZ_REQUIRE(w.user_data(e.shape_b) == e.shape_data_b && w.user_data(e.body_a) == e.body_data_a);
            FUZZ_REQUIRE(touching.try_emplace({e.shape_a, e.shape_b}, e.shape_data_a, e.body_data_b).second);
        }
        end(w, w.sensor_end_events(), inside,
            [](const auto& e) { return std::tuple(e.sensor, e.visitor, e.sensor_data, e.visitor_body_data); });
        for (const auto& e : w.sensor_begin_events()) {
            FUZZ_REQUIRE(w.body(e.sensor) == e.sensor_body && w.body(e.visitor) == e.visitor_body && !e.gone);
            FUZZ_REQUIRE(w.is_sensor(e.sensor) && !w.is_sensor(e.visitor));
            FUZZ_REQUIRE(inside.try_emplace({e.sensor, e.visitor}, e.sensor_data, e.visitor_body_data).second);
        }
        for (const auto& b : w.broken_joints()) FUZZ_REQUIRE(w.contains(b.joint) && !w.joint_enabled(b.joint));
        for (const auto& j : at_limits) FUZZ_REQUIRE(w.contains(j.first) && w.joint_enabled(j.first));
        // What has woken may have fallen asleep since.
        for (const body_id b : w.wake_events()) asleep.erase(b);
        for (const body_id b : w.sleep_events()) asleep.insert(b);
        for (auto b = asleep.begin(); b != asleep.end();) b = w.contains(*b) ? std::next(b) : asleep.erase(b);
        for (const auto& h : w.hit_events()) {
            FUZZ_REQUIRE(w.body(h.shape_a) == h.body_a && w.body(h.shape_b) == h.body_b);
            FUZZ_REQUIRE(is_unit(h.normal) && h.approach_speed > w.settings().events.hit_speed);
            FUZZ_REQUIRE(touching.count({h.shape_a, h.shape_b}) > 0);
        }
        check(w);
    }

private:
    template <class Events, class Known, class Parts>
    void end(const World& w, const Events& events, Known& known, Parts&& parts) {
        shape_pair last{};
        for (const auto& e : events) {
            const auto [a, b, data_a, data_b] = parts(e);
            const auto it = known.find({a, b});
            FUZZ_REQUIRE(it != known.end());
            FUZZ_REQUIRE(it->second == std::pair(data_a, data_b));
            FUZZ_REQUIRE(e.gone == !(w.contains(a) && w.contains(b)));
            FUZZ_REQUIRE(!last.first || std::pair(last.first.index, last.second.index) <= std::pair(a.index, b.index));
            last = {a, b};
            known.erase(it);
        }
    }
    /// The world says what they have told.
    void check(const World& w) const {
        std::set<shape_pair> now, told, in_sensors, told_inside;
        for (const auto& c : w.contacts())
            if (c.touching) now.insert(std::minmax(c.shape_a, c.shape_b));
        for (const auto& t : touching) told.insert(t.first);
        FUZZ_REQUIRE(now == told);
        for (const auto& t : inside) told_inside.insert(t.first);
        for (const shape_id s : shapes_of(w))
            if (w.is_sensor(s)) w.each_visitor(s, [&](shape_id v) { in_sensors.insert({s, v}); });
        FUZZ_REQUIRE(in_sensors == told_inside);
        std::set<body_id> sleepers;
        for (const body_id b : w.bodies())
            if (w.is_asleep(b)) sleepers.insert(b);
        FUZZ_REQUIRE(sleepers == asleep);
    }
};

/// Numbers in range, handles that live, lists that agree: at any time.
template <class World>
void check_numbers(const World& w) {
    std::uint32_t awake = 0, bodies = 0, shapes = 0;
    for (const body_id b : w.bodies()) {
        ++bodies;
        FUZZ_REQUIRE(w.contains(b));
        FUZZ_REQUIRE(is_sound(w.position(b)) && is_sound(w.center_of_mass(b)));
        FUZZ_REQUIRE(std::abs(as_double(norm_error(physics::detail::converted<double>(w.rotation(b))))) < 1e-3);
        const auto v = w.linear_velocity(b);
        const auto spin = w.angular_velocity(b);
        FUZZ_REQUIRE(is_sound(v) && is_sound(spin));
        const bool moves = !(v == decltype(v){} && spin == decltype(spin){});
        if (w.type(b) == body_type::static_body) FUZZ_REQUIRE(!moves);
        if (w.type(b) != body_type::dynamic_body) FUZZ_REQUIRE(!w.is_asleep(b));
        if (w.type(b) == body_type::dynamic_body) {
            FUZZ_REQUIRE(physics::is_finite(w.mass(b).mass) && w.mass(b).mass > typename World::scalar(0));
            if (w.rotation_locked(b)) FUZZ_REQUIRE(spin == decltype(spin){});
            awake += w.enabled(b) && !w.is_asleep(b);
            FUZZ_REQUIRE(w.enabled(b) || !w.is_asleep(b));
        }
        std::uint32_t last = 0xffffffffu;
        for (const shape_id s : w.shapes(b)) {
            ++shapes;
            FUZZ_REQUIRE(w.contains(s) && w.body(s) == b && s.index < last);
            last = s.index;
        }
    }
    FUZZ_REQUIRE(bodies == w.body_count() && shapes == w.shape_count());
    FUZZ_REQUIRE(awake <= w.awake_count());
    std::uint32_t joints = 0;
    for (const joint_id j : w.joints()) {
        ++joints;
        FUZZ_REQUIRE(w.contains(j) && w.contains(w.body_a(j)) && w.contains(w.body_b(j)));
        FUZZ_REQUIRE(w.body_a(j) != w.body_b(j));
        static_cast<void>(w.reaction(j));
        static_cast<void>(w.joint_angle(j));
        // A filter joint holds nothing: each of its bodies sleeps for itself.
        if (w.template is_joint<typename World::filter_joint>(j)) continue;
        if (w.joint_enabled(j) && w.enabled(w.body_a(j)) && w.enabled(w.body_b(j)) &&
            w.type(w.body_a(j)) == body_type::dynamic_body && w.type(w.body_b(j)) == body_type::dynamic_body)
            FUZZ_REQUIRE(w.is_asleep(w.body_a(j)) == w.is_asleep(w.body_b(j)));
    }
    FUZZ_REQUIRE(joints == w.joint_count());
}

/// Contacts, those of bodies and shapes, and who touches.
template <class World>
void check_contacts(const World& w) {
    using S = typename World::scalar;
    std::map<body_id, std::uint32_t> of_body;
    std::map<shape_id, std::uint32_t> of_shape;
    std::set<std::pair<body_id, body_id>> touching;
    std::uint32_t count = 0;
    for (const auto& c : w.contacts()) {
        ++count;
        FUZZ_REQUIRE(w.contains(c.shape_a) && w.contains(c.shape_b) && c.body_a != c.body_b);
        FUZZ_REQUIRE(w.body(c.shape_a) == c.body_a && w.body(c.shape_b) == c.body_b);
        FUZZ_REQUIRE(!w.is_sensor(c.shape_a) && !w.is_sensor(c.shape_b));
        FUZZ_REQUIRE(may_meet(w.filter(c.shape_a), w.filter(c.shape_b)));
        const bool a = w.type(c.body_a) == body_type::dynamic_body, b = w.type(c.body_b) == body_type::dynamic_body;
        FUZZ_REQUIRE((a || b) && w.enabled(c.body_a) && w.enabled(c.body_b));
        FUZZ_REQUIRE(is_unit(c.normal) && c.count > 0);
        for (int k = 0; k < c.count; ++k) {
            FUZZ_REQUIRE(c.points[k].normal_impulse >= S(0));
            FUZZ_REQUIRE(physics::scalar_traits<S>::is_finite(c.points[k].separation));
        }
        ++of_body[c.body_a], ++of_body[c.body_b], ++of_shape[c.shape_a], ++of_shape[c.shape_b];
        if (c.touching) touching.insert(std::minmax(c.body_a, c.body_b));
    }
    FUZZ_REQUIRE(count == w.contacts().size());
    for (const body_id b : w.bodies()) {
        FUZZ_REQUIRE(w.contacts(b).size() == of_body[b]);
        for (const auto& c : w.contacts(b)) FUZZ_REQUIRE(c.body_a == b || c.body_b == b);
        for (const shape_id s : w.shapes(b)) FUZZ_REQUIRE(w.contacts(s).size() == of_shape[s]);
    }
    for (const auto& [a, b] : touching) FUZZ_REQUIRE(w.touching(a, b) && w.touching(b, a));
}

/// What sensors tell is what overlaps them, just after a step, or has passed through them.
template <class World>
void check_sensors(const World& w) {
    const auto all = shapes_of(w);
    std::set<std::pair<body_id, body_id>> apart;
    for (const joint_id j : w.joints())
        if (w.joint_enabled(j)) apart.insert(std::minmax(w.body_a(j), w.body_b(j)));
    for (const shape_id sensor : all) {
        if (!w.is_sensor(sensor)) continue;
        std::set<shape_id> in;
        w.each_visitor(sensor, [&](shape_id v) { in.insert(v); });
        const body_id b = w.body(sensor);
        for (const shape_id s : all) {
            const bool sees = !w.is_sensor(s) && w.body(s) != b && may_meet(w.filter(sensor), w.filter(s)) &&
                              (w.senses_static(sensor) || w.type(w.body(s)) != body_type::static_body) &&
                              w.enabled(b) && w.enabled(w.body(s));
            if (!sees) FUZZ_REQUIRE(in.count(s) == 0);
            // Whether a joint keeps its bodies apart is not asked for.
            if (!sees || apart.count(std::minmax(b, w.body(s)))) continue;
            const double gap = distance_of(w, sensor, s);
            const double slack = slack_of(w, sensor) + slack_of(w, s) + deviation_of(w, sensor, s);
            if (gap < -slack) FUZZ_REQUIRE(in.count(s) == 1);
        }
    }
}

}  // namespace fuzz
