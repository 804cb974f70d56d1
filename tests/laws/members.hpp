// Laws of the lists of members: the hash of a world knows all of them, but for those of which it says that it does not.
#pragma once

#include <cstring>
#include <string>
#include <string_view>

#include "cell.hpp"

namespace {
namespace members_laws {

using S = cell::scalar;
constexpr int D = cell::dimension;
using physics::body_id;
using vec = physics::vec<S, D>;

struct complete : physics::recipe<S, D, physics::shapes<physics::ball, physics::box, physics::halfspace>> {};
using world = physics::world<complete>;

/// The next of the names that stand between commas.
inline std::string_view next_name(std::string_view& names) {
    const std::size_t end = names.find(',');
    const std::string_view name = names.substr(0, end);
    names.remove_prefix(end == names.npos ? names.size() : end + 1);
    while (!names.empty() && names.front() == ' ') names.remove_prefix(1);
    return name;
}
inline bool holds(std::string_view names, std::string_view name) {
    while (!names.empty())
        if (next_name(names) == name) return true;
    return false;
}

/// Calls f with each number of a member changed a little, one after the other. Of members that are more than numbers
/// the first byte changes.
template <class Member, class F>
void with_each_number_changed(Member& member, F&& f) {
    using number = std::conditional_t<sizeof(Member) % sizeof(S) == 0 && alignof(Member) == alignof(S), S, char>;
    auto* bytes = reinterpret_cast<unsigned char*>(&member);
    const std::size_t count = sizeof(number) > 1 ? sizeof(Member) / sizeof(number) : 1;
    for (std::size_t i = 0; i < count; ++i) {
        // Of floats a high bit of the mantissa.
        unsigned char& byte = bytes[i * sizeof(number) + (sizeof(number) > 1 ? sizeof(number) - 2 : 0)];
        byte = static_cast<unsigned char>(byte ^ 1);
        f();
        byte = static_cast<unsigned char>(byte ^ 1);
    }
}
/// Each number of each member of something in a world bears on the hash, or is of one that is said not to.
template <class World, class Record>
void every_member_is_hashed_or_said_not_to(const World& w, Record& record) {
    std::string_view names = Record::member_names;
    const std::uint64_t before = w.state_hash();
    Record::each_member(record, [&](auto& member) {
        using Member = std::remove_cvref_t<decltype(member)>;
        const std::string name(next_name(names));
        // Points are records of their own; shapes enter by their kind, their bounds and their geometry's digest.
        if constexpr (!std::is_empty_v<Member> && !std::is_array_v<Member>) {
            if (name == "shape") return;
            const bool derived = holds(physics::detail::unhashed_members(record), name);
            with_each_number_changed(member, [&] {
                CAPTURE(name);
                CHECK((w.state_hash() == before) == derived);
            });
        }
    });
    CHECK(names.empty());
    CHECK(w.state_hash() == before);
}

CELL_CASE("members: the hash knows each number of bodies, shapes and contacts, or says that it leaves it out") {
    world w;
    vec up{};
    up.y = S(1);
    w.create_shape(w.create_body({.type = physics::body_type::static_body}), world::halfspace{up});
    for (int i = 0; i < 4; ++i) {
        vec at{};
        at.x = S(0.25 * i);
        at.y = S(0.5 + i);
        const body_id b = w.create_body({.position = at, .linear_damping = S(0.25)});
        if (i % 2) w.create_shape(b, world::ball{S(0.5)});
        else w.create_shape(b, world::box{vec::filled(S(0.5))});
        if (i == 3) w.apply_force(b, at);
    }
    for (int i = 0; i < 20; ++i) w.step(S(1.0 / 64));
    vec far{};
    far.x = S(20);
    const body_id driven = w.create_body({.type = physics::body_type::kinematic_body, .position = far});
    w.move_to(driven, far + far, {});
    auto& state = physics::detail::world_access::state_of(w);
    const std::uint32_t bodies = state.bodies.count(), shapes = state.shapes.count();
    for (std::uint32_t i = 0; i < bodies; ++i) {
        CAPTURE(i);
        const bool was_driven = state.bodies[i].has_target;
        // Where a body is to be counts only while it is to go there.
        state.bodies[i].has_target = true;
        every_member_is_hashed_or_said_not_to(w, state.bodies[i]);
        state.bodies[i].has_target = was_driven;
    }
    for (std::uint32_t i = 0; i < shapes; ++i) {
        CAPTURE(i);
        every_member_is_hashed_or_said_not_to(w, state.shapes[i]);
    }
    CHECK(!state.contacts.empty());
    for (auto& c : state.contacts) {
        every_member_is_hashed_or_said_not_to(w, c);
        for (int k = 0; k < c.count; ++k) every_member_is_hashed_or_said_not_to(w, c.points[k]);
    }
}

}  // namespace members_laws
}  // namespace
