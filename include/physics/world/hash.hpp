// A number that worlds in the same state share.
#pragma once

#include "physics/step/state.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Mixes words into 64 bits, by value: neither byte order nor padding enters. Source: the finaliser of
/// Steele, Lea, Flood, Fast splittable pseudorandom number generators (2014).
class hasher {
public:
    void add(std::uint64_t word) {
        hash_ = (hash_ ^ word) * 0xff51afd7ed558ccdu;
        hash_ ^= hash_ >> 32;
        hash_ *= 0xc4ceb9fe1a85ec53u;
        hash_ ^= hash_ >> 29;
    }
    template <scalar_type S>
    void add(S x) {
        add(scalar_traits<S>::bits(x));
    }
    template <class S, int D>
    void add(vec<S, D> v) {
        for (int i = 0; i < D; ++i) add(v[i]);
    }
    template <class S>
    void add(rotation<S, 2> r) {
        add(r.cosine);
        add(r.sine);
    }
    template <class S>
    void add(rotation<S, 3> r) {
        add(r.imaginary());
        add(r.w);
    }
    template <class S>
    void add(const symmetric<S>& m) {
        add(vec<S, 3>{m.xx, m.yy, m.zz});
        add(vec<S, 3>{m.xy, m.xz, m.yz});
    }
    template <class S, int D>
    void add(const transform<S, D>& t) {
        add(t.position);
        add(t.rotation);
    }
    template <class S, int D, bool Rotates>
    void add(const body<S, D, Rotates>& b) {
        add(static_cast<std::uint64_t>(b.type) | std::uint64_t{b.rotation_locked} << 8 |
            std::uint64_t{b.mass_is_set} << 9 | std::uint64_t{b.has_target} << 10 | std::uint64_t{b.can_sleep} << 11 |
            std::uint64_t{b.at_target} << 12 | std::uint64_t{b.continuous} << 16 | std::uint64_t{!b.enabled} << 17 |
            static_cast<std::uint64_t>(b.given_type) << 24);
        add(b.center);
        add(b.rotation);
        add(b.velocity.linear);
        add(value_of(b.velocity.angular));
        add(b.force);
        add(value_of(b.torque));
        add(b.mass.mass);
        add(b.mass.center);
        add(mass_properties<S, D>(b.mass).inertia);
        add(b.linear_damping);
        add(value_of(b.angular_damping));
        add(b.gravity_scale);
        if (b.has_target) add(b.target);
    }
    template <class Plan>
    void add(const shape_record<Plan>& s) {
        add(static_cast<std::uint64_t>(s.shape.kind()) << 32 | s.body | std::uint64_t{s.sensor} << 63 |
            std::uint64_t{s.one_way} << 62 | std::uint64_t{s.senses_static} << 61);
        add(s.local);
        const auto material = s.material.whole();
        add(material.friction);
        add(material.restitution);
        add(material.rolling_resistance);
        add(material.surface_velocity);
        add(s.density);
        add(std::uint64_t{s.filter.category} << 32 | s.filter.mask);
        add(std::uint64_t{static_cast<std::uint32_t>(s.filter.group)});
        const auto box = bounds(s.shape, s.local);
        add(box.lower);
        add(box.upper);
        s.shape.visit([&](const auto& shape) {
            if constexpr (refers_to_geometry<std::remove_cvref_t<decltype(shape)>>) add(shape.geometry->digest);
        });
    }
    template <class S, int D, class Features>
    void add(const contact<S, D, Features>& c) {
        add(c.normal);
        add(value_of(c.twist_impulse));
        add(value_of(c.substep_friction));
        add(value_of(c.rolling_impulse));
        add(static_cast<std::uint64_t>(c.count) | std::uint64_t{c.part} << 32);
        for (int k = 0; k < c.count; ++k) {
            add(std::uint64_t{c.points[k].feature});
            add(c.points[k].normal_impulse);
            add(c.points[k].substep_impulse);
            add(value_of(c.points[k].friction_impulse));
        }
    }
    void add(bool x) { add(std::uint64_t{x}); }
    template <names_members Record>
    void add(const Record& r) {
        Record::each_member(r, [this](const auto& member) { this->add(member); });
    }
    void add(const joint_record& r) {
        add(std::uint64_t{r.body_a} << 32 | r.body_b);
        add(std::uint64_t{r.kind} << 32 | r.slot);
        add(std::uint64_t{r.enabled} | std::uint64_t{r.collide_connected} << 1 | std::uint64_t{r.bodies_enabled} << 2);
        add(std::bit_cast<std::uint64_t>(r.break_force));
        add(std::bit_cast<std::uint64_t>(r.break_torque));
    }
    template <class Joint, class S>
    void add(const stored_joint<Joint, S>& j) {
        add(j.joint);
        for (const S impulse : j.impulse) add(impulse);
        add(j.substep);
        for (const S sum : j.sum) add(sum);
        add(j.step);
        for (const auto& turned : j.turned) {
            add(turned.angle);
            add(std::uint64_t{static_cast<std::uint32_t>(turned.turns)});
        }
        add(std::uint64_t{j.number});
    }
    /// The manifold follows from the rest.
    template <class S, int D>
    void add(const pair_memory<S, D>& m) {
        add(m.b_in_a);
        add(m.cache);
        add(std::uint64_t{static_cast<std::uint32_t>(m.contact.count)});
    }
    template <class S, int D>
    void add(const persistent_manifold<S, D>& m) {
        add(m.cache);
        add(std::uint64_t{m.named} << 32 | static_cast<std::uint32_t>(m.count));
        for (std::int32_t i = 0; i < m.count; ++i) {
            add(m.points[i].on_a);
            add(m.points[i].on_b);
            add(std::uint64_t{m.points[i].feature});
        }
    }
    void add(const gjk_cache& c) {
        add(std::uint64_t{c.count});
        for (int i = 0; i < c.count; ++i) add(std::uint64_t{c.vertex[i]});
        for (const float x : c.axis) add(x);
    }
    [[nodiscard]] std::uint64_t value() const { return hash_; }

private:
    std::uint64_t hash_ = 0x9e3779b97f4a7c15u;
};

// Members that the hash leaves out, as they follow from others or bear on no result; a law tries all of them.
template <class S, int D, bool Rotates>
constexpr const char* unhashed_members(const body<S, D, Rotates>&) {
    return "inverse_mass, inverse_inertia, spin, user_data, first_shape, is_gyroscopic";
}
template <class Plan>
constexpr const char* unhashed_members(const shape_record<Plan>&) {
    return "pose, r, next, user_data";
}
template <class S, int D, class Features>
constexpr const char* unhashed_members(const contact<S, D, Features>&) {
    return "bodies, r_a, r_b, persisted_mask, touching, loaded_mask, friction, restitution, rolling_resistance, "
           "surface_velocity";
}
template <class S, int D, class Features>
constexpr const char* unhashed_members(const contact_point<S, D, Features>&) {
    return "position, separation";
}

inline const char* unhashed_members(const joint_record&) { return "next_a, next_b, user_data"; }
template <class Joint, class S>
constexpr const char* unhashed_members(const stored_joint<Joint, S>&) {
    return "";
}

/// One number for one thing: processors work on several at a time, and a difference can be traced to its thing.
template <class Item>
std::uint64_t hash_of(std::uint64_t name, const Item& item) {
    hasher h;
    h.add(name);
    h.add(item);
    return h.value();
}

/// Of what is remembered of a pair; 0 where that bears on no result, as of pairs that do not touch.
template <class S, int D>
std::uint64_t digest_of(const pair_memory<S, D>& m, std::uint64_t name) {
    return m.contact.count > 0 ? hash_of(name, m) : 0;
}
template <class S, int D>
std::uint64_t digest_of(const persistent_manifold<S, D>& m, std::uint64_t name) {
    return m.count > 0 ? hash_of(name, m) : 0;
}
template <class Memory>
    requires requires(const Memory& m) { m.digest(); }
std::uint64_t digest_of(const Memory& m, std::uint64_t name) { return m.digest() != 0 ? hash_of(name, m.digest()) : 0; }

/// Calls f(contact) for those with which the next step begins, in order.
template <class Plan, class F>
void each_pushed_contact(const state<Plan>& s, F&& f) {
    const auto& contacts = s.contacts;
    std::uint32_t i = 0;
    const auto tell = [&](const auto& c) {
        if (!s.removed.in(c)) f(c);
    };
    if constexpr (Plan::sleeps)
        if (s.sleep.has_woken_contacts)
            for (const auto& asleep : s.sleep.contacts) {
                if (s.removed.in(asleep) || !can_be_pushed(asleep, s.bodies, s.sleep)) continue;
                for (; i < contacts.size() && contacts[i].key() < asleep.key(); ++i) tell(contacts[i]);
                auto woken = asleep;
                rescale_impulses(&woken, &woken + 1, {s.sleep.step, s.sleep.step}, s.step_lengths);
                f(woken);
            }
    for (; i < contacts.size(); ++i) tell(contacts[i]);
}

/// Of everything in a world that bears on its future, but for the settings: neither user data nor what only
/// saves work, like the boxes of the broadphase. The dimensions of a shape enter by its bounds.
template <class Plan>
std::uint64_t state_hash(const state<Plan>& s) {
    hasher h;
    const auto add_all = [&](const auto& pool) {
        h.add(std::uint64_t{pool.count()});
        pool.each([&](std::uint32_t i, const auto& item) {
            h.add(hash_of(std::uint64_t{i} << 32 | pool.generation(i), item));
        });
    };
    h.add(s.steps);
    add_all(s.bodies);
    add_all(s.shapes);
    h.add(s.step_lengths.usual);
    if (!(s.step_lengths.last == s.step_lengths.usual)) h.add(s.step_lengths.last);
    const auto add_contact = [&](const auto& c) { h.add(hash_of(std::uint64_t{c.shape_a} << 32 | c.shape_b, c)); };
    std::uint64_t contacts = 0;
    each_pushed_contact(s, [&](const auto&) { ++contacts; });
    h.add(contacts);
    each_pushed_contact(s, add_contact);
    if constexpr (Plan::sleeps) {
        s.bodies.each([&](std::uint32_t i, const auto&) {
            h.add(s.sleep.sleep_time[i]);
            h.add(s.sleep.sleep_anchor[i]);
            h.add(s.sleep.carried_from[i]);
            h.add(std::uint64_t{s.sleep.island_next[i]});
        });
        bool any = false;
        for (const auto& c : s.sleep.contacts) {
            if (s.sleep.has_woken_contacts && (s.removed.in(c) || can_be_pushed(c, s.bodies, s.sleep))) continue;
            if (!std::exchange(any, true)) h.add(s.sleep.step);
            add_contact(c);
        }
    }
    if constexpr (Plan::has_joints) {
        add_all(s.joints.records);
        s.joints.each_kind(s.joints, [&](std::uint32_t, const auto& of_kind) { add_all(of_kind); });
    }
    if constexpr (Plan::remembers)
        for (std::uint32_t i = 0; i < s.memories.size(); ++i) {
            const auto [a, b] = s.memories.pair(i);
            if (s.removed.has(a) || s.removed.has(b)) continue;
            const std::uint64_t digest = digest_of(s.memories[i], std::uint64_t{a} << 32 | b);
            if (digest != 0) h.add(digest);
        }
    return h.value();
}

}  // namespace detail

PHYSICS_HPP_END
