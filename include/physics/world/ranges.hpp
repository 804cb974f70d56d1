// What a loop over a world's bodies and contacts walks along.
#pragma once

#include "physics/world/state.hpp"

PHYSICS_HPP_BEGIN

namespace detail {

/// Where a loop ends.
struct range_end {};

/// The bodies of a world, in the order of their numbers.
template <class Plan>
class body_range {
public:
    explicit body_range(const state<Plan>& s) : state_(&s) {}
    class iterator {
    public:
        iterator(const state<Plan>& s, std::uint32_t at) : state_(&s), at_(s.bodies.next(at)) {}
        body_id operator*() const { return {at_, state_->bodies.generation(at_), state_->tag}; }
        iterator& operator++() {
            at_ = state_->bodies.next(at_ + 1);
            return *this;
        }
        bool operator==(range_end) const { return at_ == state_->bodies.slots(); }

    private:
        const state<Plan>* state_;
        std::uint32_t at_;
    };
    iterator begin() const { return {*state_, 0}; }
    range_end end() const { return {}; }

private:
    const state<Plan>* state_;
};

/// The shapes of one body, the latest first.
template <class Plan>
class shape_range {
public:
    shape_range(const state<Plan>& s, std::uint32_t first) : state_(&s), first_(first) {}
    class iterator {
    public:
        iterator(const state<Plan>& s, std::uint32_t at) : state_(&s), at_(at) {}
        shape_id operator*() const { return {at_, state_->shapes.generation(at_), state_->tag}; }
        iterator& operator++() {
            at_ = state_->shapes[at_].next;
            return *this;
        }
        bool operator==(range_end) const { return at_ == 0xffffffffu; }

    private:
        const state<Plan>* state_;
        std::uint32_t at_;
    };
    iterator begin() const { return {*state_, first_}; }
    range_end end() const { return {}; }

private:
    const state<Plan>* state_;
    std::uint32_t first_;
};

template <class Plan>
auto view_of(const state<Plan>& s, const typename Plan::contact& c) {
    using S = typename Plan::scalar;
    constexpr int D = Plan::dimension;
    const std::uint32_t at_a = body_a(s, c), at_b = body_b(s, c);
    const auto& a = s.bodies[at_a];
    const auto& b = s.bodies[at_b];
    contact_view<S, D> view{
        {c.shape_a, s.shapes.generation(c.shape_a), s.tag}, {c.shape_b, s.shapes.generation(c.shape_b), s.tag},
        {at_a, s.bodies.generation(at_a), s.tag},           {at_b, s.bodies.generation(at_b), s.tag},
        c.part, c.normal, tangents<S, D>(c.normal), {}, c.count,
        s.surfaces.friction_of(c), s.surfaces.restitution_of(c), s.surfaces.rolling_resistance_of(c),
        c.surface_velocity, c.twist_impulse, c.rolling_impulse};
    for (int k = 0; k < c.count; ++k) {
        const auto& p = c.points[k];
        const auto [to_a, to_b] = c.levers(k);
        const vec<S, D> local_a = inverse_rotate(s.contact_starts[at_a].rotation, to_a) + a.mass.center;
        const vec<S, D> local_b = inverse_rotate(s.contact_starts[at_b].rotation, to_b) + b.mass.center;
        view.points[k] = {a.pose() * local_a, local_a,    local_b, p.separation, p.normal_impulse,
                          p.friction_impulse, c.persisted(k)};
    }
    return view;
}

/// The contacts of a world's last step: first those of bodies that are awake, in ascending order of their shapes'
/// numbers, then, in the same order, those of sleepers, as they were when they fell asleep.
template <class Plan>
class contact_range {
public:
    explicit contact_range(const state<Plan>& s) : state_(&s) {}
    class iterator {
    public:
        iterator(const state<Plan>& s, std::uint32_t at) : state_(&s), at_(at) {}
        auto operator*() const {
            if constexpr (Plan::sleeps)
                if (at_ >= state_->contacts.size())
                    return view_of(*state_, state_->sleep.contacts[at_ - state_->contacts.size()]);
            return view_of(*state_, state_->contacts[at_]);
        }
        iterator& operator++() {
            ++at_;
            return *this;
        }
        bool operator==(range_end) const { return at_ == contact_range(*state_).size(); }

    private:
        const state<Plan>* state_;
        std::uint32_t at_;
    };
    iterator begin() const { return {*state_, 0}; }
    range_end end() const { return {}; }
    /// Number of contacts.
    [[nodiscard]] std::uint32_t size() const {
        if constexpr (Plan::sleeps) return state_->contacts.size() + state_->sleep.contacts.size();
        else return state_->contacts.size();
    }

private:
    const state<Plan>* state_;
};

}  // namespace detail

PHYSICS_HPP_END
